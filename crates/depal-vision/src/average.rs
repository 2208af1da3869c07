//! Before stage 1: cameras whose depth is noisier than the steps that tell cartons apart. A carton's top is much
//! larger than what their noise hangs together over: depths are averaged along the surface, never across a step.

/// What lies so far apart is never averaged: half of a low carton's height, metres.
const MOST: f32 = 0.050;

/// Pixels of a row of which the window holds are summed up so far.
struct Sums {
    depth: Vec<f32>,
    count: Vec<f32>,
}

impl Sums {
    fn new(width: usize) -> Self {
        Self {
            depth: vec![0.0; width],
            count: vec![0.0; width],
        }
    }

    fn clear(&mut self) {
        self.depth.fill(0.0);
        self.count.fill(0.0);
    }

    /// Takes in those of `others` that lie within `same` (at one metre) of their pixel; 0 is no measurement.
    #[inline(always)]
    fn add(&mut self, own: &[f32], others: &[f32], from: usize, same: f32) {
        let to = from + others.len();
        let sums = self.depth[from..to]
            .iter_mut()
            .zip(&mut self.count[from..to]);
        for ((sum, count), (&z, &other)) in sums.zip(own[from..to].iter().zip(others)) {
            let within = same * z * z;
            let within = if within < MOST { within } else { MOST };
            let takes = (other > 0.0) & ((other - z).abs() <= within);
            let weight = f32::from(u8::from(takes));
            *sum += weight * other;
            *count += weight;
        }
    }

    #[inline(always)]
    fn mean(&self, own: &[f32], out: &mut [f32]) {
        for ((out, &z), (&sum, &count)) in out
            .iter_mut()
            .zip(own)
            .zip(self.depth.iter().zip(&self.count))
        {
            *out = if z > 0.0 { sum / count.max(1.0) } else { 0.0 };
        }
    }
}

/// The loops for the widest vectors that the machine has; the same bits with any.
struct AverageJob<'a> {
    depth: &'a [f32],
    width: usize,
    reach: usize,
    same: f32,
}

impl pulp::WithSimd for AverageJob<'_> {
    type Output = Vec<f32>;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Vec<f32> {
        let Self {
            depth,
            width,
            reach,
            same,
        } = self;
        let height = depth.len() / width;
        let mut sums = Sums::new(width);
        let mut across = vec![0.0; depth.len()];
        for (row, out) in depth
            .chunks_exact(width)
            .zip(across.chunks_exact_mut(width))
        {
            sums.clear();
            for k in 0..=reach.min(width - 1) {
                sums.add(row, &row[k..], 0, same);
                if k > 0 {
                    sums.add(row, &row[..width - k], k, same);
                }
            }
            sums.mean(row, out);
        }
        let mut out = vec![0.0; depth.len()];
        for (v, out) in out.chunks_exact_mut(width).enumerate() {
            let own = &across[v * width..(v + 1) * width];
            sums.clear();
            for other in v.saturating_sub(reach)..(v + reach + 1).min(height) {
                sums.add(own, &across[other * width..(other + 1) * width], 0, same);
            }
            sums.mean(own, out);
        }
        out
    }
}

/// Means of the depths in squares of `2 reach + 1` pixels, of those that differ by no more than `same` metres at one
/// metre from the one in the middle, farther away by more, as the noise of stereo does, with the square of depth:
/// first along the rows, then down the columns. What is not measured stays so.
pub fn averaged(depth: &[f32], width: usize, reach: usize, same: f32) -> Vec<f32> {
    if width == 0 || depth.len() < width {
        return depth.to_vec();
    }
    pulp::Arch::new().dispatch(AverageJob {
        depth,
        width,
        reach,
        same,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 40 x 30: the left half at 1 m, the right at 1.2 m, one hole, every second pixel 10 mm deeper.
    fn step() -> Vec<f32> {
        let mut depth: Vec<f32> = (0..40 * 30)
            .map(|i| {
                let side = if i % 40 < 20 { 1.0 } else { 1.2 };
                side + 0.01 * f32::from(u8::from((i % 40 + i / 40) % 2 == 0))
            })
            .collect();
        depth[15 * 40 + 10] = 0.0;
        depth
    }

    #[test]
    fn noise_goes_and_a_step_stays_where_it_is() {
        let out = averaged(&step(), 40, 4, 0.05);
        for v in 0..30 {
            for u in 0..40 {
                let z = out[v * 40 + u];
                if (u, v) == (10, 15) {
                    assert!(z.abs() < 1e-9);
                    continue;
                }
                let side = if u < 20 { 1.005 } else { 1.205 };
                assert!((z - side).abs() < 0.002, "{u} {v}: {z}");
            }
        }
    }

    #[test]
    fn noise_wider_than_the_limit_stays() {
        let depth = step();
        let out = averaged(&depth, 40, 4, 0.005);
        for (before, after) in depth.iter().zip(&out) {
            assert!((before - after).abs() < 1e-6);
        }
    }

    #[test]
    fn windows_larger_than_the_picture() {
        let out = averaged(&[1.0; 6], 3, 20, 0.05);
        assert!(out.iter().all(|z| (z - 1.0).abs() < 1e-6));
        assert_eq!(averaged(&[], 0, 3, 0.05), Vec::<f32>::new());
    }
}
