//! Before stage 1: where steps are smeared, a gap between two cartons, narrower than the smear, shows as a shallow
//! valley as wide as the smear. The gap is in its middle; the tops reach up to there.

/// Deeper ones are no gap that was smeared: half of a carton's height, metres.
const DEEPEST: f32 = 0.090;

/// Where a valley's side rises on one side of a pixel.
#[derive(Clone, Copy)]
struct Lip {
    /// Pixels away.
    away: usize,
    /// Metres.
    depth: f32,
}

/// The first pixel of a line of up to `reach` that lies `least` metres or more before `z`, and the nearest of the four
/// from there on.
fn lip(line: impl Iterator<Item = f32>, z: f32, least: f32, reach: usize) -> Option<Lip> {
    let mut found: Option<Lip> = None;
    for (n, other) in line.take(reach).enumerate() {
        if other <= 0.0 {
            continue;
        }
        match &mut found {
            None if z - other >= least => {
                found = Some(Lip {
                    away: n + 1,
                    depth: other,
                });
            }
            Some(lip) if n + 1 - lip.away < 4 => lip.depth = lip.depth.min(other),
            Some(_) => break,
            None => {}
        }
    }
    found
}

/// The lips of the valley in which pixel `at` of a line lies.
fn lips(line: &[f32], at: usize, least: f32, reach: usize) -> Option<(Lip, Lip)> {
    let z = line[at];
    let after = lip(line[at + 1..].iter().copied(), z, least, reach)?;
    let before = lip(line[..at].iter().rev().copied(), z, least, reach)?;
    let is_gap = (before.depth - after.depth).abs() < least
        && z - before.depth.min(after.depth) <= DEEPEST
        && before.away + after.away <= reach;
    is_gap.then_some((before, after))
}

/// Fills the valleys of a line; `put` gets the place and depth of each pixel, 0 for the middle.
fn fill(line: &[f32], smear: usize, least: f32, mut put: impl FnMut(usize, f32)) {
    /// Pixels beyond a lip that still slope.
    const SLOPE: usize = 3;
    // A valley aslant is wider along the rows.
    let reach = smear + smear / 2 + 2;
    for at in 0..line.len() {
        if line[at] <= 0.0 {
            continue;
        }
        let Some((before, after)) = lips(line, at, least, reach) else {
            continue;
        };
        let width = before.away + after.away;
        let (first, last) = (at - before.away, at + after.away);
        let place = |k: usize| k.saturating_sub(first) as f32 / width as f32;
        for k in first.saturating_sub(SLOPE)..(last + SLOPE + 1).min(line.len()) {
            put(
                k,
                before.depth + (after.depth - before.depth) * place(k).min(1.0),
            );
        }
        if before.away.abs_diff(after.away) <= 1 && 2 * width >= smear {
            put(at, 0.0);
        }
    }
}

/// Fills valleys of `least` metres and more, `smear` pixels wide or a little more, up to the tops beside them, and
/// takes away what is measured along their middle.
pub fn parted(depth: &[f32], width: usize, smear: usize, least: f32) -> Vec<f32> {
    let height = depth.len() / width.max(1);
    let mut out = depth.to_vec();
    let mut put = |i: usize, z: f32| out[i] = out[i].min(z);
    for v in 0..height {
        let row = v * width;
        fill(&depth[row..row + width], smear, least, |u, z| {
            put(row + u, z)
        });
    }
    let mut column = vec![0.0; height];
    for u in 0..width {
        for (v, z) in column.iter_mut().enumerate() {
            *z = depth[v * width + u];
        }
        fill(&column, smear, least, |v, z| put(v * width + u, z));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 60;

    /// Tops at 1.5 m, with a valley of eleven columns, 20 mm deep, in the middle, and a step of 0.2 m at the right.
    fn picture(deep: f32) -> Vec<f32> {
        (0..WIDTH * 20)
            .map(|i| match i % WIDTH {
                20..=30 => 1.5 + deep,
                50.. => 1.7,
                _ => 1.5,
            })
            .collect()
    }

    #[test]
    fn a_valley_becomes_a_line_and_a_step_stays() {
        let out = parted(&picture(0.02), WIDTH, 11, 0.01);
        for row in out.chunks_exact(WIDTH) {
            let lost: Vec<usize> = (0..WIDTH).filter(|&u| row[u] == 0.0).collect();
            assert_eq!(lost, [25]);
            for (u, z) in row.iter().enumerate().filter(|(u, _)| *u != 25) {
                let side = if u < 50 { 1.5 } else { 1.7 };
                assert!((z - side).abs() < 1e-6, "{u}: {z}");
            }
        }
    }

    #[test]
    fn what_is_no_smeared_gap_stays() {
        for (deep, smear) in [(0.2, 11), (0.005, 11), (0.02, 5)] {
            let before = picture(deep);
            let out = parted(&before, WIDTH, smear, 0.01);
            let moved = before
                .iter()
                .zip(&out)
                .filter(|(a, b)| (**a - **b).abs() > 1e-6);
            assert_eq!(moved.count(), 0, "{deep} {smear}");
        }
    }
}
