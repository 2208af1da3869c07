//! Before stage 1: cameras that match patches of a picture smear depth steps over many pixels. The
//! step stands where the depth is half way; there it is put back.

use depal_frames::DepthFrame;

/// Least depth step that counts, metres: less is noise of such a camera, or a carton's edge.
const LEAST_STEP: f32 = 0.030;
/// Half of the widest smear that is looked for, pixels.
const REACH: usize = 12;
/// Shares of a step between which a pixel is on it.
const LEVELS: (f32, f32) = (0.15, 0.85);
/// Fewer steps say nothing.
const LEAST_STEPS: usize = 100;

/// Over how many pixels the steps of a frame are smeared; 0 where they are sharp.
pub fn smear_of(frame: &DepthFrame) -> usize {
    let width = frame.intrinsics.width;
    if width < 4 * REACH {
        return 0;
    }
    let mut widths: Vec<usize> = Vec::new();
    for row in frame.depth.chunks_exact(width).step_by(4) {
        let mut u = REACH + 4;
        while u + REACH + 4 < width {
            let level = |at: usize, beside: usize| {
                let (a, b) = (row[at], row[beside]);
                (a > 0.0 && b > 0.0 && (a - b).abs() < 0.2 * LEAST_STEP).then_some(a)
            };
            let ends = level(u - REACH, u - REACH - 4).zip(level(u + REACH, u + REACH + 4));
            if let Some((a, b)) = ends.filter(|(a, b)| (a - b).abs() > LEAST_STEP) {
                let between = row[u - REACH..=u + REACH].iter().filter(|&&z| {
                    let share = (z - a) / (b - a);
                    z > 0.0 && share > LEVELS.0 && share < LEVELS.1
                });
                widths.push(between.count());
                u += 2 * REACH;
            }
            u += 4;
        }
    }
    if widths.len() < LEAST_STEPS {
        return 0;
    }
    let middle = widths.len() / 2;
    let inner = *widths.select_nth_unstable(middle).1;
    (inner as f32 / (LEVELS.1 - LEVELS.0)).round() as usize
}

/// The depths with every smeared step put back to where it is half way; `smear` pixels wide, `noise`
/// metres of unevenness stay.
pub fn sharpened(depth: &[f32], width: usize, smear: usize, noise: f32) -> Vec<f32> {
    let height = depth.len() / width.max(1);
    // Far enough to see both sides from anywhere on the step.
    let reach = (smear + 3).clamp(REACH, REACH + 4);
    let (low, high) = (
        extremes(depth, width, height, reach, |a, b| a < b),
        extremes(depth, width, height, reach, |a, b| a > b),
    );
    let mut out = depth.to_vec();
    let stride = (reach / 3).max(1);
    for v in 0..height {
        for u in 0..width {
            let i = v * width + u;
            let (z, low, high) = (depth[i], low[i], high[i]);
            if z == 0.0 || high - low < LEAST_STEP {
                continue;
            }
            // Mean of what lies on either side, away from the step itself.
            let (mut near, mut far) = ((0.0f32, 0.0f32), (0.0f32, 0.0f32));
            for y in (v.saturating_sub(reach)..=(v + reach).min(height - 1)).step_by(stride) {
                for x in (u.saturating_sub(reach)..=(u + reach).min(width - 1)).step_by(stride) {
                    let here = depth[y * width + x];
                    if here == 0.0 {
                        continue;
                    }
                    if here < low + 2.0 * noise {
                        near = (near.0 + here, near.1 + 1.0);
                    } else if here > high - 2.0 * noise {
                        far = (far.0 + here, far.1 + 1.0);
                    }
                }
            }
            if near.1 == 0.0 || far.1 == 0.0 {
                continue;
            }
            let (near, far) = (near.0 / near.1, far.0 / far.1);
            let side = if z < 0.5 * (near + far) { near } else { far };
            if (z - side).abs() > 1.5 * noise {
                out[i] = side;
            }
        }
    }
    out
}

/// The first in the order `before` of the valid depths within `reach` pixels; 0 where there is none.
fn extremes(
    depth: &[f32],
    width: usize,
    height: usize,
    reach: usize,
    before: impl Fn(f32, f32) -> bool,
) -> Vec<f32> {
    let pick = |best: f32, z: f32| {
        if z > 0.0 && (best == 0.0 || before(z, best)) {
            z
        } else {
            best
        }
    };
    let mut along = vec![0.0f32; depth.len()];
    for (row, out) in depth.chunks_exact(width).zip(along.chunks_exact_mut(width)) {
        for (u, out) in out.iter_mut().enumerate() {
            let window = &row[u.saturating_sub(reach)..(u + reach + 1).min(width)];
            *out = window.iter().fold(0.0, |best, &z| pick(best, z));
        }
    }
    let mut both = vec![0.0f32; depth.len()];
    for v in 0..height {
        for y in v.saturating_sub(reach)..(v + reach + 1).min(height) {
            for u in 0..width {
                both[v * width + u] = pick(both[v * width + u], along[y * width + u]);
            }
        }
    }
    both
}
