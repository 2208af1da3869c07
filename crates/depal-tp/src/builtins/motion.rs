//! Moves: where they go, how fast, and how a program waits for them.

use std::task::Poll;

use depal_frames::{Point, Pose};
use depal_time::SimDuration;
use depal_vm::system::{
    MoveId, MoveKind, MoveRequest, MoveSpeed, MoveTarget, MoveZone, PathAction, PathEvent,
    PathPlace, System,
};
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::goal::{Goal, frames, resolve};
use super::positions::as_position;
use super::{Entry, Ran, answer, done, number};
use crate::errors::{interpreter, uninitialized};
use crate::position::Position;
use crate::state;

/// The move whose corner the program has not passed yet, in the modal settings of its machine.
const CORNER: &str = "move that ends in a corner";

pub(super) const ENTRIES: [Entry; 6] = [
    ("settle", settle),
    ("move", start),
    ("move over", move_over),
    ("move wait", move_wait),
    ("move stop", move_stop),
    ("skip is", skip_is),
];

/// Speed of the tool at which a J move of 100 % is not held back, m/s; also that of `max_speed`.
const JOINT_MOVE_TCP: f64 = 10.0;
/// Speed of reorientation where none is programmed, rad/s.
const REORIENTATION: f64 = 4.0 * std::f64::consts::PI;
/// Tool speed that the corner of a J move of 100 % is reckoned with, m/s.
const CORNER_TCP: f64 = 2.0;
/// Seconds of the programmed speed that a CNT100 corner takes to each side.
const CORNER_SECONDS: f64 = 0.1;

/// Arguments of `move`.
mod argument {
    pub const KIND: usize = 0;
    pub const TARGET: usize = 1;
    pub const NAME: usize = 2;
    pub const VIA: usize = 3;
    pub const SPEED: usize = 4;
    pub const UNIT: usize = 5;
    pub const CONTINUOUS: usize = 6;
    pub const ACCELERATION: usize = 7;
    pub const OFFSET: usize = 8;
    pub const TOOL_OFFSET: usize = 9;
    pub const INCREMENTAL: usize = 10;
    pub const WAITS: usize = 11;
    /// Then five for each output along the way.
    pub const ALONG: usize = 12;
}

/// Length of the tool's path from where the queue ends, metres.
fn way(system: &dyn System, target: &MoveTarget, flange_from_tcp: &Pose) -> f64 {
    let begin = (system.forward(&system.planned_joints()) * flange_from_tcp)
        .translation
        .vector;
    match target {
        MoveTarget::Joints(joints) => ((system.forward(joints) * flange_from_tcp)
            .translation
            .vector
            - begin)
            .norm(),
        MoveTarget::Tcp(to) => (to.translation.vector - begin).norm(),
        MoveTarget::Arc { through, to } => {
            (through.coords - begin).norm() + (to.translation.vector - through.coords).norm()
        }
    }
}

fn optional(context: &CallContext<'_>, index: usize) -> Result<Option<f64>, RaisedError> {
    if context.is_given(index) {
        number(context, index).map(Some)
    } else {
        Ok(None)
    }
}

/// A value that must lie above 0 and not above a limit.
fn within(name: &str, value: f64, most: f64) -> Result<f64, RaisedError> {
    if value > 0.0 && value <= most {
        Ok(value)
    } else {
        Err(interpreter(format!(
            "Speed out of range: {name} is {value}, expected more than 0 and at most {most}"
        )))
    }
}

fn speed(
    context: &CallContext<'_>,
    system: &dyn System,
    target: &MoveTarget,
    flange_from_tcp: &Pose,
) -> Result<MoveSpeed, RaisedError> {
    let share = state::number(context.memory, state::OVERRIDE) / 100.0;
    let acceleration = optional(context, argument::ACCELERATION)?.unwrap_or(100.0);
    if !(0.0..=150.0).contains(&acceleration) {
        return Err(interpreter(format!(
            "Invalid value: ACC{acceleration}; 0 to 150 are possible"
        )));
    }
    let value = optional(context, argument::SPEED)?.unwrap_or(100.0);
    let mut speed = MoveSpeed {
        tcp: JOINT_MOVE_TCP,
        orientation: REORIENTATION,
        joint_fraction: share,
        acceleration_fraction: (acceleration / 100.0).clamp(0.01, 1.0),
    };
    match number(context, argument::UNIT)? as i64 {
        0 => {
            let fraction = within("the percentage", value, 100.0)? / 100.0;
            speed.joint_fraction = fraction * share;
            speed.tcp = JOINT_MOVE_TCP * fraction;
            speed.orientation = REORIENTATION * fraction;
        }
        1 => speed.tcp = within("the speed in mm/sec", value, 1e4)? * 1e-3,
        2 => speed.tcp = within("the speed in cm/min", value, 6e4)? * 1e-2 / 60.0,
        3 => speed.tcp = within("the speed in inch/min", value, 3e4)? * 25.4e-3 / 60.0,
        4 => speed.orientation = within("the speed in deg/sec", value, 1e4)?.to_radians(),
        unit @ (5 | 6) => {
            let seconds = within("the time", value, 1e6)? * if unit == 6 { 1e-3 } else { 1.0 };
            speed.tcp = (way(system, target, flange_from_tcp) / seconds).max(1e-4);
        }
        _ => {}
    }
    speed.tcp *= share;
    speed.orientation *= share;
    Ok(speed)
}

fn zone(
    context: &CallContext<'_>,
    kind: MoveKind,
    speed: &MoveSpeed,
) -> Result<MoveZone, RaisedError> {
    let Some(value) = optional(context, argument::CONTINUOUS)? else {
        return Ok(MoveZone::Fine);
    };
    if !(0.0..=100.0).contains(&value) {
        return Err(interpreter(format!(
            "Invalid value: CNT{value}; 0 to 100 are possible"
        )));
    }
    let tcp = match kind {
        MoveKind::Joint => CORNER_TCP * speed.joint_fraction,
        MoveKind::Linear => speed.tcp,
    };
    let tcp = value / 100.0 * tcp.min(JOINT_MOVE_TCP) * CORNER_SECONDS;
    Ok(MoveZone::Fly {
        tcp,
        // As far as a corner of that size turns on a circle of half a metre.
        orientation: tcp / 0.5,
    })
}

fn along(context: &CallContext<'_>) -> Result<Vec<PathEvent>, RaisedError> {
    let mut events = Vec::new();
    let mut at = argument::ALONG;
    while context.is_given(at) {
        let when = number(context, at)? as i64;
        let amount = number(context, at + 1)?;
        let word = context.string(at + 2)?;
        let index = number(context, at + 3)?;
        let value = number(context, at + 4)?;
        if word == "DO" && state::group_of(context.memory, index as u32).is_some() {
            return Err(interpreter(format!(
                "DO[{index}] is a bit of a group; switching it along a move is not simulated"
            )));
        }
        let time = SimDuration::from_secs_f64(amount.clamp(0.0, 60.0));
        let (place, lead, delay) = match when {
            0 => (0.0, time, SimDuration::default()),
            1 => (0.0, SimDuration::default(), time),
            _ => (
                amount.max(0.0) * 1e-3,
                SimDuration::default(),
                SimDuration::default(),
            ),
        };
        events.push(PathEvent {
            place: PathPlace::BeforeEnd(place),
            lead,
            delay,
            action: PathAction::Set {
                signal: format!("{word}[{index}]"),
                value,
            },
        });
        at += 5;
    }
    Ok(events)
}

fn offset(context: &CallContext<'_>, index: usize) -> Result<Option<Position>, RaisedError> {
    match context.value(index)? {
        None => Ok(None),
        // The condition that was set last.
        Some(Value::Int(which)) => {
            let held = state::items(context.memory, state::CONDITIONS).get(*which as usize);
            match held.and_then(Position::from_value) {
                Some(position) => Ok(Some(position)),
                None => Err(uninitialized(
                    "the offset (no OFFSET CONDITION came before)",
                )),
            }
        }
        Some(value) => as_position(value).map(Some),
    }
}

fn request(
    context: &CallContext<'_>,
    system: &dyn System,
) -> Result<(MoveRequest, Vec<PathEvent>), RaisedError> {
    let kind = match number(context, argument::KIND)? as i64 {
        0 => MoveKind::Joint,
        _ => MoveKind::Linear,
    };
    let position = as_position(context.required(argument::TARGET)?)?;
    let name = context.string(argument::NAME)?;
    let is_condition = matches!(context.value(argument::OFFSET)?, Some(Value::Int(_)));
    let frame = state::items(context.memory, state::CONDITIONS)
        .get(state::OFFSET_FRAME)
        .and_then(Value::as_number)
        .filter(|_| is_condition);
    let mut goal = Goal {
        position: &position,
        name: &name,
        offset: offset(context, argument::OFFSET)?.map(|o| (o, frame)),
        tool_offset: offset(context, argument::TOOL_OFFSET)?,
        is_incremental: context.value(argument::INCREMENTAL)? == Some(&Value::Bool(true)),
    };
    let mut target = resolve(context.memory, system, &goal)?;
    let (_, flange_from_tcp) = frames(context.memory);
    if let Some(via) = context.value(argument::VIA)? {
        let via = as_position(via)?;
        goal.position = &via;
        let pose_of = |target: MoveTarget| match target {
            MoveTarget::Joints(joints) => system.forward(&joints) * flange_from_tcp,
            MoveTarget::Tcp(pose) | MoveTarget::Arc { to: pose, .. } => pose,
        };
        let through = pose_of(resolve(context.memory, system, &goal)?);
        target = MoveTarget::Arc {
            through: Point::from(through.translation.vector),
            to: pose_of(target),
        };
    }
    if let (MoveKind::Linear, MoveTarget::Joints(joints)) = (kind, &target) {
        // A straight line to taught joints ends at the pose that they make.
        target = MoveTarget::Tcp(system.forward(joints) * flange_from_tcp);
    }
    let speed = speed(context, system, &target, &flange_from_tcp)?;
    let request = MoveRequest {
        kind,
        target,
        speed,
        zone: zone(context, kind, &speed)?,
        flange_from_tcp,
        configuration: None,
        location: context.location.clone(),
    };
    Ok((request, along(context)?))
}

/// The payload schedule in use, gripper and part together: mass, kg, and its centre, m in the flange frame.
/// `$PLST_GRP1[n].$PAYLOAD` is in kg, `$PAYLOAD_X` to `_Z` in cm (as on the payload screen; our reading, to be
/// confirmed). None while the mass has no value: then what the cabinet was set up with counts.
fn load(context: &CallContext<'_>) -> Option<(f64, Point)> {
    let schedule = state::number(context.memory, state::PAYLOAD);
    let part = |name: &str| {
        let name = format!("$PLST_GRP1[{schedule}].$PAYLOAD{name}");
        super::registers::system_variable(context.memory, &name).and_then(|v| v.as_number())
    };
    let mass = part("").filter(|mass| *mass >= 0.0)?;
    let centre = ["_X", "_Y", "_Z"].map(|axis| part(axis).unwrap_or(0.0) * 1e-2);
    Some((mass, Point::from(centre)))
}

/// Queues a move; waits for it if it ends in FINE. Answers its number.
fn start(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if context.notes.is_empty() {
        let (request, events) = request(context, system)?;
        system.set_tool_load(load(context));
        let id = match system.start_move_with_events(&request, &events) {
            Poll::Pending => return Ok(Outcome::Blocked),
            Poll::Ready(Ok(id)) => id,
            Poll::Ready(Err(fault)) => return Err(context.system_fault(fault)),
        };
        let waits = context.value(argument::WAITS)? == Some(&Value::Bool(true));
        if request.zone != MoveZone::Fine && waits {
            context.memory.modal.insert(CORNER, id.0 as f64);
        } else {
            context.memory.modal.remove(CORNER);
        }
        if request.zone != MoveZone::Fine || !waits {
            return answer(Value::Int(id.0 as i64));
        }
        context.notes.push(Value::Int(id.0 as i64));
    }
    let Some(Value::Int(id)) = context.notes.first() else {
        return done();
    };
    let id = *id;
    match system.is_move_done(MoveId(id as u64)) {
        Ok(true) => answer(Value::Int(id)),
        Ok(false) => Ok(Outcome::Blocked),
        Err(fault) => Err(context.system_fault(fault)),
    }
}

/// Waits until the arm has passed the corner of the last CNT move: what touches the world beside the arm comes after
/// it, while registers are reckoned with ahead of the arm.
fn settle(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let Some(id) = context.memory.modal.get(CORNER) else {
        return done();
    };
    match system.is_move_done(MoveId(*id as u64)) {
        Ok(true) => {
            context.memory.modal.remove(CORNER);
            done()
        }
        Ok(false) => Ok(Outcome::Blocked),
        Err(fault) => Err(context.system_fault(fault)),
    }
}

fn id(context: &CallContext<'_>) -> Result<MoveId, RaisedError> {
    Ok(MoveId(number(context, 0)? as u64))
}

fn move_over(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    match system.is_move_done(id(context)?) {
        Ok(over) => answer(Value::Bool(over)),
        Err(fault) => Err(context.system_fault(fault)),
    }
}

fn move_wait(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    match system.is_move_done(id(context)?) {
        Ok(true) => done(),
        Ok(false) => Ok(Outcome::Blocked),
        Err(fault) => Err(context.system_fault(fault)),
    }
}

/// Stops the arm where it is; the rest of the move is dropped.
fn move_stop(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if context.notes.is_empty() {
        system.stop_motion();
        context.notes.push(Value::Bool(true));
    }
    if system.is_standing() {
        done()
    } else {
        Ok(Outcome::Blocked)
    }
}

/// Whether this is the SKIP CONDITION that was set last.
fn skip_is(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let wanted = number(context, 0)?;
    let held = state::items(context.memory, state::CONDITIONS).get(state::SKIP);
    answer(Value::Bool(held.and_then(Value::as_number) == Some(wanted)))
}
