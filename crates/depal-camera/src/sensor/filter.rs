//! Filters that vendors run over the finished depth picture, off by default.

use rayon::prelude::*;

use crate::SensorSpec;
use crate::light::NOISE_DISTANCE;

/// Neighbours of eight that must agree with a pixel.
const SUPPORT: usize = 3;
/// Deviations of the axial noise by which they may differ.
const NOISE_MARGIN: f32 = 4.0;

/// Runs those that are on.
pub(super) fn apply(sensor: &SensorSpec, width: usize, depth: &mut [f32]) {
    if sensor.outlier_removal {
        let step = sensor.step as f32;
        let noise = NOISE_MARGIN * sensor.axial_noise as f32 / (NOISE_DISTANCE * NOISE_DISTANCE);
        filter(width, depth, |z, around| {
            let margin = step + noise * z * z;
            let agree = around.iter().filter(|other| (*other - z).abs() <= margin);
            // The pixel agrees with itself.
            if agree.count() > SUPPORT { z } else { 0.0 }
        });
    }
    if sensor.median {
        filter(width, depth, |_, around| {
            around.sort_unstable_by(f32::total_cmp);
            around[(around.len() - 1) / 2]
        });
    }
}

/// Replaces each measured depth by what `value` makes of it and of all that is measured in 3x3 around
/// it, itself included. Every pixel is made of the picture as it was before.
fn filter(width: usize, depth: &mut [f32], value: impl Fn(f32, &mut [f32]) -> f32 + Sync) {
    let before = depth.to_vec();
    let height = before.len() / width;
    depth
        .par_chunks_mut(width)
        .enumerate()
        .for_each(|(v, row)| {
            let rows = v.saturating_sub(1)..=(v + 1).min(height - 1);
            for (u, out) in row.iter_mut().enumerate().filter(|(_, z)| **z > 0.0) {
                let (left, right) = (u.saturating_sub(1), (u + 1).min(width - 1));
                let (mut around, mut count) = ([0.0; 9], 0);
                for y in rows.clone() {
                    for z in &before[y * width + left..=y * width + right] {
                        if *z > 0.0 {
                            around[count] = *z;
                            count += 1;
                        }
                    }
                }
                *out = value(*out, &mut around[..count]);
            }
        });
}
