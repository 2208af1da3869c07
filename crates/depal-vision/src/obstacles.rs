//! Stage 10: what no reported carton explains.

use depal_frames::{Intrinsics, Point, Vector};
use nalgebra::Matrix3;

use crate::{DetectedBox, gate::DepthImage};

/// Points this close to a reported carton belong to it, metres.
const SLACK: f64 = 0.012;
/// More cubes than any coordinate has on one side of zero (60 m of depth, wide views, 1 mm cubes);
/// twice as many fit into 21 bits.
const SHIFT: f64 = 1_048_576.0;
const BITS: u32 = 21;
/// Samples along the side of a cube at the deepest point.
const SAMPLES_PER_VOXEL: f64 = 3.0;
/// Cubes with fewer points are noise at a step.
const LEAST_POINTS: u32 = 3;

/// Middles of the occupied cubes of side `voxel`, ordered by cube index (z, y, x).
pub fn obstacle_points(image: &DepthImage, boxes: &[DetectedBox], voxel: f64) -> Vec<Point> {
    if !(voxel.is_finite() && voxel > 1e-3) {
        return Vec::new();
    }
    let k = &image.intrinsics;
    let solids: Vec<Solid> = boxes.iter().map(|b| Solid::new(b, k)).collect();
    let (top, bottom) = image.window.rows;
    let (left, right) = image.window.columns;
    // Of every eighth pixel: it only decides how many are looked at.
    let mut deepest = 0.0f32;
    for v in (top..bottom).step_by(8) {
        for u in (left..right).step_by(8) {
            let i = v * image.width + u;
            if image.in_region[i] == 1 && image.depth[i] > deepest {
                deepest = image.depth[i];
            }
        }
    }
    let stride = (voxel / SAMPLES_PER_VOXEL * k.fx.max(k.fy) / f64::from(deepest).max(0.1))
        .floor()
        .clamp(1.0, 8.0) as usize;
    let (per_metre, per_column) = (1.0 / voxel, 1.0 / k.fx);
    // Shifted to the positive before the cut, which then is floor.
    let cube_of = |c: f64| (c * per_metre + SHIFT).clamp(0.0, 2.0 * SHIFT - 1.0) as i64 as u64;
    // Cube and how many neighbouring samples fell into it in a row.
    let mut cubes: Vec<(u64, u32)> = Vec::new();
    let mut near: Vec<&Solid> = Vec::new();
    for v in (top..bottom).step_by(stride) {
        near.clear();
        near.extend(
            solids
                .iter()
                .filter(|s| s.rows[0] <= v as f64 && v as f64 <= s.rows[1]),
        );
        let y = (v as f64 - k.cy) / k.fy;
        for u in (left..right).step_by(stride) {
            let i = v * image.width + u;
            if image.in_region[i] == 0 {
                continue;
            }
            let z = f64::from(image.depth[i]);
            let p = Point::new((u as f64 - k.cx) * per_column * z, y * z, z);
            let column = u as f64;
            let explained = near
                .iter()
                .any(|s| s.columns[0] <= column && column <= s.columns[1] && s.holds(&p));
            if !explained {
                let cube = (cube_of(p.z) << (2 * BITS)) | (cube_of(p.y) << BITS) | cube_of(p.x);
                match cubes.last_mut() {
                    Some((last, count)) if *last == cube => *count += 1,
                    _ => cubes.push((cube, 1)),
                }
            }
        }
    }
    cubes.sort_unstable();
    cubes
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|group| group.iter().map(|g| g.1).sum::<u32>() >= LEAST_POINTS)
        .map(|group| {
            let cube = group[0].0;
            let [z, y, x] = [2 * BITS, BITS, 0].map(|bits| {
                let index = (cube >> bits) & ((1 << BITS) - 1);
                (index as f64 - SHIFT + 0.5) * voxel
            });
            Point::new(x, y, z)
        })
        .collect()
}

/// A reported carton with its slack.
struct Solid {
    /// `box_from_camera` as a matrix and a shift.
    turn: Matrix3<f64>,
    shift: Vector,
    half_length: f64,
    half_width: f64,
    bottom: f64,
    /// Where it can show in the image.
    columns: [f64; 2],
    rows: [f64; 2],
}

impl Solid {
    fn new(found: &DetectedBox, k: &Intrinsics) -> Self {
        let box_from_camera = found.camera_from_box.inverse();
        let mut solid = Self {
            turn: *box_from_camera.rotation.to_rotation_matrix().matrix(),
            shift: box_from_camera.translation.vector,
            half_length: found.size.length / 2.0 + SLACK,
            half_width: found.size.width / 2.0 + SLACK,
            bottom: -found.size.height - SLACK,
            columns: [f64::MAX, f64::MIN],
            rows: [f64::MAX, f64::MIN],
        };
        for corner in 0..8 {
            let sign = |bit: usize| if corner & bit == 0 { -1.0 } else { 1.0 };
            let z = if corner & 4 == 0 { SLACK } else { solid.bottom };
            let p = found.camera_from_box
                * Point::new(sign(1) * solid.half_length, sign(2) * solid.half_width, z);
            if p.z < 0.01 {
                solid.columns = [f64::MIN, f64::MAX];
                solid.rows = solid.columns;
                break;
            }
            let (u, v) = k.project(&p);
            solid.columns = [solid.columns[0].min(u), solid.columns[1].max(u)];
            solid.rows = [solid.rows[0].min(v), solid.rows[1].max(v)];
        }
        solid
    }

    fn holds(&self, point_in_camera: &Point) -> bool {
        let p = self.turn * point_in_camera.coords + self.shift;
        p.z < SLACK
            && p.z > self.bottom
            && p.x.abs() < self.half_length
            && p.y.abs() < self.half_width
    }
}
