//! Cells drawn by chance, and captures in them with the noise of arm and sensor, without pictures.
#![allow(dead_code)]

use depal_frames::{Point, Pose, Rotation, Vector};
use depal_time::RandomStream;
use depal_vision::calibration::{Capture, Mounting};

use crate::board::BOARD;

pub fn vector(random: &mut RandomStream, sigma: f64) -> Vector {
    Vector::new(
        random.normal(sigma),
        random.normal(sigma),
        random.normal(sigma),
    )
}

pub fn within(random: &mut RandomStream, half: [f64; 3]) -> Vector {
    Vector::from(half.map(|h| random.uniform(-h, h)))
}

/// Noise of arm and sensor, one standard deviation each, metres and radians.
#[derive(Clone, Copy)]
pub struct Noise {
    pub arm: f64,
    pub arm_turn: f64,
    /// Each disc centre, sideways and along the view.
    pub disc: [f64; 2],
    /// The whole plane: depth, and tilt.
    pub plane: f64,
    pub plane_tilt: f64,
}

pub const NONE: Noise = Noise {
    arm: 0.0,
    arm_turn: 0.0,
    disc: [0.0; 2],
    plane: 0.0,
    plane_tilt: 0.0,
};

/// A large arm (0.05 mm repeatability, as much again by turning at 0.3 m) and a laser camera at 2.5 m:
/// disc centres as the detection gives them, and what noise and bowl do to a plane of 0.4 m.
pub const USUAL: Noise = Noise {
    arm: 0.05e-3,
    arm_turn: 0.00017,
    disc: [0.03e-3, 0.02e-3],
    plane: 0.1e-3,
    plane_tilt: 0.0003,
};

/// A cell: the true poses and how its motions are drawn.
pub struct Cell {
    pub mounting: Mounting,
    /// base_from_camera, or flange_from_camera.
    pub camera: Pose,
    /// flange_from_board, or base_from_board.
    pub board: Pose,
}

impl Cell {
    pub fn draw(mounting: Mounting, random: &mut RandomStream) -> Self {
        let tilt = |random: &mut RandomStream, half: f64| Rotation::new(within(random, [half; 3]));
        let down = Rotation::new(Vector::x() * std::f64::consts::PI);
        match mounting {
            Mounting::EyeToHand => Self {
                mounting,
                camera: Pose::from_parts(
                    (Vector::new(1.7, 0.0, 3.7) + within(random, [0.2; 3])).into(),
                    down * tilt(random, 0.3),
                ),
                board: Pose::from_parts(
                    (Vector::new(0.5, 0.0, 0.2) + within(random, [0.2; 3])).into(),
                    down * tilt(random, 0.5),
                ),
            },
            Mounting::EyeInHand => Self {
                mounting,
                camera: Pose::from_parts(
                    (Vector::new(0.2, 0.0, 0.1) + within(random, [0.1; 3])).into(),
                    tilt(random, 0.3),
                ),
                board: Pose::from_parts(
                    (Vector::new(1.7, 0.0, 0.3) + within(random, [0.2; 3])).into(),
                    tilt(random, 0.3),
                ),
            },
        }
    }

    /// The flange at which the board stands at `offset` in the pallet volume (or the camera above the
    /// board) with a turn about the base's axes.
    pub fn flange(&self, offset: Vector, turn: Rotation) -> Pose {
        match self.mounting {
            Mounting::EyeToHand => {
                let board = Pose::from_parts(
                    (Vector::new(1.7, 0.0, 1.1) + offset).into(),
                    turn * self.camera.rotation * Rotation::new(Vector::x() * std::f64::consts::PI),
                );
                board * self.board.inverse()
            }
            Mounting::EyeInHand => {
                let camera = Pose::from_parts(
                    (self.board.translation.vector + Vector::new(0.0, 0.0, 1.6) + offset).into(),
                    turn * Rotation::new(Vector::x() * std::f64::consts::PI),
                );
                camera * self.camera.inverse()
            }
        }
    }

    pub fn camera_from_board(&self, base_from_flange: &Pose) -> Pose {
        match self.mounting {
            Mounting::EyeToHand => self.camera.inverse() * base_from_flange * self.board,
            Mounting::EyeInHand => self.camera.inverse() * base_from_flange.inverse() * self.board,
        }
    }

    pub fn capture(&self, reported: Pose, noise: Noise, random: &mut RandomStream) -> Capture {
        let really = Pose::from_parts(
            (reported.translation.vector + vector(random, noise.arm)).into(),
            Rotation::new(vector(random, noise.arm_turn)) * reported.rotation,
        );
        let camera_from_board = self.camera_from_board(&really);
        let middle = camera_from_board.translation.vector;
        let tilt = [
            random.normal(noise.plane_tilt),
            random.normal(noise.plane_tilt),
        ];
        let off = random.normal(noise.plane);
        let centres_in_camera = BOARD
            .centres()
            .iter()
            .map(|b| {
                let p = camera_from_board * b;
                let from_middle = p.coords - middle;
                // Depth moves a point along its ray.
                let dz = off
                    + tilt[0] * from_middle.x
                    + tilt[1] * from_middle.y
                    + random.normal(noise.disc[1]);
                let ray = p.coords / p.z;
                let sideways = Vector::new(
                    random.normal(noise.disc[0]),
                    random.normal(noise.disc[0]),
                    0.0,
                );
                Point::from(p.coords + ray * dz + sideways)
            })
            .collect();
        Capture {
            base_from_flange: reported,
            centres_in_camera,
        }
    }

    /// `count` captures with tilts up to 20 degrees and turns up to 40 about the vertical.
    pub fn captures(&self, count: usize, noise: Noise, random: &mut RandomStream) -> Vec<Capture> {
        (0..count)
            .map(|_| {
                let offset = within(random, [0.35, 0.3, 0.3]);
                let turn = Rotation::new(within(random, [0.35, 0.35, 0.7]));
                self.capture(self.flange(offset, turn), noise, random)
            })
            .collect()
    }

    /// Mean error of the camera's pose over the corners of the volume that it looks at, metres:
    /// the pallet for a fixed camera, as large a volume 2 m before one on the flange.
    pub fn corner_error(&self, found: &Pose) -> f64 {
        let corners = (0..8).map(|k| {
            let side = |bit: usize| if k & bit == 0 { -0.5 } else { 0.5 };
            let corner = Vector::new(1.2 * side(1), 1.0 * side(2), 1.3 * side(4));
            match self.mounting {
                Mounting::EyeToHand => self
                    .camera
                    .inverse_transform_point(&Point::from(corner + Vector::new(1.7, 0.0, 0.8))),
                Mounting::EyeInHand => Point::from(corner + Vector::new(0.0, 0.0, 1.7)),
            }
        });
        corners
            .map(|c| (found * c - self.camera * c).norm())
            .sum::<f64>()
            / 8.0
    }
}
