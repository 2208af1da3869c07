//! Disc centres to a fraction of a pixel: outlines in the intensity image, fitted on the board's plane.

use depal_frames::{DepthFrame, Vector};
use nalgebra::Matrix3;

use super::blobs::Spot;
use crate::plane::{Plane, PlaneFrame};

/// Directions in which the outline is looked for.
const RAYS: usize = 48;
/// So many of them must show it.
const LEAST_RAYS: usize = 32;
/// Steps along a ray, pixels.
const STEP: f64 = 0.25;
/// The board is flat to this, metres: widths of the robust plane fit, one round each.
const PLANE_WIDTHS: [f64; 6] = [0.02, 0.008, 0.003, 0.0015, 0.001, 0.001];

/// A disc on the board's plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    /// Centre in the axes of the plane frame, metres.
    pub x: f64,
    /// Centre in the axes of the plane frame, metres.
    pub y: f64,
    /// Metres.
    pub radius: f64,
}

/// Samples `(u, v, z)` on and around spots, and the share of the pixels there with valid depth.
pub fn board_samples(
    frame: &DepthFrame,
    spots: &[&Spot],
    pitch: f64,
) -> (Vec<(f64, f64, f64)>, f64) {
    let i = &frame.intrinsics;
    let mut samples = Vec::new();
    let mut looked = 0usize;
    for spot in spots {
        // Half a pitch around each disc lies on the plate; a little less keeps away from its edge.
        let reach = 0.45 * pitch / spot.depth;
        let (du, dv) = (reach * i.fx, reach * i.fy);
        let columns = (spot.u - du).max(0.0) as usize..=((spot.u + du) as usize).min(i.width - 1);
        let rows = (spot.v - dv).max(0.0) as usize..=((spot.v + dv) as usize).min(i.height - 1);
        for v in rows.step_by(2) {
            for u in columns.clone().step_by(2) {
                looked += 1;
                let z = f64::from(frame.depth_at(u, v));
                if z > 0.0 && z.is_finite() {
                    samples.push((u as f64, v as f64, z));
                }
            }
        }
    }
    let share = samples.len() as f64 / looked.max(1) as f64;
    (samples, share)
}

/// Plane through samples, exactly affine in 1/z, with Cauchy weights of shrinking width.
pub fn board_plane(frame: &DepthFrame, samples: &[(f64, f64, f64)]) -> Option<Plane> {
    if samples.len() < 30 {
        return None;
    }
    let mut plane: Option<Plane> = None;
    for width in PLANE_WIDTHS {
        let mut normal = Matrix3::zeros();
        let mut right = Vector::zeros();
        for &(u, v, z) in samples {
            let ray = frame.intrinsics.ray(u, v);
            let weight = plane.map_or(1.0, |plane| {
                let error = (z - plane.depth(&ray)) / width;
                1.0 / (1.0 + error * error)
            });
            normal += ray * ray.transpose() * weight;
            right += ray * (weight / z);
        }
        let coefficient = normal.cholesky()?.solve(&right);
        if !coefficient.iter().all(|c| c.is_finite()) || coefficient.z <= 1e-6 {
            return None;
        }
        plane = Some(Plane { coefficient });
    }
    plane
}

/// Looks for a spot's outline and fits a circle to it on the plane.
pub fn disc(frame: &DepthFrame, spot: &Spot, axes: &PlaneFrame) -> Option<Disc> {
    let mut outline = Vec::with_capacity(RAYS);
    for k in 0..RAYS {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / RAYS as f64).sin_cos();
        let radius = spot.radius(cos, sin);
        if let Some(r) = edge(frame, spot, cos, sin, radius) {
            outline.push(axes.of_pixel(&frame.intrinsics, spot.u + r * cos, spot.v + r * sin));
        }
    }
    if outline.len() < LEAST_RAYS {
        return None;
    }
    circle(&outline)
}

/// Where grey passes half-way from the disc to the board, pixels from the spot's middle.
fn edge(frame: &DepthFrame, spot: &Spot, cos: f64, sin: f64, radius: f64) -> Option<f64> {
    let at = |r: f64| grey(frame, spot.u + r * cos, spot.v + r * sin);
    let mean = |from: f64, to: f64| {
        let count = ((to - from) / STEP).ceil().max(1.0) as usize;
        let sum: Option<f64> = (0..count).map(|k| at(from + k as f64 * STEP)).sum();
        sum.map(|s| s / count as f64)
    };
    let inside = mean(0.0, 0.5 * radius)?;
    let outside = mean(
        (radius + 2.0).max(1.25 * radius),
        (radius + 3.0).max(1.5 * radius),
    )?;
    if outside - inside < 10.0 {
        return None;
    }
    let half = 0.5 * (inside + outside);
    let mut r = 0.5 * radius;
    let mut before = at(r)?;
    while r < 1.5 * radius + 2.0 {
        let next = at(r + STEP)?;
        if before < half && next >= half {
            return Some(r + STEP * (half - before) / (next - before));
        }
        before = next;
        r += STEP;
    }
    None
}

/// Grey value between pixels, bilinear; none outside the image.
fn grey(frame: &DepthFrame, u: f64, v: f64) -> Option<f64> {
    let (width, height) = (frame.intrinsics.width, frame.intrinsics.height);
    if !(u >= 0.0 && v >= 0.0 && u < width as f64 - 1.0 && v < height as f64 - 1.0) {
        return None;
    }
    let (column, row) = (u as usize, v as usize);
    let (s, t) = (u - column as f64, v - row as f64);
    let at = |du: usize, dv: usize| f64::from(frame.intensity[(row + dv) * width + column + du]);
    Some(
        (at(0, 0) * (1.0 - s) + at(1, 0) * s) * (1.0 - t)
            + (at(0, 1) * (1.0 - s) + at(1, 1) * s) * t,
    )
}

/// Circle of least squared distances by Gauss-Newton, with one round of outlier removal.
fn circle(outline: &[(f64, f64)]) -> Option<Disc> {
    let mut points = outline.to_vec();
    let mut disc = start_of(&points);
    for round in 0..2 {
        for _ in 0..8 {
            let mut normal = Matrix3::zeros();
            let mut right = Vector::zeros();
            for &(x, y) in &points {
                let (dx, dy) = (x - disc.x, y - disc.y);
                let distance = dx.hypot(dy).max(1e-12);
                let row = Vector::new(dx / distance, dy / distance, 1.0);
                normal += row * row.transpose();
                right += row * (distance - disc.radius);
            }
            let step = normal.cholesky()?.solve(&right);
            disc.x += step.x;
            disc.y += step.y;
            disc.radius += step.z;
        }
        let error = |p: &(f64, f64)| ((p.0 - disc.x).hypot(p.1 - disc.y) - disc.radius).abs();
        let mut errors: Vec<f64> = points.iter().map(error).collect();
        errors.sort_by(f64::total_cmp);
        let median = errors[errors.len() / 2];
        if round == 0 {
            points.retain(|p| error(p) <= 4.0 * median.max(1e-6));
            if points.len() < LEAST_RAYS {
                return None;
            }
        } else if median > 0.15 * disc.radius {
            return None; // not round on the board's plane
        }
    }
    disc.radius.is_finite().then_some(disc)
}

fn start_of(points: &[(f64, f64)]) -> Disc {
    let n = points.len() as f64;
    let (x, y) = points
        .iter()
        .fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
    let radius = points.iter().map(|p| (p.0 - x).hypot(p.1 - y)).sum::<f64>() / n;
    Disc { x, y, radius }
}
