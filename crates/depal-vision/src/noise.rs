//! How noisy a depth image is, from the image itself.

use depal_frames::DepthFrame;

use crate::{
    VisionSettings,
    average::averaged,
    gate::LEAST_SMEAR,
    smear::{pixels_on_steps, smear_of},
};

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

/// Where a camera smears steps and six deviations are more than this, depths are averaged first, metres: more than
/// twice what the defaults are made for. Where steps are sharp, only where they are more than [`MOST`]: up to there
/// the heights of cartons still tell them apart, which averaging would hide.
const SMEARED_AVERAGED_FROM: f64 = 0.010;
/// They are averaged until six deviations are no more than this, metres.
const WANTED: f64 = 0.006;
/// Half of the widest square over which they are averaged, metres: all sides of cartons are longer than twice that.
const WIDEST: f64 = 0.030;
/// Depths within so many deviations of each other are averaged.
const WITHIN_SIGMAS: f64 = 5.0;

/// How much depths bend over two distances of `lag` pixels, of every so many pixels, as if the rows, cut short by as
/// much, were one line.
struct Bends {
    lag: usize,
    /// Where in the next row.
    first: usize,
    sizes: Vec<f32>,
}

impl Bends {
    fn add(&mut self, row: &[f32], stride: usize) {
        let lag = self.lag;
        let in_row = row.len() - 2 * lag;
        while self.first < in_row {
            let [a, b, c] = [0, lag, 2 * lag].map(|far| row[self.first + far]);
            if a > 0.0 && b > 0.0 && c > 0.0 && a + b + c < f32::INFINITY {
                self.sizes.push((a - 2.0 * b + c).abs());
            }
            self.first += stride;
        }
        self.first -= in_row;
    }

    /// Standard deviation of depth, metres; `None` without enough pixels.
    fn deviation(&mut self) -> Option<f64> {
        if self.sizes.len() < 100 {
            return None;
        }
        let middle = self.sizes.len() / 2;
        let (_, median, _) = self.sizes.select_nth_unstable_by(middle, f32::total_cmp);
        Some(f64::from(*median) * SIGMA_PER_MEDIAN)
    }
}

/// The greatest of the deviations at some distances, metres; `None` without enough pixels.
fn noise_of(depth: &[f32], width: usize, lags: &[usize]) -> Option<f64> {
    let stride = (depth.len() / SAMPLES).max(1) | 1;
    let fitting = lags.iter().filter(|lag| width > 2 * **lag);
    let mut bends: Vec<Bends> = fitting
        .map(|&lag| Bends {
            lag,
            first: 0,
            sizes: Vec::with_capacity(depth.len() / stride + 1),
        })
        .collect();
    for row in depth.chunks_exact(width.max(1)) {
        for bends in &mut bends {
            bends.add(row, stride);
        }
    }
    let sigmas = bends.iter_mut().filter_map(Bends::deviation);
    sigmas.reduce(f64::max)
}

/// Standard deviation of a pixel's depth by noise, metres; `None` without enough pixels.
pub fn noise_of_pixels(depth: &[f32], width: usize) -> Option<f64> {
    noise_of(depth, width, &LAGS)
}

/// Median of the measured depths, metres.
fn middle_depth(depth: &[f32]) -> Option<f64> {
    let stride = (depth.len() / SAMPLES).max(1) | 1;
    let measured = depth.iter().step_by(stride).filter(|z| **z > 0.0);
    let mut measured: Vec<f32> = measured.copied().collect();
    let middle = measured.len() / 2;
    (!measured.is_empty())
        .then(|| f64::from(*measured.select_nth_unstable_by(middle, f32::total_cmp).1))
}

/// The smear of a picture of the given noise at its middle depth, pixels.
fn smear_at(depth: &[f32], width: usize, sigma: Option<f64>, middle: Option<f64>) -> usize {
    let at_one_metre = sigma.zip(middle).map_or(0.0, |(s, z)| s / (z * z));
    smear_of(depth, width, at_one_metre as f32)
}

impl VisionSettings {
    /// Wider tolerances where the image itself is too noisy for the present ones, averaging where it is noisier
    /// still, and the width over which it smears steps; never less than now.
    pub fn suited_to(mut self, frame: &DepthFrame) -> Self {
        let width = frame.intrinsics.width;
        if width == 0 || frame.depth.len() != width * frame.intrinsics.height {
            return self;
        }
        let mut sigma = noise_of(&frame.depth, width, &LAGS);
        let mut soft = Vec::new();
        let middle = middle_depth(&frame.depth);
        let mut raw_smear = smear_at(&frame.depth, width, sigma, middle);
        // A camera that smears does so along rows: where steps are sharp there, what lies between two levels of a column
        // is a rim.
        let on_steps = pixels_on_steps(&frame.depth, width);
        if on_steps == Some(0) {
            raw_smear = 0;
        }
        let on_steps = on_steps.unwrap_or(0);
        let from = if raw_smear >= LEAST_SMEAR {
            SMEARED_AVERAGED_FROM
        } else {
            MOST
        };
        if let Some(raw) = sigma.filter(|s| SIGMAS * s > from)
            && let Some(z) = middle
        {
            let within = WITHIN_SIGMAS * raw / (z * z);
            let most = (WIDEST * frame.intrinsics.fx / z) as usize;
            for reach in REACHES.into_iter().filter(|r| *r <= most) {
                soft = averaged(&frame.depth, width, reach, within as f32);
                sigma = noise_of(&soft, width, &[1, 8, 2 * reach + 1]);
                self.average_px = self.average_px.max(reach);
                self.average_within = self.average_within.max(within);
                if sigma.is_none_or(|s| SIGMAS * s <= WANTED) {
                    break;
                }
            }
        }
        let smear = if !soft.is_empty() {
            smear_at(&soft, width, sigma, middle_depth(&soft))
        } else if raw_smear >= LEAST_SMEAR {
            raw_smear.max(on_steps)
        } else {
            on_steps
        };
        self.smear_px = self.smear_px.max(smear);
        // Averaging makes no step wider.
        let least = if soft.is_empty() { 1 } else { LEAST_SMEAR };
        if self.smear_px >= least {
            self.size_tolerance = self.size_tolerance.max(SMEARED_SIZE);
        }
        if let Some(sigma) = sigma {
            let noise = (SIGMAS * sigma).min(MOST);
            self.step = self.step.max(noise);
            // Where steps are sharp, what lies deeper than most of the picture is as much noisier.
            if soft.is_empty()
                && self.smear_px == 0
                && let Some(z) = middle
            {
                self.step_noise = self.step_noise.max(noise / (z * z));
            }
            self.plane_tolerance = self.plane_tolerance.max(noise);
            // An edge is uncertain by what depth is, seen from the rim of the image.
            self.size_tolerance = self.size_tolerance.max(0.5 * noise);
        }
        self
    }
}

/// Halves of squares that are tried, pixels.
const REACHES: [usize; 4] = [4, 8, 14, 22];
