//! The board and the poses of a hand-eye calibration.

use crate::camera::CameraMount;
use crate::choice::{choice, one_of};
use crate::reader::{Checker, section};
use crate::rules::{ANGLE_DEG, COORDINATE_MM, LENGTH_MM, Maybe, Numbers, number, table, whole};

choice! {
    /// Where the board is mounted.
    pub enum BoardMounting {
        /// On the arm's flange, for a camera that stands still.
        Flange = "flange",
        /// Standing still, for a camera on the flange.
        Fixed = "fixed",
    }
}

impl BoardMounting {
    /// Where a board is of use to a camera.
    pub fn before(camera: CameraMount) -> Self {
        match camera {
            CameraMount::World => Self::Flange,
            CameraMount::Flange => Self::Fixed,
        }
    }
}

section! {
    /// A light plate with a grid of dark discs; three larger discs near the middle tell where it begins.
    pub struct Board {
        /// Discs along X of the board.
        /// Default 9: with seven rows a plate of 400 x 320 mm, a quarter of the picture's width at 2.2 m.
        columns: u32, whole(3, 50), default(9);
        /// Discs along Y of the board.
        /// Default 7: with nine columns the grid fits onto itself in no quarter turn.
        rows: u32, whole(3, 50), default(7);
        /// Distance between the centres of neighbouring discs, mm.
        /// Default 40: 25 pixels at 2.5 m, so that discs stay apart.
        pitch_mm: f64, number(2.0, 1000.0), default(40.0);
        /// Diameter of an ordinary disc, mm: a quarter to half of the pitch. The large ones have half as much again.
        /// Default 20: 13 pixels at 2.5 m.
        disc_mm: f64, number(1.0, 500.0), default(20.0);
    }
    check check_board;
}

fn check_board(board: &Board, checker: &mut Checker<'_, '_>) {
    let share = board.disc_mm / board.pitch_mm;
    if !(0.25..=0.5).contains(&share) {
        checker.problem(
            "disc_mm",
            format!(
                "expected {} to {}, a quarter to half of the pitch, found {}",
                board.pitch_mm / 4.0,
                board.pitch_mm / 2.0,
                board.disc_mm
            ),
            None,
        );
    }
}

section! {
    /// Hand-eye calibration with command 701: the board, and where the robot takes it.
    pub struct Calibration {
        /// The board.
        board: Board, table(), section;
        /// Where the board is mounted: where the camera is not.
        /// Default: what `camera.mount` leaves, flange for a camera in the world, fixed for one on the flange.
        mounted: Option<BoardMounting>, Maybe(one_of()), default(None);
        /// Middle of the printed face, mm: in the flange frame, or in the world if it is fixed.
        xyz_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), required;
        /// Roll, pitch and yaw of the board about the axes of that frame, degrees; its Z looks out of the face.
        /// Default: a face that looks up. [180, 0, 0] on a flange that looks down, [0, 0, 0] in the world.
        rpy_deg: Option<[f64; 3]>, Maybe(Numbers::<3>(ANGLE_DEG)), default(None);
        /// Number of poses.
        /// Default 15: fewer leave the camera's direction to chance, more take time.
        poses: u32, whole(3, 100), default(15);
        /// Middle of the volume in which what moves is spread, world, mm; with `region_size_mm`. That is the
        /// middle of a board on the flange, or the camera on it.
        /// Default: the air above the stack, up to 1200 mm of it; for a camera on the flange, the air before
        /// the board.
        region_xyz_mm: Option<[f64; 3]>, Maybe(Numbers::<3>(COORDINATE_MM)), default(None);
        /// Size of that volume along the world's axes, mm.
        /// Default: see `region_xyz_mm`.
        region_size_mm: Option<[f64; 3]>, Maybe(Numbers::<3>(LENGTH_MM)), default(None);
        /// Largest tilt of the board against the camera's view, degrees.
        /// Default 30: more tilt tells more of the camera's distance, until the discs get narrow.
        max_tilt_deg: f64, number(5.0, 40.0), default(30.0);
        /// How far the arm stands beside the pose that it reports, one standard deviation along each axis, mm.
        /// Default 0.05: the repeatability of large arms.
        repeatability_mm: f64, number(0.0, 10.0), default(0.05);
    }
    check check_calibration;
}

fn check_calibration(calibration: &Calibration, checker: &mut Checker<'_, '_>) {
    if calibration.region_xyz_mm.is_some() != calibration.region_size_mm.is_some() {
        checker.problem(
            "region_xyz_mm",
            "expected region_xyz_mm and region_size_mm together, found one of them".to_owned(),
            None,
        );
    }
}
