//! Stage 10: what no reported carton explains.

use depal_frames::Point;

use crate::{DetectedBox, gate::DepthImage};

/// Points this close to a reported carton belong to it, metres.
const SLACK: f64 = 0.012;
/// More cubes than any coordinate has on one side of zero (60 m of depth, wide views, 1 mm cubes).
const SHIFT: f64 = 1e8;
/// Cubes with fewer points are noise at a step.
const LEAST_POINTS: usize = 3;

/// Middles of the occupied cubes of side `voxel`, ordered by cube index (z, y, x).
pub fn obstacle_points(image: &DepthImage, boxes: &[DetectedBox], voxel: f64) -> Vec<Point> {
    if !(voxel.is_finite() && voxel > 1e-3) {
        return Vec::new();
    }
    let k = &image.intrinsics;
    let solids: Vec<_> = boxes
        .iter()
        .map(|b| (b.camera_from_box.inverse().to_homogeneous(), b.size))
        .collect();
    let deepest = image
        .depth
        .iter()
        .zip(&image.in_region)
        .fold(
            0.0f32,
            |far, (&z, &inside)| if inside == 1 { far.max(z) } else { far },
        );
    let stride = (voxel / 4.0 * k.fx.max(k.fy) / f64::from(deepest).max(0.1))
        .floor()
        .clamp(1.0, 8.0) as usize;
    // Cube and how many neighbouring samples fell into it in a row.
    let mut cubes: Vec<([i32; 3], usize)> = Vec::new();
    for v in (0..image.height).step_by(stride) {
        for u in (0..image.width).step_by(stride) {
            let i = v * image.width + u;
            if image.in_region[i] == 0 {
                continue;
            }
            let p = k.deproject(u as f64, v as f64, f64::from(image.depth[i]));
            let explained = solids.iter().any(|(box_from_camera, size)| {
                let m = |row: usize| {
                    box_from_camera[(row, 0)] * p.x
                        + box_from_camera[(row, 1)] * p.y
                        + box_from_camera[(row, 2)] * p.z
                        + box_from_camera[(row, 3)]
                };
                let z = m(2);
                z < SLACK
                    && z > -size.height - SLACK
                    && m(0).abs() < size.length / 2.0 + SLACK
                    && m(1).abs() < size.width / 2.0 + SLACK
            });
            if !explained {
                // Shifted to the positive before the cut, which then is floor.
                let cube = [p.z, p.y, p.x].map(|c| (c / voxel + SHIFT) as i32 - SHIFT as i32);
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
        .filter(|group| group.iter().map(|g| g.1).sum::<usize>() >= LEAST_POINTS)
        .map(|group| {
            let [z, y, x] = group[0].0.map(|c| (f64::from(c) + 0.5) * voxel);
            Point::new(x, y, z)
        })
        .collect()
}
