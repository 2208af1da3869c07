//! From what a pixel looks at to the depth that it reports.

use super::band::{RowScratch, Sensor};
use crate::light::KEEP_BITS;
use crate::noise::{nearest_integer, normal};

impl Sensor<'_> {
    /// Adds noise and systematic errors, takes pixels by chance, rounds.
    #[inline(always)]
    pub(super) fn measure(&self, v: usize, row: &RowScratch, out: &mut [f32]) {
        let s = &self.spec.sensor;
        let (near, far) = (self.spec.near as f32, self.spec.far as f32);
        let random_dropout = (s.random_dropout * f64::from(1 << (32 - KEEP_BITS))) as i32;
        let (white, smooth) = (
            (1.0 - s.correlated_share).sqrt() as f32,
            s.correlated_share.sqrt() as f32,
        );
        let (scale, bowl) = (self.device.scale, self.device.rows[v]);
        let steps_per_metre = 1.0 / s.quantum;
        let n = out.len();
        let (depth, sigma, keep) = (&row.depth[..n], &row.sigma[..n], &row.keep[..n]);
        let (chances, words) = (&row.words[1][..n], &row.words[2][..n]);
        let (soft, bow) = (&row.smooth[..n], &self.device.columns[..n]);
        // No closures: they would be compiled for the oldest processor.
        for u in 0..n {
            let noise = white * normal(words[u]) + smooth * soft[u];
            out[u] = depth[u] * scale + (bow[u] + bowl) + sigma[u] * noise;
        }
        if s.disparity_step_px > 0.0 {
            self.round_disparity(out);
        }
        if s.quantum > 0.0 {
            for value in out.iter_mut() {
                let steps = nearest_integer(f64::from(*value) * steps_per_metre);
                *value = (steps * s.quantum) as f32;
            }
        }
        for u in 0..n {
            let kept = (chances[u] & ((1 << KEEP_BITS) - 1)) <= keep[u];
            let lucky = (chances[u] >> KEEP_BITS) as i32 >= random_dropout;
            let in_range = (out[u] >= near) & (out[u] <= far);
            let seen = (depth[u] > 0.0) & kept & lucky & in_range;
            out[u] = if seen { out[u] } else { 0.0 };
        }
    }

    /// Rounds depths to whole steps of disparity.
    #[inline(always)]
    fn round_disparity(&self, row: &mut [f32]) {
        let s = &self.spec.sensor;
        let base = if s.disparity_base > 0.0 {
            s.disparity_base
        } else {
            self.rendering.intrinsics.fx * self.spec.baseline.abs()
        };
        let steps = base / s.disparity_step_px;
        for z in row {
            if *z > 0.0 {
                let disparity = nearest_integer(steps / f64::from(*z));
                *z = (steps / disparity.max(1.0)) as f32;
            }
        }
    }
}
