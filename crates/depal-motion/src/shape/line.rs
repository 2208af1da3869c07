//! Joint positions along a straight line or an arc of the TCP.

use depal_arm::Arm;
use depal_frames::nalgebra::Translation3;
use depal_frames::{JointPositions, Pose, Rotation, Vector};

use super::posture::out_of_reach;
use crate::MotionError;
use crate::circle::Circle;

/// TCP travel and turn between grid points of a linear move, metres and radians.
const LINE_STEP: f64 = 0.02;
const TURN_STEP: f64 = 0.05;
/// Joint step between grid points of a linear move, and change of that step, above which the grid is refined:
/// between grid points a joint's acceleration has to be close to even.
const COARSE_STEP: f64 = 0.12;
const COARSE_BEND: f64 = 0.005;
/// Grid points of a linear move beyond which a large joint step counts as a jump.
const FINEST_GRID: usize = 1024;

/// Joint positions on an even grid along a straight TCP line, or along an arc; the orientation turns evenly.
pub(super) fn line(
    arm: &Arm,
    start: &JointPositions,
    base_from_target: &Pose,
    flange_from_tcp: &Pose,
    circle: Option<&Circle>,
) -> Result<Vec<JointPositions>, MotionError> {
    let base_from_start = arm.base_from_flange(start) * flange_from_tcp;
    let way = base_from_target.translation.vector - base_from_start.translation.vector;
    let turn = (base_from_start.rotation.inverse() * base_from_target.rotation).scaled_axis();
    let length = circle.map_or_else(|| way.norm(), Circle::length);
    let place = |share: f64| -> Vector {
        circle.map_or_else(
            || base_from_start.translation.vector + way * share,
            |circle| circle.at(share),
        )
    };
    let tcp_from_flange = flange_from_tcp.inverse();
    let at = |share: f64| {
        Pose::from_parts(
            Translation3::from(place(share)),
            base_from_start.rotation * Rotation::from_scaled_axis(turn * share),
        )
    };
    if arm
        .inverse_nearest(&(at(1.0) * tcp_from_flange), start)
        .is_none()
    {
        return Err(out_of_reach(base_from_target));
    }
    let mut pieces = ((length / LINE_STEP).max(turn.norm() / TURN_STEP).ceil() as usize).max(8);
    loop {
        let mut joints = Vec::with_capacity(pieces + 1);
        joints.push(*start);
        let mut widest = (0, 0, 0.0_f64);
        for i in 1..=pieces {
            let share = i as f64 / pieces as f64;
            let tcp = at(share);
            let before = joints[i - 1];
            let Some(found) = arm.inverse_nearest(&(tcp * tcp_from_flange), &before) else {
                let p = tcp.translation.vector * 1e3;
                return Err(MotionError::LineOutOfReach {
                    travelled_mm: share * length * 1e3,
                    length_mm: length * 1e3,
                    x_mm: p.x,
                    y_mm: p.y,
                    z_mm: p.z,
                });
            };
            for (j, (a, b)) in before.iter().zip(found.iter()).enumerate() {
                if (b - a).abs() > widest.2 {
                    widest = (i, j, (b - a).abs());
                }
            }
            joints.push(found);
        }
        let bend = joints
            .windows(3)
            .map(|w| w[0].lerp(&w[2], 0.5).max_distance(&w[1]) * 2.0)
            .fold(0.0, f64::max);
        if widest.2 <= COARSE_STEP && (bend <= COARSE_BEND || pieces > FINEST_GRID) {
            return Ok(joints);
        }
        if pieces > FINEST_GRID {
            return Err(MotionError::LineJumps {
                joint: widest.1 + 1,
                jump_deg: widest.2.to_degrees(),
                travelled_mm: widest.0 as f64 / pieces as f64 * length * 1e3,
                length_mm: length * 1e3,
            });
        }
        pieces *= 2;
    }
}
