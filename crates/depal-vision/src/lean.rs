//! How far the level faces of a picture lean against the camera's axis, found without knowing any of them.
//!
//! Seen by a camera that looks from the side, a flat top falls by several millimetres from pixel to pixel, as much as
//! a step between cartons. Measured along the common direction of all level faces (floor, tops) instead of along the
//! axis, tops are flat again.

use crate::gate::DepthImage;

/// One sample in so many pixels each way.
const STRIDE: usize = 16;
/// A sample's slope is taken between pixels so far to each side: farther apart than noise hangs together.
const ARM: usize = 6;
/// Faces that lean more are sides.
const MOST: f64 = 1.0;
/// Less lean than this (a tangent) tears nothing: 12 degrees are less than a millimetre a pixel at 4 m.
const LEAST: f64 = 0.21;
/// Slopes so close together (tangents) are the same direction.
const ALIKE: f64 = 0.1;
/// Share of the samples that must agree.
const AGREEING: f64 = 0.4;
/// Samples without which nothing is said.
const FEWEST: usize = 200;

/// The direction of the level faces in the camera frame: across the axis, in parts of what it is along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lean {
    x: f64,
    y: f64,
}

impl Lean {
    /// The lean on which most slopes of the picture agree. `None` where they do not, or where it is too small to matter.
    pub fn of(image: &DepthImage, step: f64) -> Option<Self> {
        let (rows, columns) = (image.window.rows, image.window.columns);
        let at = |range: (usize, usize), end: usize| {
            (range.0.max(ARM)..range.1.min(end.saturating_sub(ARM))).step_by(STRIDE)
        };
        let mut slopes = Vec::new();
        for v in at(rows, image.height) {
            for u in at(columns, image.width) {
                slopes.extend(slope(image, u, v, step));
            }
        }
        if slopes.len() < FEWEST {
            return None;
        }
        let middle = [0, 1].map(|k| {
            let mut along: Vec<f64> = slopes.iter().map(|s| s[k]).collect();
            let half = along.len() / 2;
            *along.select_nth_unstable_by(half, f64::total_cmp).1
        });
        let near = slopes
            .iter()
            .filter(|s| square(s[0] - middle[0], s[1] - middle[1]) < ALIKE * ALIKE);
        let (count, sum) = near.fold((0usize, [0.0; 2]), |(count, sum), s| {
            (count + 1, [sum[0] + s[0], sum[1] + s[1]])
        });
        let [x, y] = sum.map(|s| s / count.max(1) as f64);
        let agree = count as f64 >= AGREEING * slopes.len() as f64;
        (agree && x.hypot(y) > LEAST).then_some(Self { x, y })
    }

    /// What a depth of row `v` is to be multiplied with to become a distance along the common direction: at column 0,
    /// and by how much more in each next one.
    pub fn factors(&self, image: &DepthImage, v: usize) -> (f32, f32) {
        let k = &image.intrinsics;
        let first = 1.0 - self.x * k.cx / k.fx + self.y * (v as f64 - k.cy) / k.fy;
        (first as f32, (self.x / k.fx) as f32)
    }
}

/// The normal of the surface at a pixel, in parts of its Z; `None` on no flat one, or on a side face.
///
/// On a plane n.p = d, 1/z = n.(x, y, 1)/d for the ray (x, y, 1): its relative slopes over x and y are
/// (nx, ny)/n.(x, y, 1), whatever d.
fn slope(image: &DepthImage, u: usize, v: usize, step: f64) -> Option<[f64; 2]> {
    let depth = |u: usize, v: usize| {
        let z = f64::from(image.depth[v * image.width + u]);
        (z > 0.0).then_some(z)
    };
    if image.in_region[v * image.width + u] == 0 {
        return None;
    }
    let k = &image.intrinsics;
    let z = depth(u, v)?;
    let along = |a: f64, b: f64, f: f64| {
        let is_flat = (a + b - 2.0 * z).abs() < step;
        is_flat.then_some((1.0 / b - 1.0 / a) / (2.0 * ARM as f64) * f * z)
    };
    let p = along(depth(u - ARM, v)?, depth(u + ARM, v)?, k.fx)?;
    let q = along(depth(u, v - ARM)?, depth(u, v + ARM)?, k.fy)?;
    let (x, y) = ((u as f64 - k.cx) / k.fx, (v as f64 - k.cy) / k.fy);
    let scale = 1.0 / (1.0 - p * x - q * y);
    let normal = [p * scale, q * scale];
    (scale > 0.0 && square(normal[0], normal[1]) < MOST * MOST).then_some(normal)
}

/// Of a vector's length.
fn square(x: f64, y: f64) -> f64 {
    x * x + y * y
}
