//! What a cheap stereo camera makes of a scene: 640 x 480, steps of one millimetre, correlated noise,
//! depth steps smeared by the patches that it matches.
#![allow(dead_code)]

use depal_camera::{CameraSpec, RenderShape, SensorSpec, render, sense};
use depal_frames::{DepthFrame, Intrinsics, Pose};
use depal_time::RandomStreams;

use crate::rendered::{Carton, floor, solids};

pub fn cheap(sensor: SensorSpec) -> CameraSpec {
    CameraSpec {
        intrinsics: Intrinsics {
            width: 640,
            height: 480,
            fx: 600.0,
            fy: 600.0,
            cx: 319.5,
            cy: 239.5,
        },
        near: 0.3,
        far: 5.0,
        baseline: 0.05,
        sensor,
    }
}

/// Mean of 1/z over a square: what matching of patches makes of a step.
fn smeared(depth: &[f32], width: usize, reach: usize) -> Vec<f32> {
    let height = depth.len() / width;
    (0..depth.len())
        .map(|i| {
            let (u, v) = (i % width, i / width);
            let (mut sum, mut count) = (0.0, 0.0);
            for y in v.saturating_sub(reach)..(v + reach + 1).min(height) {
                for z in &depth
                    [y * width + u.saturating_sub(reach)..y * width + (u + reach + 1).min(width)]
                {
                    if *z > 0.0 {
                        sum += 1.0 / z;
                        count += 1.0;
                    }
                }
            }
            if count > 0.0 { count / sum } else { 0.0 }
        })
        .collect()
}

/// The picture of the active stereo preset, its noise and mixed pixels included, as a camera gives it that
/// matches patches of `2 reach + 1` pixels; what it has lost stays lost.
pub fn picture(at: &Pose, shapes: &[RenderShape], reach: usize, seed: u64) -> DepthFrame {
    let ideal = cheap(SensorSpec::ideal());
    let exact = sense(&ideal, &render(&ideal, at, shapes), seed).frame;
    let active = cheap(SensorSpec::active_stereo());
    let mut frame = sense(&active, &render(&active, at, shapes), seed).frame;
    let filled: Vec<f32> = frame
        .depth
        .iter()
        .zip(exact.depth)
        .map(|(&z, exact)| if z > 0.0 { z } else { exact })
        .collect();
    let soft = smeared(&filled, frame.intrinsics.width, reach);
    for (z, soft) in frame.depth.iter_mut().zip(soft) {
        if *z > 0.0 {
            *z = (soft * 1e3).round() * 1e-3;
        }
    }
    frame
}

/// Cartons over a floor.
pub fn shapes(cartons: &[Carton]) -> Vec<RenderShape> {
    let mut shapes = solids(cartons);
    shapes.push(floor(0.0));
    shapes
}

/// What else real ones show.
#[derive(Debug, Clone, Copy)]
pub struct Flaws {
    /// Half of a wave's height, metres, and its length, pixels.
    pub wave: [f64; 2],
    /// Share of the pixels within two of a depth step that are lost.
    pub lost: f64,
}

/// Adds flaws to a picture; `ideal` is the exact depth of the same scene.
pub fn flawed(mut frame: DepthFrame, ideal: &[f32], flaws: Flaws, seed: u64) -> DepthFrame {
    let mut r = RandomStreams::new(seed).stream("flaws");
    let (width, height) = (frame.intrinsics.width, frame.intrinsics.height);
    let waves = [0, 1].map(|_| {
        let way = r.uniform(0.0, std::f64::consts::TAU);
        let k = std::f64::consts::TAU / (flaws.wave[1] * r.uniform(0.8, 1.25));
        [k * way.cos(), k * way.sin(), r.uniform(0.0, 6.3)]
    });
    for v in 0..height {
        for u in 0..width {
            let i = v * width + u;
            let z = frame.depth[i];
            if z == 0.0 {
                continue;
            }
            let (x, y) = (u as f64, v as f64);
            let wave: f64 = waves
                .iter()
                .map(|[a, b, c]| (a * x + b * y + c).sin())
                .sum();
            let moved = f64::from(z) + 0.5 * flaws.wave[0] * wave;
            frame.depth[i] = ((moved * 1e3).round() * 1e-3) as f32;
            if flaws.lost > 0.0 && u >= 2 && v >= 2 && u + 2 < width && v + 2 < height {
                let around = (0..25).map(|n| ideal[(v + n / 5 - 2) * width + u + n % 5 - 2]);
                let (low, high) = around.fold((f32::MAX, 0.0f32), |s, z| (s.0.min(z), s.1.max(z)));
                if high - low > 0.02 && r.uniform(0.0, 1.0) < flaws.lost {
                    frame.depth[i] = 0.0;
                }
            }
        }
    }
    frame
}

/// The exact depth of a scene, metres.
pub fn exact(at: &Pose, shapes: &[RenderShape]) -> DepthFrame {
    let ideal = cheap(SensorSpec::ideal());
    sense(&ideal, &render(&ideal, at, shapes), 0).frame
}

/// Share of a top that is in view, nothing before it.
pub fn share_in_view(carton: &Carton, at: &Pose, exact: &DepthFrame) -> f64 {
    const SAMPLES: usize = 24;
    let k = &exact.intrinsics;
    let camera_from_world = at.inverse();
    let rotation = carton.rotation();
    let mut seen = 0;
    for n in 0..SAMPLES * SAMPLES {
        let part = |n: usize| (n as f64 + 0.5) / SAMPLES as f64 - 0.5;
        let on_top = depal_frames::Vector::new(
            part(n % SAMPLES) * carton.size[0],
            part(n / SAMPLES) * carton.size[1],
            0.0,
        );
        let p = depal_frames::Point::new(carton.x, carton.y, carton.top) + rotation * on_top;
        let p = camera_from_world * p;
        let (u, v) = k.project(&p);
        let (u, v) = (u + 0.5, v + 0.5);
        let inside = u >= 0.0 && v >= 0.0 && u < k.width as f64 && v < k.height as f64;
        seen += usize::from(
            inside
                && (f64::from(exact.depth[v as usize * k.width + u as usize]) - p.z).abs() < 0.02,
        );
    }
    f64::from(seen as u32) / (SAMPLES * SAMPLES) as f64
}
