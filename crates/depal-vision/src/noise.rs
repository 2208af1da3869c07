//! How noisy a depth image is, from the image itself.

use depal_frames::DepthFrame;

use crate::{VisionSettings, smear::smear_of};

/// Pixels looked at, about.
const SAMPLES: usize = 20_000;
/// Standard deviation of `a - 2 b + c` for white noise of deviation 1 is sqrt(6); the median of a
/// normal number's size is 0.6745.
const SIGMA_PER_MEDIAN: f64 = 1.0 / (0.6745 * 2.449_489_742_783_178);
/// Six standard deviations are noise, as for the defaults.
const SIGMAS: f64 = 6.0;
/// No carton can be told from its neighbourhood by steps beyond this, metres.
const MOST: f64 = 0.020;

/// A side between two smeared steps is uncertain by so much, metres.
const SMEARED_SIZE: f64 = 0.015;
/// Distances at which depths are compared, pixels: neighbours, and beyond what correlated noise spans.
const LAGS: [usize; 2] = [1, 8];

/// Standard deviation of depth at a distance of `lag` pixels, metres; `None` without enough pixels.
fn deviation(frame: &DepthFrame, lag: usize) -> Option<f64> {
    let width = frame.intrinsics.width;
    if width < 2 * lag + 1 {
        return None;
    }
    let stride = (frame.depth.len() / SAMPLES).max(1) | 1;
    let mut bends: Vec<f32> = frame
        .depth
        .chunks_exact(width)
        .flat_map(|row| row.windows(2 * lag + 1).map(|w| [w[0], w[lag], w[2 * lag]]))
        .step_by(stride)
        .filter(|w| w.iter().all(|&z| z > 0.0 && z.is_finite()))
        .map(|w| (w[0] - 2.0 * w[1] + w[2]).abs())
        .collect();
    if bends.len() < 100 {
        return None;
    }
    let middle = bends.len() / 2;
    let median = *bends.select_nth_unstable_by(middle, f32::total_cmp).1;
    Some(f64::from(median) * SIGMA_PER_MEDIAN)
}

impl VisionSettings {
    /// Wider tolerances where the image itself is too noisy for the present ones, and the width over which
    /// it smears steps; never less than now.
    pub fn suited_to(mut self, frame: &DepthFrame) -> Self {
        self.smear_px = self.smear_px.max(smear_of(frame));
        if self.smear_px > 0 {
            self.size_tolerance = self.size_tolerance.max(SMEARED_SIZE);
        }
        let sigma = LAGS.iter().filter_map(|&lag| deviation(frame, lag));
        if let Some(sigma) = sigma.reduce(f64::max) {
            let noise = (SIGMAS * sigma).min(MOST);
            self.step = self.step.max(noise);
            self.plane_tolerance = self.plane_tolerance.max(noise);
            // An edge is uncertain by what depth is, seen from the rim of the image.
            self.size_tolerance = self.size_tolerance.max(0.5 * noise);
        }
        self
    }
}
