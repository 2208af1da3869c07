//! Stage 1: pixels lost by chance, on film, on glossy tape or by a weak sensor, are put in from what was measured
//! around them. Pixels lost along a line stay lost, and what hangs together with them: gaps between cartons and
//! shadows look so.
//!
//! How many are lost by chance is taken from the picture, block by block: gaps touch less than half of a surface,
//! chance all of it. Where next to nothing is lost by chance, nothing is put in.

use crate::strips::{STRIP, Strips};

/// Side of a cell in which lost pixels are counted, pixels.
const CELL: usize = 8;
/// Cells along the side of a block.
const CELLS: usize = 4;
/// Side of a block, pixels.
const BLOCK: usize = CELL * CELLS;
/// Blocks of so many rows are looked at together.
const BAND: usize = 2;
/// Half of the square of blocks whose losses are compared.
const AROUND: usize = 2;
/// A block that has lost this share is one with losses: a good camera loses 0.002 anywhere.
const TOUCHED: f64 = 0.005;
/// Gaps touch half of all blocks or cells at most; what is lost in more than this share of them is lost by chance.
const TYPICAL: f64 = 0.6;
/// With more lost than this there is nothing to go by.
const MOST: f64 = 0.4;

/// What a strip may lose by chance: so many pixels, and so many times what it loses on the mean. A line one pixel wide
/// takes 32 pixels of a strip, a quarter of it, and chance its share of the rest: so most of a line has lost more, and
/// the others hang together with it. Two clusters of up to ten pixels have lost less.
const CHANCE: (f64, f64) = (28.0, 0.75);

/// One of so many pixels is too few to spoil anything: half of what a good camera loses anyway.
const FEW: usize = 1000;
/// A pixel is put in from at least so many of the eight around it.
const LEAST_AROUND: usize = 3;
/// What is in the middle of a cluster follows from what was put in around it.
const ROUNDS: usize = 3;

/// The depths with what was lost by chance put in; `None` where a picture has lost next to nothing so. `measured`: 1
/// where a depth is measured and in range. `level`: by how much what is measured around a pixel may differ on one
/// surface, metres.
pub fn mended(depth: &[f32], measured: &[u8], width: usize, level: f32) -> Option<Vec<f32>> {
    let blocks = Blocks::new(&Cells::new(measured, width));
    if blocks.by_chance.iter().all(|share| *share == 0.0) {
        return None;
    }
    let open = blocks.lost_by_chance(depth, width);
    if open.len() < depth.len() / FEW {
        return None;
    }
    let open = alone(depth, width, open);
    let mut out = depth.to_vec();
    fill(&mut out, width, open, level);
    Some(out)
}

/// Numbers of lost pixels in squares of [`CELL`] pixels.
struct Cells {
    columns: usize,
    rows: usize,
    lost: Vec<u8>,
}

impl Cells {
    /// Whole cells only.
    fn new(measured: &[u8], width: usize) -> Self {
        let columns = width / CELL;
        let rows = measured.len() / width / CELL;
        let mut lost = vec![0u8; columns * rows];
        let mut line = vec![0u8; columns * CELL];
        pulp::Arch::new().dispatch(|| {
            for (band, cells) in measured
                .chunks_exact(CELL * width)
                .zip(lost.chunks_exact_mut(columns.max(1)))
            {
                line.fill(0);
                for row in band.chunks_exact(width) {
                    for (lost, measured) in line.iter_mut().zip(row) {
                        *lost += 1 - measured;
                    }
                }
                for (lost, line) in cells.iter_mut().zip(line.as_chunks::<CELL>().0) {
                    *lost = line.iter().sum();
                }
            }
        });
        Self {
            columns,
            rows,
            lost,
        }
    }
}

/// Shares lost by chance in blocks.
struct Blocks {
    columns: usize,
    rows: usize,
    /// 0 where next to nothing is, or too much.
    by_chance: Vec<f64>,
}

impl Blocks {
    fn new(cells: &Cells) -> Self {
        let (columns, rows) = (cells.columns.div_ceil(CELLS), cells.rows.div_ceil(CELLS));
        let mut shares = Vec::with_capacity(columns * rows);
        let mut by_chance = Vec::with_capacity(columns * rows);
        let mut own = Vec::with_capacity(CELLS * CELLS);
        for j in 0..rows {
            for i in 0..columns {
                own.clear();
                for row in j * CELLS..((j + 1) * CELLS).min(cells.rows) {
                    let row = &cells.lost[row * cells.columns..(row + 1) * cells.columns];
                    own.extend(&row[i * CELLS..((i + 1) * CELLS).min(row.len())]);
                }
                let lost: usize = own.iter().map(|&n| usize::from(n)).sum();
                let pixels = (own.len() * CELL * CELL) as f64;
                shares.push(lost as f64 / pixels);
                by_chance.push(by_chance_within(&mut own));
            }
        }
        // Blocks that lie in a shadow as a whole tell nothing.
        let told: Vec<[u8; 2]> = shares
            .iter()
            .map(|share| {
                [
                    u8::from(*share <= MOST),
                    u8::from((TOUCHED..=MOST).contains(share)),
                ]
            })
            .collect();
        let mut around = Vec::new();
        for j in 0..rows {
            let near_rows = j.saturating_sub(AROUND)..(j + AROUND + 1).min(rows);
            for i in 0..columns {
                let near_columns = i.saturating_sub(AROUND)..(i + AROUND + 1).min(columns);
                let (mut all, mut touched) = (0, 0);
                for row in near_rows.clone() {
                    for told in &told[row * columns..][near_columns.clone()] {
                        all += told[0];
                        touched += told[1];
                    }
                }
                if touched == 0 || f64::from(touched) < TYPICAL * f64::from(all) {
                    continue;
                }
                around.clear();
                for row in near_rows.clone() {
                    let row = &shares[row * columns..][near_columns.clone()];
                    around.extend(row.iter().filter(|share| **share <= MOST));
                }
                around.sort_unstable_by(f64::total_cmp);
                let typical = around[((1.0 - TYPICAL) * around.len() as f64) as usize];
                let share = &mut by_chance[j * columns + i];
                *share = share.max(typical);
            }
        }
        Self {
            columns,
            rows,
            by_chance,
        }
    }

    /// Lost pixels through which no line of lost ones runs.
    fn lost_by_chance(&self, depth: &[f32], width: usize) -> Vec<usize> {
        let height = depth.len() / width;
        let mut strips = Strips::default();
        let mut found = Vec::new();
        for top in (0..self.rows).step_by(BAND) {
            let rows = top..(top + BAND).min(self.rows);
            let is_in = |i: usize| {
                rows.clone()
                    .any(|j| self.by_chance[j * self.columns + i] > 0.0)
            };
            let mut i = 0;
            while i < self.columns {
                if !is_in(i) {
                    i += 1;
                    continue;
                }
                let first = i;
                while i < self.columns && is_in(i) {
                    i += 1;
                }
                let pixel_rows = rows.start * BLOCK..(rows.end * BLOCK).min(height);
                let pixel_columns = first * BLOCK..(i * BLOCK).min(width);
                strips.look(depth, width, pixel_rows.clone(), pixel_columns.clone());
                for v in pixel_rows.clone() {
                    let shares = &self.by_chance[v / BLOCK * self.columns..];
                    for (block, &share) in (first..i).zip(&shares[first..i]) {
                        if share == 0.0 {
                            continue;
                        }
                        let most = (CHANCE.0 + CHANCE.1 * STRIP * share) as u8;
                        let from = block * BLOCK;
                        let line = &depth[v * width + from..v * width + (from + BLOCK).min(width)];
                        for (k, _) in line.iter().enumerate().filter(|(_, z)| **z == 0.0) {
                            let u = from + k;
                            if strips.most(v - pixel_rows.start, u - pixel_columns.start) <= most {
                                found.push(v * width + u);
                            }
                        }
                    }
                }
            }
        }
        found
    }
}

/// The share lost by chance in the cells of a block; 0 unless something, but not all, is lost nearly everywhere in it.
fn by_chance_within(cells: &mut Vec<u8>) -> f64 {
    const MOST_OF_CELL: u8 = (MOST * (CELL * CELL) as f64) as u8;
    let count = cells.len() as f64;
    cells.retain(|n| (1..=MOST_OF_CELL).contains(n));
    let missing = count - cells.len() as f64;
    if missing > (1.0 - TYPICAL) * count {
        return 0.0;
    }
    // As many as have lost nothing, or all, have lost less than what is typical.
    let rank = ((1.0 - TYPICAL) * count - missing) as usize;
    f64::from(*cells.select_nth_unstable(rank).1) / (CELL * CELL) as f64
}

/// Those of some lost pixels (indices in order) that do not hang together with others.
fn alone(depth: &[f32], width: usize, mut open: Vec<usize>) -> Vec<usize> {
    const OPEN: u8 = 1;
    const TAKEN: u8 = 2;
    let mut state = vec![0u8; depth.len()];
    for &at in &open {
        state[at] = OPEN;
    }
    let inside = |at: usize| {
        let (u, v) = (at % width, at / width);
        u > 0 && v > 0 && u + 1 < width && v + 1 < depth.len() / width
    };
    let around = |at: usize| {
        [at - width, at, at + width]
            .into_iter()
            .flat_map(|middle| middle - 1..=middle + 1)
    };
    let mut next: Vec<usize> = open
        .iter()
        .copied()
        .filter(|&at| !inside(at) || around(at).any(|n| depth[n] == 0.0 && state[n] == 0))
        .collect();
    for &at in &next {
        state[at] = TAKEN;
    }
    while let Some(at) = next.pop() {
        if !inside(at) {
            continue;
        }
        for n in around(at) {
            if state[n] == OPEN {
                state[n] = TAKEN;
                next.push(n);
            }
        }
    }
    open.retain(|&at| state[at] == OPEN);
    open
}

/// Puts in what lies on one surface with all that is measured around it.
fn fill(depth: &mut [f32], width: usize, mut open: Vec<usize>, level: f32) {
    let height = depth.len() / width;
    let mut values: Vec<(usize, f32)> = Vec::new();
    for _ in 0..ROUNDS {
        values.clear();
        open.retain(|&at| {
            let (u, v) = (at % width, at / width);
            if u < 2 || v < 2 || u + 2 >= width || v + 2 >= height {
                return false;
            }
            let (mut low, mut high) = (f32::MAX, 0.0f32);
            for row in 0..5 {
                let from = at + row * width - 2 * width - 2;
                for &z in &depth[from..from + 5] {
                    low = if z > 0.0 { low.min(z) } else { low };
                    high = high.max(z);
                }
            }
            if high - low > level {
                return false; // beside a step
            }
            let (mut sum, mut count) = (0.0, 0usize);
            for row in 0..3 {
                let from = at + row * width - width - 1;
                for &z in &depth[from..from + 3] {
                    sum += z;
                    count += usize::from(z > 0.0);
                }
            }
            if count < LEAST_AROUND {
                return true;
            }
            values.push((at, sum / count as f32));
            false
        });
        for &(at, z) in &values {
            depth[at] = z;
        }
    }
}

#[cfg(test)]
mod tests;
