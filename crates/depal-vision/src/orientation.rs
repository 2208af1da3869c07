//! Stage 5: the main direction of an outline, modulo 90 degrees.

use crate::{components::Component, gate::DepthImage, plane::PlaneFrame};

/// Enough outline points for a sharp profile.
const POINTS: usize = 800;

/// Outline of a component in plane coordinates, thinned to about [`POINTS`] points.
pub fn outline(
    component: &Component,
    mask: &[u8],
    image: &DepthImage,
    frame: &PlaneFrame,
) -> Vec<(f64, f64)> {
    let (w, h) = (image.width, image.height);
    let mut pixels = Vec::new();
    for run in &component.runs {
        for u in run.first..=run.last {
            let i = run.row * w + u;
            let inner = u > run.first
                && u < run.last
                && run.row > 0
                && run.row + 1 < h
                && mask[i - w] == 1
                && mask[i + w] == 1;
            if !inner {
                pixels.push((u, run.row));
            }
        }
    }
    let stride = pixels.len().div_ceil(POINTS).max(1);
    pixels
        .iter()
        .step_by(stride)
        .map(|&(u, v)| frame.of_pixel(&image.intrinsics, u as f64, v as f64))
        .collect()
}

/// Yaw in -45..45 degrees (radians) for which the outline, projected on the two axes, gathers in
/// the fewest bins of `bin` metres.
pub fn main_direction(outline: &[(f64, f64)], bin: f64) -> f64 {
    let degree = 1f64.to_radians();
    let coarse = best(outline, bin * 1.5, 0.0, 2.0 * degree, 22);
    let fine = best(outline, bin, coarse, 0.5 * degree, 4);
    let yaw = best(outline, bin * 0.5, fine, 0.1 * degree, 5);
    let quarter = std::f64::consts::FRAC_PI_2;
    yaw - (yaw / quarter).round() * quarter
}

fn best(outline: &[(f64, f64)], bin: f64, middle: f64, step: f64, reach: i32) -> f64 {
    let radius = outline.iter().fold(0.0f64, |r, p| r.max(p.0.hypot(p.1)));
    let half = (radius / bin).ceil().min(20_000.0) as usize + 2;
    let mut bins = [vec![0u32; 2 * half], vec![0u32; 2 * half]];
    let mut winner = (0u64, middle);
    for k in -reach..=reach {
        let yaw = middle + f64::from(k) * step;
        let (s, c) = yaw.sin_cos();
        for b in &mut bins {
            b.fill(0);
        }
        for &(x, y) in outline {
            let along = (((x * c + y * s) / bin).floor() + half as f64) as usize;
            let across = (((y * c - x * s) / bin).floor() + half as f64) as usize;
            bins[0][along.min(2 * half - 1)] += 1;
            bins[1][across.min(2 * half - 1)] += 1;
        }
        let score = bins
            .iter()
            .flatten()
            .map(|&n| u64::from(n) * u64::from(n))
            .sum();
        if score > winner.0 {
            winner = (score, yaw);
        }
    }
    winner.1
}
