//! How long the moves of a pick take. Single moves are compared by their trapezoids; the whole way of a plan is timed
//! by the law that moves the arm, in the manner of the shipped programs.

use std::sync::Arc;

use depal_arm::Load;
use depal_frames::{Point, Vector};
use depal_motion::{Interpolation, MotionError, Segment, SegmentTarget, Speed, Trajectory, Zone};

pub(crate) use depal_motion::Trapezoid;

use crate::plan::{Motion, Waypoint};
use crate::request::PlanRequest;

/// Speed of the tool centre at 100 % of the shipped programs, m/s.
const TCP_SPEED: f64 = 5.0;
/// Speed of reorientation at 100 %, rad/s.
const TURN_SPEED: f64 = 500.0 * std::f64::consts::PI / 180.0;
/// Corners next to pick and place, and elsewhere.
const NEAR_ZONE: Zone = Zone::Fly {
    tcp: 0.010,
    orientation: 1.5 * std::f64::consts::PI / 180.0,
};
const FREE_ZONE: Zone = Zone::Fly {
    tcp: 0.050,
    orientation: 7.5 * std::f64::consts::PI / 180.0,
};
/// Share of the acceleration with a carton on the gripper.
const LOADED: f64 = 0.7;

/// Time of a chain of moves, seconds. The controller flies past the point between two moves: the ramp down and the
/// next ramp up run at the same time.
pub(crate) fn chain_time(moves: &[Trapezoid]) -> f64 {
    let between = moves.windows(2).map(|pair| pair[0].ramp.min(pair[1].ramp));
    moves.iter().map(|profile| profile.duration).sum::<f64>() - between.sum::<f64>()
}

/// The moves of a plan as the shipped programs make them: percentages of [`TCP_SPEED`], all of the joints' speed,
/// [`LOADED`] of their acceleration behind the pick, stops at pick and place, [`NEAR_ZONE`] beside them.
pub(crate) fn as_driven(request: &PlanRequest, waypoints: &[Waypoint]) -> Vec<Segment> {
    let last = waypoints.len() - 1;
    let pick = waypoints.iter().position(|w| w.is_pick).unwrap_or(last);
    let segment = |(i, waypoint): (usize, &Waypoint)| {
        let share = waypoint.velocity_percent / 100.0;
        Segment {
            interpolation: match waypoint.motion {
                Motion::Joint => Interpolation::Joint,
                Motion::Linear => Interpolation::Linear,
            },
            target: match waypoint.motion {
                Motion::Joint => SegmentTarget::Joints(waypoint.joints),
                Motion::Linear => SegmentTarget::Tcp(waypoint.base_from_tcp),
            },
            flange_from_tcp: request.gripper.flange_from_tcp,
            speed: Speed {
                tcp: TCP_SPEED * share,
                orientation: TURN_SPEED * share,
                joint_fraction: 1.0,
                acceleration_fraction: if i > pick { LOADED } else { 1.0 },
            },
            zone: if i == pick || i == last {
                Zone::Fine
            } else if i.abs_diff(pick) == 1 || i + 1 == last {
                NEAR_ZONE
            } else {
                FREE_ZONE
            },
            quarters: None,
        }
    };
    waypoints.iter().enumerate().map(segment).collect()
}

/// Gripper and carton at the flange: the gripper's mass lies halfway to the tool centre, `carried` kg in the middle
/// of what hangs on the cups (tool frame).
pub(crate) fn loads(request: &PlanRequest, carried: f64, middle_in_tcp: &Vector) -> (Load, Load) {
    let flange_from_tcp = &request.gripper.flange_from_tcp;
    let halfway = Point::from(flange_from_tcp.translation.vector * 0.5);
    let middle = flange_from_tcp * Point::from(*middle_in_tcp);
    (
        Load::point(request.gripper.mass, halfway),
        Load::point(carried, middle),
    )
}

/// Seconds from rest at the start over pick and place, without waiting at the pick.
///
/// # Errors
/// Where the arm cannot make the moves.
pub(crate) fn predicted_time(
    request: &PlanRequest,
    waypoints: &[Waypoint],
    carried: f64,
    middle_in_tcp: &Vector,
) -> Result<f64, MotionError> {
    let (tool, carton) = loads(request, carried, middle_in_tcp);
    let mut trajectory = Trajectory::new(Arc::new(request.arm.clone()), request.start);
    trajectory.set_tool_and_load(&tool, &Load::NONE);
    for (segment, waypoint) in as_driven(request, waypoints).iter().zip(waypoints) {
        trajectory.append(0.0, segment)?;
        if waypoint.is_pick {
            trajectory.set_tool_and_load(&tool, &carton);
        }
    }
    Ok(trajectory.duration())
}
