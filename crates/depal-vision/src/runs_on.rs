//! How much of a side a surface runs across: a top ends at all of its sides.

use crate::{class::Class, gate::DepthImage, patch::pixel_pitch, plane::PlaneFrame};

/// So far to both sides of a side the surface must be seen, pixels: a side may be off by a few.
const REACH: i32 = 8;
/// Lines so close to an end of it are left out, pixels: another side may be off by them.
const ENDS: f64 = 4.0;
/// Of these pixels so many may be missing.
const MISSING: usize = 2;

/// Share 0..1 of the lines across the side `(axis, sign)` of a rectangle in a plane on which the surface is seen on
/// both sides of it and in between.
pub fn runs_on(
    image: &DepthImage,
    frame: &PlaneFrame,
    extents: [f64; 2],
    (axis, sign): (usize, f64),
    tolerance: f64,
) -> f64 {
    let k = &image.intrinsics;
    let pitch = pixel_pitch(frame, k);
    let axes = [frame.x, frame.y];
    let (outward, tangent) = (axes[axis] * sign, axes[1 - axis]);
    let length = extents[1 - axis] - 2.0 * ENDS * pitch;
    let lines = (length / (2.0 * pitch)).max(1.0) as usize;
    let runs = |line: usize| {
        let along = ((line as f64 + 0.5) / lines as f64 - 0.5) * length;
        let base = frame.origin + tangent * along + outward * (extents[axis] / 2.0);
        let mut missing = 0;
        (-REACH..=REACH).all(|steps| {
            let point = base + outward * (f64::from(steps) * pitch);
            let (u, v) = k.project(&point);
            match image.class(u, v, point.z, tolerance) {
                Class::On => true,
                Class::Hole => {
                    missing += 1;
                    missing <= MISSING
                }
                _ => false,
            }
        })
    };
    (0..lines).filter(|&line| runs(line)).count() as f64 / lines as f64
}
