//! Time of finding the board in a picture of 1280 x 1024, and of the estimation from 15 of them.

#![allow(missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use depal_camera::{Material, SensorSpec, capture_with_decals};
use depal_frames::{DepthFrame, Pose, Rotation, Shape, Vector};
use depal_vision::calibration::{Capture, Mounting, calibrate, find_board};

use board::{BOARD, board_bodies, camera, solid};

#[path = "../tests/board/mod.rs"]
mod board;

/// The board before a wall, in the camera frame.
fn picture(camera_from_board: &Pose, seed: u64) -> DepthFrame {
    let spec = camera(SensorSpec::laser_structured_light());
    let wall = solid(
        Pose::translation(0.0, 0.0, 3.5),
        Shape::cuboid(6.0, 6.0, 0.1),
        1,
        Material::CONCRETE,
    );
    let (plate, print) = board_bodies(&BOARD, camera_from_board);
    let shapes = [wall, plate];
    capture_with_decals(&spec, &Pose::identity(), &shapes, &[print], seed).frame
}

fn board_at(k: usize) -> Pose {
    let wave = |n: f64| (k as f64 * n).sin();
    let facing = Rotation::from_axis_angle(&Vector::x_axis(), std::f64::consts::PI);
    Pose::from_parts(
        Vector::new(0.3 * wave(1.3), 0.2 * wave(2.1), 2.2 + 0.3 * wave(0.7)).into(),
        facing
            * Rotation::new(Vector::new(
                0.4 * wave(1.7),
                0.4 * wave(2.9),
                0.8 * wave(0.9),
            )),
    )
}

fn run(c: &mut Criterion) {
    let frame = picture(&board_at(1), 1);
    c.bench_function("find_board 1280x1024", |b| {
        b.iter(|| find_board(&frame, &BOARD).expect("it is there"));
    });
    // The camera at the base, the board on the flange's own frame.
    let captures: Vec<Capture> = (0..15)
        .map(|k| Capture {
            base_from_flange: board_at(k),
            centres_in_camera: find_board(&picture(&board_at(k), k as u64), &BOARD)
                .expect("it is there")
                .centres,
        })
        .collect();
    c.bench_function("calibrate 15 poses", |b| {
        b.iter(|| calibrate(&BOARD, Mounting::EyeToHand, &captures, &[]).expect("it agrees"));
    });
}

criterion_group!(benches, run);
criterion_main!(benches);
