//! Where command 701 sends the robot without a board: flange poses spread over the space above the pallet.
//! The dialogue is the whole; nothing is measured.

use depal_arm::Arm;
use depal_frames::{JointPositions, Pose, Rotation, Vector};
use depal_interface::CalibrationPose;

use crate::build::solids::pose_mm_yaw;
use crate::scene::Scene;

/// Places along each side of the pallet.
const PLACES: [f64; 3] = [-0.35, 0.0, 0.35];
/// Heights of the flange above the deck, metres, taken in turn.
const HEIGHTS: [f64; 3] = [0.9, 1.1, 1.3];
/// Leans of the tool against the vertical, taken in turn: calibration needs turns about different axes.
const LEANS_DEG: [[f64; 2]; 4] = [[0.0, 0.0], [15.0, 0.0], [0.0, 15.0], [-12.0, -12.0]];

/// Poses that the arm reaches from `start`; none if it reaches fewer than three.
pub(super) fn poses(scene: &Scene, arm: &Arm, start: &JointPositions) -> Vec<CalibrationPose> {
    let base_from_world = pose_mm_yaw(scene.robot.base_xyz_mm, scene.robot.base_yaw_deg).inverse();
    let pallet = &scene.pallet;
    let base_from_pallet = base_from_world * pose_mm_yaw(pallet.xyz_mm, pallet.yaw_deg);
    let size = pallet.size_mm.map(|side| side * 1e-3);
    let mut poses: Vec<CalibrationPose> = Vec::new();
    let mut before = *start;
    for (row, x) in PLACES.into_iter().enumerate() {
        for (column, y) in PLACES.into_iter().enumerate() {
            let number = row * PLACES.len() + column;
            let height = size[2] + HEIGHTS[(row + column) % HEIGHTS.len()];
            let [lean_x, lean_y] = LEANS_DEG[number % LEANS_DEG.len()].map(f64::to_radians);
            let down = Rotation::from_axis_angle(&Vector::x_axis(), std::f64::consts::PI);
            let lean = Rotation::from_euler_angles(lean_x, lean_y, 0.0);
            let place = Vector::new(x * size[0], y * size[1], height);
            let base_from_flange = base_from_pallet * Pose::from_parts(place.into(), lean * down);
            if let Some(joints) = arm.inverse_nearest(&base_from_flange, &before) {
                before = joints;
                poses.push(CalibrationPose {
                    base_from_flange,
                    joints,
                });
            }
        }
    }
    if poses.len() < 3 { Vec::new() } else { poses }
}
