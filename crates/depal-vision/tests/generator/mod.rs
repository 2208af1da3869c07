//! A second camera beside the simulated one, with the sensor model written once more and simpler: white noise of 0.5 mm at
//! 2 m, nearest-neighbour jitter, lost and mixed pixels at steps; if wanted correlated noise and a bowl instead.
//! Cartons lean by some tenths of a degree and stand a millimetre higher or lower.
#![allow(dead_code)]

use depal_camera::{CameraSpec, Material, RenderShape, SensorSpec, render, sense};
use depal_frames::{DepthFrame, Intrinsics, Point, Pose, Shape, Vector};
use depal_time::RandomStreams;

use crate::rendered::{Carton, HEIGHT, Layout, block, floor, looking_down, places, solids};

/// What is added to the exact depth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    White,
    /// Blurred over two pixels, and a bowl of 0.5 mm.
    CorrelatedAndBowl,
}

const DISTANCE: f64 = 2.0;

pub fn at() -> Pose {
    looking_down(DISTANCE)
}

/// Middles of the boxes lie at -0.1 m, so that the nominal tops are at 0.
pub fn cartons(layout: Layout, gap: f64, seed: u64) -> Vec<Carton> {
    let mut r = RandomStreams::new(seed).stream("boxes");
    let degree = 1f64.to_radians();
    let shifted = f64::from(u8::from(gap > 0.002));
    let turned = f64::from(u8::from(gap >= 0.002));
    let all = places(layout, gap);
    // The middle of the layer under the camera.
    let middle = |of: fn(&crate::rendered::Place) -> f64| {
        let (low, high) = all
            .iter()
            .map(of)
            .fold((f64::MAX, f64::MIN), |b, c| (b.0.min(c), b.1.max(c)));
        f64::midpoint(low, high)
    };
    let (mx, my) = (middle(|p| p.x), middle(|p| p.y));
    all.iter()
        .map(|place| {
            let dx = r.normal(1.0) * 0.0002 * shifted;
            let dy = r.normal(1.0) * 0.0002 * shifted;
            let yaw = place.yaw + r.normal(1.0) * 0.1 * degree * turned;
            let tilt = [r.normal(1.0) * 0.2 * degree, r.normal(1.0) * 0.2 * degree];
            let dz = r.uniform(-0.001, 0.001);
            let mut carton = Carton {
                x: 0.0,
                y: 0.0,
                top: 0.0,
                yaw,
                tilt,
                size: [place.long, place.short, HEIGHT],
            };
            let centre = Vector::new(place.x - mx + dx, place.y - my + dy, dz - HEIGHT / 2.0);
            let top = centre + carton.rotation() * Vector::z() * (HEIGHT / 2.0);
            (carton.x, carton.y, carton.top) = (top.x, top.y, top.z);
            carton
        })
        .collect()
}

/// What the camera delivers of cartons over a slab and a floor.
pub fn frame(cartons: &[Carton], noise: Noise, with_intensity: bool, seed: u64) -> DepthFrame {
    let mut shapes = solids(cartons);
    shapes.push(block(
        1000,
        [0.0, 0.0, -HEIGHT - 0.002 - 0.1],
        [1.2, 1.0, 0.2],
        0.0,
        Material::KRAFT,
    ));
    shapes.push(floor(-1.0));
    frame_of(&shapes, noise, with_intensity, seed)
}

/// What the camera delivers of any shapes.
pub fn frame_of(
    shapes: &[RenderShape],
    noise: Noise,
    with_intensity: bool,
    seed: u64,
) -> DepthFrame {
    let intrinsics = Intrinsics {
        width: 1280,
        height: 1024,
        fx: 1216.0,
        fy: 1216.0,
        cx: 639.5,
        cy: 511.5,
    };
    let spec = CameraSpec {
        intrinsics,
        near: 0.3,
        far: 6.0,
        baseline: 0.30,
        sensor: SensorSpec {
            shadow: true,
            ..SensorSpec::ideal()
        },
    };
    let rendering = render(&spec, &at(), shapes);
    let capture = sense(&spec, &rendering, seed);
    let mut frame = capture.frame;
    lose_grazing(&mut frame, &capture.ids, shapes);
    frame.depth = sensed(&frame.depth, intrinsics.width, noise, seed);
    if !with_intensity {
        frame.intensity = Vec::new();
    }
    frame
}

/// What is seen under more than 75 degrees is lost: walls inside gaps, unless they stand far from the axis.
fn lose_grazing(frame: &mut DepthFrame, ids: &[u32], shapes: &[RenderShape]) {
    let least = 75f64.to_radians().cos();
    let width = frame.intrinsics.width;
    for (i, z) in frame.depth.iter_mut().enumerate() {
        let Some(seen) = shapes.iter().find(|s| s.id == ids[i]) else {
            continue;
        };
        let Shape::Cuboid { half_extents } = seen.shape else {
            continue;
        };
        let ray = frame.intrinsics.ray((i % width) as f64, (i / width) as f64);
        let shape_from_camera = seen.world_from_shape.inverse() * at();
        let p = shape_from_camera * Point::from(ray * f64::from(*z));
        let direction = (shape_from_camera * ray).normalize();
        // The face on which the point lies.
        let off = |k: usize| (p[k].abs() - half_extents[k]).abs();
        let face = (0..3).min_by(|&a, &b| off(a).total_cmp(&off(b)));
        if face.is_some_and(|k| direction[k].abs() < least) {
            *z = 0.0;
        }
    }
}

/// The noise of each pixel, on what is left of the `exact` depth.
fn sensed(exact: &[f32], width: usize, noise: Noise, seed: u64) -> Vec<f32> {
    let height = exact.len() / width;
    let mut r = RandomStreams::new(seed).stream("sensor");
    let mut soft = vec![0.0f32; exact.len()];
    if noise == Noise::CorrelatedAndBowl {
        let white: Vec<f32> = soft.iter().map(|_| r.normal(1.0) as f32).collect();
        soft = blurred(&white, width);
    }
    // Each pixel looks a little beside its place.
    let mut moved = vec![0.0f32; exact.len()];
    for v in 0..height {
        for u in 0..width {
            let near = |at: usize, by: f64, end: usize| {
                (at as f64 + by).round().clamp(0.0, (end - 1) as f64) as usize
            };
            let (su, sv) = (
                near(u, 0.3 * r.normal(1.0), width),
                near(v, 0.3 * r.normal(1.0), height),
            );
            moved[v * width + u] = exact[sv * width + su];
        }
    }
    let mut out = vec![0.0f32; exact.len()];
    for v in 0..height {
        for u in 0..width {
            let i = v * width + u;
            let mut z = f64::from(moved[i]);
            let (mut low, mut high) = (f32::MAX, 0.0f32);
            for y in v.saturating_sub(1)..(v + 2).min(height) {
                for &near in &moved[y * width + u.saturating_sub(1)..y * width + (u + 2).min(width)]
                {
                    if near > 0.0 {
                        low = low.min(near);
                        high = high.max(near);
                    }
                }
            }
            if high - low > 0.005 {
                let chance = r.uniform(0.0, 1.0);
                if chance < 0.3 {
                    z = 0.0;
                } else if chance < 0.4 {
                    z = f64::from(f32::midpoint(low, high));
                }
            }
            if r.uniform(0.0, 1.0) < 0.002 || z <= 0.0 {
                continue;
            }
            let sigma = 0.0005 * (z / 2.0).powi(2);
            z += match noise {
                Noise::White => sigma * r.normal(1.0),
                Noise::CorrelatedAndBowl => {
                    let (x, y) = (
                        2.0 * u as f64 / width as f64 - 1.0,
                        2.0 * v as f64 / height as f64 - 1.0,
                    );
                    sigma * f64::from(soft[i]) + 0.0005 * (x * x + y * y) / 2.0
                }
            };
            out[i] = ((z * 1e4).round() * 1e-4) as f32;
        }
    }
    out
}

/// Blurred by a Gaussian of two pixels, with deviation 1 again.
fn blurred(white: &[f32], width: usize) -> Vec<f32> {
    const REACH: isize = 6;
    let weights: Vec<f32> = (-REACH..=REACH)
        .map(|k| (-(k * k) as f32 / 8.0).exp())
        .collect();
    // Both passes together: the sum of the squares of all products is one.
    let norm = weights.iter().map(|w| w * w).sum::<f32>().sqrt();
    let height = white.len() / width;
    let pass = |from: &[f32], along_rows: bool| -> Vec<f32> {
        (0..from.len())
            .map(|i| {
                let (u, v) = ((i % width) as isize, (i / width) as isize);
                let at = |k: isize| {
                    let (u, v) = if along_rows { (u + k, v) } else { (u, v + k) };
                    let (u, v) = (
                        u.clamp(0, width as isize - 1),
                        v.clamp(0, height as isize - 1),
                    );
                    from[v as usize * width + u as usize]
                };
                (-REACH..=REACH)
                    .zip(&weights)
                    .map(|(k, w)| at(k) * w / norm)
                    .sum()
            })
            .collect()
    };
    pass(&pass(white, true), false)
}
