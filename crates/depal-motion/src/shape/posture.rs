//! The posture in which a target is to be reached, and why it cannot be.

use depal_arm::Arm;
use depal_frames::{JointPositions, Pose};

use crate::{MotionError, Segment};

/// How far beside a quarter turn a joint still counts as in it, radians: 45 degrees, half a quarter, so that a target
/// taught at the edge of a quarter and moved a little keeps its configuration. Our choice, not a manual's.
const QUARTER_MARGIN: f64 = std::f64::consts::FRAC_PI_4;

/// The first of joints 1, 4 and 6 that is not in its quarter turn (0: from 0 to 90 degrees), from 1, with its quarter.
pub(super) fn off_quarters(joints: &JointPositions, quarters: [i32; 3]) -> Option<(usize, i32)> {
    use std::f64::consts::FRAC_PI_2;
    [0, 3, 5]
        .into_iter()
        .zip(quarters)
        .find(|(joint, quarter)| {
            let lower = f64::from(*quarter) * FRAC_PI_2;
            joints.get(*joint).is_some_and(|q| {
                !(lower - QUARTER_MARGIN..=lower + FRAC_PI_2 + QUARTER_MARGIN).contains(q)
            })
        })
        .map(|(joint, quarter)| (joint + 1, quarter))
}

/// The solution nearest to `start` of those in the quarter turns that the segment asks for.
pub(super) fn in_quarters(
    arm: &Arm,
    start: &JointPositions,
    base_from_flange: &Pose,
    segment: &Segment,
) -> Result<JointPositions, MotionError> {
    let solutions = arm.inverse(base_from_flange);
    let Some(quarters) = segment.quarters.filter(|_| !solutions.is_empty()) else {
        return Err(out_of_reach(&(base_from_flange * segment.flange_from_tcp)));
    };
    let nearest = |fits: &dyn Fn(&JointPositions) -> bool| {
        solutions
            .iter()
            .filter(|found| fits(found))
            .min_by(|a, b| a.max_distance(start).total_cmp(&b.max_distance(start)))
            .copied()
    };
    nearest(&|found| off_quarters(found, quarters).is_none()).ok_or_else(|| {
        let found = nearest(&|_| true).unwrap_or(*start);
        let (joint, quarter) = off_quarters(&found, quarters).unwrap_or((1, quarters[0]));
        MotionError::Configuration {
            joint,
            found_deg: found.get(joint - 1).copied().unwrap_or(0.0).to_degrees(),
            quarter,
        }
    })
}

pub(super) fn check_joints(arm: &Arm, joints: &JointPositions) -> Result<(), MotionError> {
    if joints.len() != arm.joint_count() {
        return Err(MotionError::JointCount {
            expected: arm.joint_count(),
            found: joints.len(),
        });
    }
    for (i, (limit, found)) in arm.limits().iter().zip(joints.iter()).enumerate() {
        if !(limit.lower - 1e-9..=limit.upper + 1e-9).contains(found) {
            return Err(MotionError::JointLimit {
                joint: i + 1,
                found_deg: found.to_degrees(),
                lower_deg: limit.lower.to_degrees(),
                upper_deg: limit.upper.to_degrees(),
            });
        }
    }
    Ok(())
}

pub(super) fn out_of_reach(base_from_tcp: &Pose) -> MotionError {
    let p = base_from_tcp.translation.vector * 1e3;
    MotionError::TargetOutOfReach {
        x_mm: p.x,
        y_mm: p.y,
        z_mm: p.z,
    }
}
