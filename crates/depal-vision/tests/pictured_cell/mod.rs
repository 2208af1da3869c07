//! A cell with a fixed camera above a pallet and the board on the arm's flange, as pictures show it.
#![allow(dead_code)]

use depal_camera::{CameraSpec, Material, RenderShape, SensorSpec, capture, capture_with_decals};
use depal_frames::{DepthFrame, Point, Pose, Rotation, Shape, Vector};
use depal_time::RandomStream;
use depal_vision::calibration::{CircleBoard, Mounting, PosePlan};

use crate::board::{BOARD, BOARD_ID, board_bodies, camera, solid};

/// Above the pallet, looking down, not quite straight.
pub fn base_from_camera() -> Pose {
    Pose::from_parts(
        Vector::new(1.72, 0.03, 3.68).into(),
        Rotation::from_euler_angles(3.12, 0.02, 1.58),
    )
}

/// The board stands out beside the tool and looks back past the flange.
pub fn flange_from_board() -> Pose {
    Pose::from_parts(
        Vector::new(0.55, 0.02, 0.25).into(),
        Rotation::from_euler_angles(std::f64::consts::PI + 0.01, 0.02, 0.03),
    )
}

/// Floor, pallet with a layer of cartons, and a rough arm with a gripper at the flange.
pub fn surroundings(base_from_flange: &Pose) -> Vec<RenderShape> {
    let mut shapes = vec![
        solid(
            Pose::translation(1.7, 0.0, -0.05),
            Shape::cuboid(8.0, 8.0, 0.1),
            1,
            Material::CONCRETE,
        ),
        solid(
            Pose::translation(1.7, 0.0, 0.072),
            Shape::cuboid(0.8, 1.2, 0.144),
            2,
            Material::WOOD,
        ),
    ];
    for k in 0..8 {
        let (i, j) = (f64::from(k % 2) - 0.5, f64::from(k / 2) - 1.5);
        shapes.push(solid(
            Pose::translation(1.7 + i * 0.404, j * 0.304, 0.269),
            Shape::cuboid(0.4, 0.3, 0.25),
            10 + k as u32,
            Material::KRAFT,
        ));
    }
    let gripper = base_from_flange * Pose::translation(0.0, 0.0, 0.25);
    shapes.push(solid(
        gripper,
        Shape::cuboid(0.62, 0.4, 0.06),
        30,
        Material::PAINT,
    ));
    let flange = base_from_flange.translation.vector;
    let elbow = Vector::new(0.5, 0.0, 2.0);
    let along = elbow - flange;
    let turn = Rotation::rotation_between(&Vector::z(), &along).unwrap_or_else(Rotation::identity);
    shapes.push(solid(
        Pose::from_parts(((flange + elbow) / 2.0).into(), turn),
        Shape::Capsule {
            half_length: along.norm() / 2.0,
            radius: 0.12,
        },
        31,
        Material::PAINT,
    ));
    shapes
}

pub fn picture(
    board: &CircleBoard,
    base_from_flange: &Pose,
    spec: &CameraSpec,
    seed: u64,
) -> DepthFrame {
    let (plate, print) = board_bodies(board, &(base_from_flange * flange_from_board()));
    let mut shapes = surroundings(base_from_flange);
    shapes.push(plate);
    capture_with_decals(spec, &base_from_camera(), &shapes, &[print], seed).frame
}

/// A pose as the arm really takes it up: 0.05 mm and 0.005 degrees (0.05 mm at 0.6 m) beside the reported one.
pub fn repeated(pose: &Pose, random: &mut RandomStream) -> Pose {
    let mut normal = |sigma: f64| {
        Vector::new(
            random.normal(sigma),
            random.normal(sigma),
            random.normal(sigma),
        )
    };
    let shift = normal(0.05e-3);
    let turn = normal(0.005_f64.to_radians());
    Pose::from_parts(
        (pose.translation.vector + shift).into(),
        Rotation::new(turn) * pose.rotation,
    )
}

pub fn rough(pose: &Pose) -> Pose {
    // What a user measures: 20 mm and a degree off.
    Pose::from_parts(
        (pose.translation.vector + Vector::new(0.02, -0.015, 0.02)).into(),
        Rotation::new(Vector::new(0.015, 0.01, -0.015)) * pose.rotation,
    )
}

pub fn plan(count: usize) -> PosePlan {
    PosePlan {
        board: BOARD,
        mounting: Mounting::EyeToHand,
        intrinsics: camera(SensorSpec::ideal()).intrinsics,
        camera: rough(&base_from_camera()),
        board_pose: rough(&flange_from_board()),
        region: Pose::translation(1.7, 0.0, 1.2),
        half_extents: Vector::new(0.35, 0.45, 0.45),
        max_tilt: 30f64.to_radians(),
        count,
    }
}

/// The whole plate is seen: nothing of arm or gripper lies before it.
pub fn nothing_in_the_way(base_from_flange: &Pose) -> bool {
    let mut spec = camera(SensorSpec::ideal());
    let i = &mut spec.intrinsics;
    (i.width, i.height) = (i.width / 4, i.height / 4);
    (i.fx, i.fy, i.cx, i.cy) = (i.fx / 4.0, i.fy / 4.0, i.cx / 4.0, i.cy / 4.0);
    let (plate, _) = board_bodies(&BOARD, &(base_from_flange * flange_from_board()));
    let count = |shapes: &[RenderShape]| {
        let shot = capture(&spec, &base_from_camera(), shapes, 0);
        shot.ids.iter().filter(|id| **id == BOARD_ID).count()
    };
    let mut all = surroundings(base_from_flange);
    all.push(plate.clone());
    let flange = base_from_flange.translation.vector;
    count(&all) == count(&[plate]) && flange.xy().norm() < 2.6
}

/// Mean error over the corners of the pallet volume, metres.
pub fn corner_error(found: &Pose, truth: &Pose) -> f64 {
    let mut sum = 0.0;
    for k in 0..8 {
        let side = |bit: usize| if k & bit == 0 { -0.5 } else { 0.5 };
        let corner = Point::new(
            1.7 + 0.8 * side(1),
            1.2 * side(2),
            0.144 + 0.75 + 1.5 * side(4),
        );
        sum += (found * truth.inverse_transform_point(&corner) - corner).norm();
    }
    sum / 8.0
}
