//! The calibration of a scene: the board, and where command 701 sends the robot.

mod sight;

use depal_cell::calibration::CalibrationSpec;
use depal_cell::spec::CellSpec;
use depal_frames::nalgebra::Translation3;
use depal_frames::{Pose, Rotation, Shape, Vector};
use depal_interface::CalibrationPose;
use depal_vision::calibration::{CircleBoard, Mounting, PosePlan, plan_poses};

use self::sight::Sight;
use super::BuildError;
use crate::calibration::{BoardMounting, Calibration};
use crate::scene::Scene;

/// Tool and board stay this far above the stack, metres.
const CLEARANCE: f64 = 0.05;
/// Height of the volume above the stack, metres, unless the scene gives one.
const HEIGHT: f64 = 1.2;
/// Above the stack the volume begins here, metres: the tool hangs below a tilted board.
const ABOVE_STACK: f64 = 0.3;
/// From a camera on the flange, the plate's diagonal is this share of the picture's shorter side in the middle of
/// the volume: the distance at which such a camera works, and the plate whole in view at every turn.
const PLATE_SHARE: f64 = 0.4;
/// Half of that volume's sides, as shares of the distance to the board: views at up to 45 degrees.
const BEFORE_BOARD: [f64; 3] = [0.5, 0.5, 0.25];

/// Board and mounting, if the scene has a calibration.
pub(super) fn spec(
    scene: &Scene,
    base_from_world: &Pose,
) -> Result<Option<CalibrationSpec>, BuildError> {
    let Some(calibration) = &scene.calibration else {
        return Ok(None);
    };
    // The scene's own check: of board and camera one is on the flange.
    let mounted = BoardMounting::before(scene.camera.mount);
    let facing_up = match mounted {
        BoardMounting::Flange => [180.0, 0.0, 0.0],
        BoardMounting::Fixed => [0.0; 3],
    };
    let [roll, pitch, yaw] = calibration
        .rpy_deg
        .unwrap_or(facing_up)
        .map(f64::to_radians);
    let placed = Pose::from_parts(
        Translation3::from(Vector::from(calibration.xyz_mm) * 1e-3),
        Rotation::from_euler_angles(roll, pitch, yaw),
    );
    let (mounting, board_pose) = match mounted {
        BoardMounting::Flange => (Mounting::EyeToHand, placed),
        BoardMounting::Fixed => (Mounting::EyeInHand, base_from_world * placed),
    };
    let board = CircleBoard {
        columns: calibration.board.columns as usize,
        rows: calibration.board.rows as usize,
        pitch: calibration.board.pitch_mm * 1e-3,
        disc_diameter: calibration.board.disc_mm * 1e-3,
    };
    board
        .validate()
        .map_err(|problem| mismatch("calibration.board", &problem))?;
    Ok(Some(CalibrationSpec {
        board,
        mounting,
        board_pose,
        repeatability: calibration.repeatability_mm * 1e-3,
    }))
}

fn mismatch(key: &'static str, problem: &dyn std::error::Error) -> BuildError {
    BuildError::Mismatch {
        key,
        message: problem.to_string(),
    }
}

/// Where 701 sends the robot: spread over the volume, within reach, the board in plain sight of camera
/// and projector, tool and board above the stack there and on the joint moves between.
/// Without a calibration none: the server then refuses 701.
pub(super) fn poses(scene: &Scene, cell: &CellSpec) -> Result<Vec<CalibrationPose>, BuildError> {
    let (Some(calibration), Some(spec)) = (&scene.calibration, &cell.calibration) else {
        return Ok(Vec::new());
    };
    let sight = Sight::new(cell, spec, highest(cell, spec) + CLEARANCE);
    let (centre, half_extents) = volume(scene, calibration, cell, spec);
    let base_from_world = cell.world_from_base.inverse();
    let plan = PosePlan {
        board: spec.board,
        mounting: spec.mounting,
        intrinsics: cell.camera.intrinsics,
        camera: cell.carrier_from_camera,
        board_pose: spec.board_pose,
        region: base_from_world * Pose::translation(centre.x, centre.y, centre.z),
        half_extents,
        max_tilt: calibration.max_tilt_deg.to_radians(),
        count: calibration.poses as usize,
    };
    let flanges = plan_poses(&plan, |base_from_flange| {
        sight
            .joints(base_from_flange)
            .is_some_and(|joints| sight.is_free(&joints) && sight.is_board_seen(&joints))
    })
    .map_err(|problem| mismatch("calibration", &problem))?;
    sight.in_order(&flanges)
}

/// The volume in the world: its middle and half of its sides.
fn volume(
    scene: &Scene,
    calibration: &Calibration,
    cell: &CellSpec,
    spec: &CalibrationSpec,
) -> (Vector, Vector) {
    if let (Some(centre), Some(size)) = (calibration.region_xyz_mm, calibration.region_size_mm) {
        return (Vector::from(centre) * 1e-3, Vector::from(size) * 0.5e-3);
    }
    if spec.mounting == Mounting::EyeInHand {
        let lens = &cell.camera.intrinsics;
        let [x, y] = spec.board.plate_size();
        let distance =
            lens.fx.min(lens.fy) * x.hypot(y) / (PLATE_SHARE * lens.width.min(lens.height) as f64);
        let before = cell.world_from_base * spec.board_pose * Pose::translation(0.0, 0.0, distance);
        return (
            before.translation.vector,
            Vector::from(BEFORE_BOARD) * distance,
        );
    }
    let stack_top = stack_top(cell);
    let pallet = &scene.pallet;
    let middle = stack_top + ABOVE_STACK + 0.5 * HEIGHT;
    (
        Vector::new(pallet.xyz_mm[0] * 1e-3, pallet.xyz_mm[1] * 1e-3, middle),
        Vector::new(
            0.5e-3 * pallet.size_mm[0],
            0.5e-3 * pallet.size_mm[1],
            0.5 * HEIGHT,
        ),
    )
}

/// Height of the highest thing that the tool must not touch, world, metres.
fn highest(cell: &CellSpec, spec: &CalibrationSpec) -> f64 {
    let corners = spec.board.corners().map(|corner| {
        let at = cell.world_from_base * spec.board_pose * corner;
        at.z
    });
    match spec.mounting {
        Mounting::EyeToHand => stack_top(cell),
        Mounting::EyeInHand => corners.into_iter().fold(stack_top(cell), f64::max),
    }
}

/// Height of the highest carton, or of the highest fixed solid that is not the floor, world, metres.
fn stack_top(cell: &CellSpec) -> f64 {
    let cartons = cell
        .cartons
        .iter()
        .map(|c| c.world_from_centre.translation.z + 0.5 * c.size.height);
    let fixed = cell
        .known_obstacles
        .iter()
        .map(|o| (cell.world_from_base * o.pose).translation.z + upright_half_height(&o.shape));
    cartons.chain(fixed).fold(0.0, f64::max)
}

fn upright_half_height(shape: &Shape) -> f64 {
    match shape {
        Shape::Cuboid { half_extents } => half_extents.z,
        Shape::Cylinder { half_length, .. } => *half_length,
        Shape::Capsule {
            half_length,
            radius,
        } => half_length + radius,
        Shape::Sphere { radius } => *radius,
        Shape::Hull(hull) => hull.half_extents().z,
    }
}
