use std::f64::consts::PI;

use cameras::camera;
use depal_camera::{RenderShape, SensorSpec, render, sense};
use depal_frames::{DepthFrame, Pose, Rotation, Shape, Vector};
use depal_time::{RandomStream, RandomStreams};

use super::mended;
use crate::outliers::without_outliers;

#[path = "../../tests/rendered/cameras.rs"]
#[allow(dead_code)]
mod cameras;

const SIDE: usize = 320;
const LEVEL: f32 = 0.01;

fn put_in(depth: &[f32], width: usize) -> Option<Vec<f32>> {
    let measured: Vec<u8> = depth.iter().map(|z| u8::from(*z > 0.0)).collect();
    mended(depth, &measured, width, LEVEL)
}

/// A level surface that has lost a share of its pixels, each by itself.
fn level(share: f64, r: &mut RandomStream) -> Vec<f32> {
    let lost = |r: &mut RandomStream| r.uniform(0.0, 1.0) < share;
    (0..SIDE * SIDE)
        .map(|_| if lost(r) { 0.0 } else { 2.0 })
        .collect()
}

/// Pixels of a line through the picture, one in each row or column.
fn line(r: &mut RandomStream) -> Vec<usize> {
    let (dy, dx) = r.uniform(0.0, PI).sin_cos();
    let longer = dx.abs().max(dy.abs());
    let middle = [0, 1].map(|_| r.uniform(150.0, 170.0));
    (-120..=120)
        .map(|t| {
            let t = f64::from(t) / longer;
            let (u, v) = (middle[0] + t * dx, middle[1] + t * dy);
            v as usize * SIDE + u as usize
        })
        .collect()
}

#[test]
fn what_is_lost_by_chance_is_put_in() {
    let mut r = RandomStreams::new(1).stream("lost by chance");
    for share in [0.01, 0.05, 0.1, 0.15] {
        let depth = level(share, &mut r);
        let lost = |depth: &[f32]| depth.iter().filter(|z| **z == 0.0).count();
        let open = put_in(&depth, SIDE).map(|mended| lost(&mended));
        assert!(
            open.is_some_and(|open| 20 * open < lost(&depth)),
            "{share}: {open:?}"
        );
    }
}

#[test]
fn a_line_of_lost_pixels_is_never_put_in_whatever_its_direction() {
    let mut r = RandomStreams::new(2).stream("lines");
    for share in [0.005, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2] {
        let mut filled = 0;
        for _ in 0..60 {
            let mut depth = level(share, &mut r);
            let line = line(&mut r);
            for &at in &line {
                depth[at] = 0.0;
            }
            let mended = put_in(&depth, SIDE).unwrap_or(depth);
            filled += line.iter().filter(|&&at| mended[at] > 0.0).count();
        }
        assert_eq!(filled, 0, "{share}");
    }
}

#[test]
fn nothing_is_put_in_across_a_step() {
    let mut r = RandomStreams::new(3).stream("steps");
    let mut depth = level(0.1, &mut r);
    for row in depth.chunks_exact_mut(SIDE) {
        for z in row[SIDE / 2..].iter_mut().filter(|z| **z > 0.0) {
            *z += 0.05;
        }
    }
    let mended = put_in(&depth, SIDE).expect("a tenth is lost by chance");
    let is_one = |z: f32| [0.0, 2.0, 2.05].iter().any(|d| (d - z).abs() < 1e-5);
    assert!(mended.iter().all(|z| is_one(*z)));
}

/// Four rows of four cartons, their tops so far below the camera.
fn layer(gap: f64, below: f64, sensor: SensorSpec, seed: u64) -> DepthFrame {
    let mut r = RandomStreams::new(seed).stream("layer");
    let mut shapes = vec![solid([0.0, 0.0, -0.1], [8.0, 8.0, 0.2])];
    for n in 0..16 {
        let (i, j) = (f64::from(n % 4) - 1.5, f64::from(n / 4) - 1.5);
        let top = 0.75 + r.uniform(-0.0005, 0.0005);
        let middle = [(0.3 + gap) * i, (0.2 + gap) * j, top / 2.0];
        shapes.push(solid(middle, [0.3, 0.2, top]));
    }
    let spec = camera(sensor);
    let at = Pose::from_parts(
        Vector::new(0.0, 0.0, 0.75 + below).into(),
        Rotation::new(Vector::x() * PI),
    );
    sense(&spec, &render(&spec, &at, &shapes), seed).frame
}

fn solid(centre: [f64; 3], size: [f64; 3]) -> RenderShape {
    RenderShape {
        world_from_shape: Pose::from_parts(Vector::from(centre).into(), Rotation::identity()),
        shape: Shape::cuboid(size[0], size[1], size[2]),
        id: 0,
        material: depal_camera::Material::KRAFT,
        edge_radius: 0.0,
    }
}

/// So the boxes in it are the same to the bit as without this stage.
#[test]
fn a_clean_picture_is_left_as_it_is() {
    for sensor in [
        SensorSpec::ideal(),
        SensorSpec::laser_2m(),
        SensorSpec::laser_3m(),
    ] {
        for gap_mm in [0.0, 1.0, 3.0, 5.0, 10.0] {
            for (seed, below) in [(300, 2.0), (301, 2.0), (302, 2.5)] {
                let frame = layer(gap_mm * 1e-3, below, sensor, seed);
                let width = frame.intrinsics.width;
                let case = format!("{gap_mm} mm, seed {seed}");
                assert!(put_in(&frame.depth, width).is_none(), "{case}");
                assert!(
                    without_outliers(&frame.depth, width, LEVEL).is_none(),
                    "{case}"
                );
            }
        }
    }
}
