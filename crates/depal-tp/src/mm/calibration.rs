//! MM_CALIB: the hand-eye calibration as a dialogue. The vision system names the points, the robot goes there.

use std::task::Poll;

use depal_frames::{EulerConvention, JointPositions, Pose};
use depal_time::SimTime;
use depal_vm::system::{MoveId, MoveKind, MoveRequest, MoveSpeed, MoveTarget, MoveZone, System};
use depal_vm::{CallContext, Outcome, RaisedError, Value};
use depal_wire::{Calibrate, CalibrationPoint, Reply, Request};

use super::link::{argument, code, exchange, failure, report, whole};
use super::trigger::here;
use crate::builtins::{Ran, done, number};
use crate::position::{Position, shown_from_arm};
use crate::state;

const STATUS: usize = 6;
/// Speed of the flange between points, m/s.
const SPEED: f64 = 0.25;
/// Share of the axes' speed.
const JOINT_SHARE: f64 = 0.1;

/// What happens now; kept as the first note.
const BEGIN: i64 = 0;
const MOVING: i64 = 1;
const STANDING: i64 = 2;
const REACHED: i64 = 3;
const NOT_REACHED: i64 = 4;
/// On the way to the place where the robot stood at first.
const GOING_HOME: i64 = 5;

fn phase(context: &CallContext<'_>) -> i64 {
    match context.notes.first() {
        Some(Value::Int(phase)) => *phase,
        _ => BEGIN,
    }
}

fn enter(context: &mut CallContext<'_>, phase: i64, note: Option<Value>) {
    context.notes.clear();
    context.notes.push(Value::Int(phase));
    context.notes.extend(note);
}

fn note(context: &CallContext<'_>) -> i64 {
    match context.notes.get(1) {
        Some(Value::Int(value)) => *value,
        _ => 0,
    }
}

fn choice(context: &CallContext<'_>, at: usize, name: &str) -> Result<i32, RaisedError> {
    match whole(context, at, name)? {
        value @ (1 | 2) => Ok(value),
        other => Err(argument(format!("{name} is {other}; 1 and 2 are possible"))),
    }
}

/// The move to a point; it is kept in the position register, too.
fn request(
    context: &mut CallContext<'_>,
    system: &dyn System,
    point: &CalibrationPoint,
) -> Result<MoveRequest, RaisedError> {
    let by_joints = choice(context, 1, "PosJps")? == 2;
    let register = number(context, 5)?;
    let (position, target) = if by_joints {
        let count = system.joints().len().min(6);
        let joints = JointPositions::from_degrees(&point.joints_deg[..count]);
        let shown = shown_from_arm(&joints, state::is_coupled(context.memory));
        (Position::joint(shown), MoveTarget::Joints(joints))
    } else {
        let flange = EulerConvention::FanucWpr.pose_from_mm_deg(point.flange);
        (Position::cartesian(point.flange), MoveTarget::Tcp(flange))
    };
    state::set_position(context.memory, register, &position)?;
    let kind = match choice(context, 0, "Move_Type")? {
        1 => MoveKind::Linear,
        _ => MoveKind::Joint,
    };
    Ok(MoveRequest {
        kind,
        target: match (kind, target) {
            // A straight line needs a pose.
            (MoveKind::Linear, MoveTarget::Joints(joints)) => {
                MoveTarget::Tcp(system.forward(&joints))
            }
            (_, target) => target,
        },
        speed: MoveSpeed {
            tcp: SPEED,
            orientation: 0.5,
            joint_fraction: JOINT_SHARE,
            acceleration_fraction: 1.0,
        },
        zone: MoveZone::Fine,
        flange_from_tcp: Pose::identity(),
        configuration: None,
        location: context.location.clone(),
    })
}

fn finish(context: &mut CallContext<'_>, code: i32) -> Ran {
    if report(context, STATUS, code)? || code == 7101 {
        done()
    } else {
        Err(failure("MM_CALIB", code))
    }
}

/// Sends where the robot is, and goes where the reply says.
fn talk(context: &mut CallContext<'_>, system: &mut dyn System, robot_state: i32) -> Ran {
    let (joints_deg, flange) = here(system);
    let sent = Request::Calibrate(Calibrate {
        state: robot_state,
        flange,
        joints_deg: Some(joints_deg),
    });
    let reply = match exchange(context, system, &sent) {
        Poll::Pending => return Ok(Outcome::Blocked),
        Poll::Ready(Err(code)) => return finish(context, code),
        Poll::Ready(Ok(reply)) => reply,
    };
    let Reply::CalibrationPoint(point) = reply else {
        return finish(context, code(&reply));
    };
    let request = request(context, system, &point)?;
    match system.start_move(&request) {
        Poll::Ready(Ok(id)) => {
            let next = if point.is_done { GOING_HOME } else { MOVING };
            enter(context, next, Some(Value::Int(id.0 as i64)));
        }
        // Nothing else is queued here: the queue has room.
        Poll::Pending => {
            return Err(argument(
                "MM_CALIB: the arm is still moving; end the move before with FINE",
            ));
        }
        Poll::Ready(Err(_)) => enter(context, NOT_REACHED, None),
    }
    Ok(Outcome::Blocked)
}

pub(super) fn calibrate(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if context.notes.is_empty() {
        let seconds = number(context, 2)?;
        if !(0.0..=3600.0).contains(&seconds) {
            return Err(argument(format!(
                "WaitTime is {seconds} s, expected 0 to 3600"
            )));
        }
        choice(context, 0, "Move_Type")?;
        choice(context, 1, "PosJps")?;
        if !system.is_standing() {
            return Ok(Outcome::Blocked);
        }
        enter(context, BEGIN, None);
    }
    match phase(context) {
        MOVING | GOING_HOME => match system.is_move_done(MoveId(note(context) as u64)) {
            Ok(false) => Ok(Outcome::Blocked),
            Ok(true) if phase(context) == GOING_HOME => finish(context, 7101),
            Ok(true) => {
                let now = system.now().as_nanos() as i64;
                enter(context, STANDING, Some(Value::Int(now)));
                Ok(Outcome::Blocked)
            }
            Err(fault) => Err(context.system_fault(fault)),
        },
        STANDING => {
            let since = SimTime::from_nanos(note(context) as u64);
            if system.now().saturating_since(since).as_secs_f64() >= number(context, 2)? {
                enter(context, REACHED, None);
                return talk(context, system, 1);
            }
            Ok(Outcome::Blocked)
        }
        REACHED => talk(context, system, 1),
        NOT_REACHED => talk(context, system, 2),
        _ => talk(context, system, 0),
    }
}
