//! Stage 5: the main direction of an outline, modulo 90 degrees.

use crate::{
    components::{Component, each_zero},
    gate::DepthImage,
    plane::PlaneFrame,
    resample::int,
    widest::with_widest_vectors,
};

/// Enough outline points for a sharp profile.
const POINTS: usize = 400;

/// Outline of a component in plane coordinates, thinned to about [`POINTS`] points, and always with its
/// outermost ones.
pub fn outline(
    component: &Component,
    mask: &[u8],
    image: &DepthImage,
    frame: &PlaneFrame,
) -> Vec<(f64, f64)> {
    let (w, h) = (image.width, image.height);
    let mut pixels: Vec<(u32, u32)> = Vec::with_capacity(4 * component.runs.len());
    for run in &component.runs {
        let row = run.row as u32;
        pixels.push((run.first as u32, row));
        if run.last == run.first {
            continue;
        }
        let inner = run.first + 1..run.last;
        if run.row == 0 || run.row + 1 == h {
            pixels.extend(inner.map(|u| (u as u32, row)));
        } else {
            let at = run.row * w;
            let above = &mask[at - w + inner.start..at - w + inner.end];
            let below = &mask[at + w + inner.start..at + w + inner.end];
            each_zero(above, None, |k| {
                pixels.push(((inner.start + k) as u32, row));
            });
            each_zero(below, Some(above), |k| {
                pixels.push(((inner.start + k) as u32, row));
            });
        }
        pixels.push((run.last as u32, row));
    }
    let stride = pixels.len().div_ceil(POINTS).max(1);
    let mut thinned: Vec<(u32, u32)> = pixels.iter().copied().step_by(stride).collect();
    // What reaches farthest along the image's axes and diagonals bounds the surface.
    let along = |p: &(u32, u32)| {
        let (u, v) = (p.0 as i32, p.1 as i32);
        [u, v, u + v, u - v]
    };
    let (mut most, mut least) = ([i32::MIN; 4], [i32::MAX; 4]);
    for p in &pixels {
        let reach = along(p);
        for k in 0..4 {
            most[k] = most[k].max(reach[k]);
            least[k] = least[k].min(reach[k]);
        }
    }
    for k in 0..4 {
        thinned.extend(pixels.iter().rfind(|p| along(p)[k] == most[k]));
        thinned.extend(pixels.iter().find(|p| along(p)[k] == least[k]));
    }
    thinned
        .iter()
        .map(|&(u, v)| frame.of_pixel(&image.intrinsics, f64::from(u), f64::from(v)))
        .collect()
}

/// Yaw in -45..45 degrees (radians) for which the outline, projected on the two axes, gathers in
/// the fewest bins of `bin` metres.
pub fn main_direction(outline: &[(f64, f64)], bin: f64) -> f64 {
    let degree = 1f64.to_radians();
    let points: Vec<(f32, f32)> = outline.iter().map(|p| (p.0 as f32, p.1 as f32)).collect();
    let every = |n: usize| -> Vec<(f32, f32)> { points.iter().copied().step_by(n).collect() };
    let coarse = best(&every(3), bin * 1.5, 0.0, 2.0 * degree, 22);
    let fine = best(&every(2), bin, coarse, 0.5 * degree, 4);
    let yaw = best(&points, bin * 0.5, fine, 0.1 * degree, 5);
    let quarter = std::f64::consts::FRAC_PI_2;
    yaw - (yaw / quarter).round() * quarter
}

fn best(outline: &[(f32, f32)], bin: f64, middle: f64, step: f64, reach: i32) -> f64 {
    let square = outline
        .iter()
        .fold(0.0f32, |s, p| s.max(p.0 * p.0 + p.1 * p.1));
    let radius = square.sqrt();
    let half = (f64::from(radius) / bin).ceil().min(20_000.0) as usize + 2;
    let mut bins = vec![0u16; 4 * half];
    let mut places = vec![[0u32; 2]; outline.len()];
    let (first, second) = (half as f32, 3.0 * half as f32);
    let last = (4 * half - 1) as f32;
    let mut winner = (0u64, middle);
    for k in -reach..=reach {
        let yaw = middle + f64::from(k) * step;
        let (s, c) = ((yaw.sin() / bin) as f32, (yaw.cos() / bin) as f32);
        bins.fill(0);
        // First where, then what: the processor does several of the former at once.
        with_widest_vectors(
            #[inline(always)]
            || {
                for (&(x, y), place) in outline.iter().zip(&mut places) {
                    // Shifted to the positive, where cutting off is floor.
                    let along = x * c + y * s + first;
                    let across = y * c - x * s + second;
                    *place = [along, across].map(|at| int(at.max(0.0).min(last)) as u32);
                }
            },
        );
        for &[along, across] in &places {
            bins[along as usize] += 1;
            bins[across as usize] += 1;
        }
        let score = bins
            .iter()
            .map(|&n| u32::from(n) * u32::from(n))
            .sum::<u32>();
        if u64::from(score) > winner.0 {
            winner = (u64::from(score), yaw);
        }
    }
    winner.1
}
