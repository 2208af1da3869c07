//! The way of a move, and what happens along it.

use std::task::Poll;

use depal_frames::Vector;
use depal_frames::nalgebra::{Rotation3, Unit};
use depal_time::SimDuration;
use depal_vm::system::{MoveId, PathAction, PathEvent, PathPlace, System};
use depal_vm::{CallContext, Interrupt, Outcome, RaisedError, Trigger, Value};

use super::state::*;
use super::table::Ran;

/// Half way and end of an arc through three points that is so many radians long; negative turns the other way.
/// `None` if the points lie on a line.
pub(super) fn arc_end([start, via, end]: [Vector; 3], angle: f64) -> Option<[Vector; 2]> {
    let (a, b) = (via - start, end - start);
    let normal = a.cross(&b);
    let size = normal.norm_squared();
    if size < 1e-18 {
        return None;
    }
    // The centre of the circle through three points.
    let to_centre =
        (normal.cross(&a) * b.norm_squared() + b.cross(&normal) * a.norm_squared()) / (2.0 * size);
    let axis = Unit::new_normalize(normal);
    let at = |angle: f64| start + to_centre - Rotation3::from_axis_angle(&axis, angle) * to_centre;
    Some([at(angle / 2.0), at(angle)])
}

/// Kinds of what is noted for the next move, the first part of the record.
const OUTPUT: i64 = 0;
const CALL: i64 = 1;
/// An output that changes when the arm gets here, whatever comes next.
const HERE: i64 = 2;

fn parts(event: &Value) -> Vec<f64> {
    match event {
        Value::Record(parts) => parts
            .iter()
            .map(|p| match p {
                Value::Bool(value) => f64::from(u8::from(*value)),
                other => other.as_number().unwrap_or(0.0),
            })
            .collect(),
        _ => Vec::new(),
    }
}

fn note(context: &mut CallContext<'_>, kind: i64) -> Ran {
    let mut parts = vec![Value::Int(kind)];
    parts.append(context.arguments);
    note_event(context, Value::Record(parts));
    Ok(Outcome::Done(Value::Absent))
}

/// TRIGGER that sets an output: kind of place, distance, delay, output, value.
pub(super) fn trigger(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    place(context, context.number(0)?, context.number(1)?)?;
    note(context, OUTPUT)
}

/// TRIGGER that calls: kind of place, distance, delay, routine, priority.
pub(super) fn trigger_call(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (kind, distance) = (context.number(0)?, context.number(1)?);
    if kind != 0.0 && distance != 0.0 {
        return Err(context.argument_error(
            "a TRIGGER that calls a routine is simulated at the start and the end of a move only",
        ));
    }
    place(context, kind, distance)?;
    note(context, CALL)
}

/// An output that is set when the arm is where the program is: `$OUT_C`.
pub(super) fn output_here(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if moves_under_way(context, system)? == 0 {
        return super::io::write_out(context, system);
    }
    let mut arguments = vec![Value::Int(0), Value::Num(0.0), Value::Num(0.0)];
    arguments.append(context.arguments);
    *context.arguments = arguments;
    note(context, HERE)
}

/// DISTANCE = 0 is the start, 1 the end; PATH counts from the end, or from the start (ONSTART), in millimetres.
fn place(context: &CallContext<'_>, kind: f64, distance: f64) -> Result<PathPlace, RaisedError> {
    match (kind as i64, distance) {
        (0, 0.0) => Ok(PathPlace::AfterStart(0.0)),
        (0, 1.0) => Ok(PathPlace::BeforeEnd(0.0)),
        (0, other) => {
            Err(context.argument_error(format!("DISTANCE is 0 (start) or 1 (end), found {other}")))
        }
        (1, distance) if distance <= 0.0 => Ok(PathPlace::BeforeEnd(-distance * 1e-3)),
        (2, distance) if distance >= 0.0 => Ok(PathPlace::AfterStart(distance * 1e-3)),
        (_, distance) => Err(context.argument_error(format!(
            "PATH = {distance} mm lies outside the next move; only places on it are simulated"
        ))),
    }
}

/// What is noted, as the motion takes it.
pub(super) fn path_events(context: &CallContext<'_>) -> Result<Vec<PathEvent>, RaisedError> {
    let mut along = Vec::new();
    for event in events(context) {
        let parts = parts(event);
        let [kind, at, distance, delay, output, value] = parts[..] else {
            continue;
        };
        if kind as i64 == CALL {
            continue;
        }
        let milliseconds = SimDuration::from_secs_f64(delay.abs() * 1e-3);
        let (lead, delay) = if delay < 0.0 {
            (milliseconds, SimDuration::ZERO)
        } else {
            (SimDuration::ZERO, milliseconds)
        };
        along.push(PathEvent {
            place: place(context, at, distance)?,
            lead,
            delay,
            action: PathAction::Set {
                signal: format!("$OUT[{}]", output as i64),
                value,
            },
        });
    }
    Ok(along)
}

/// Numbers of interrupts that triggers make for themselves begin here.
const TRIGGER_NUMBERS: u32 = 1_000_000;

/// The move was taken: its triggers that call become interrupts, and nothing is noted any more.
pub(super) fn calls_along(context: &mut CallContext<'_>, id: MoveId) {
    let taken = take_events(context);
    for event in taken {
        let parts = parts(&event);
        let [kind, at, distance, delay, routine, priority] = parts[..] else {
            continue;
        };
        if kind as i64 != CALL {
            continue;
        }
        let ends = (at as i64 == 0 && distance == 1.0) || at as i64 == 1;
        let interrupts = &mut context.memory.interrupts;
        let mut number = TRIGGER_NUMBERS;
        while interrupts.find(number).is_some() {
            number += 1;
        }
        interrupts.connected.push(Interrupt {
            number,
            routine: routine as u32,
            trigger: Trigger::Move {
                id,
                ends,
                delay: SimDuration::from_secs_f64(delay.max(0.0) * 1e-3),
                reached: None,
            },
            once: true,
            // -1: the controller chooses.
            priority: Some(if priority < 1.0 { 40 } else { priority as u32 }),
            ..Interrupt::default()
        });
    }
}

/// The arm stands and no move follows: outputs that belong here are set.
pub(super) fn events_without_a_move(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
) -> Result<(), RaisedError> {
    let taken = take_events(context);
    for event in taken {
        let parts = parts(&event);
        if parts.first().map(|kind| *kind as i64) == Some(HERE) && parts.len() == 6 {
            let signal = format!("$OUT[{}]", parts[4] as i64);
            system
                .set_signal(&signal, parts[5])
                .map_err(|fault| context.system_fault(fault))?;
        } else {
            note_event(context, event);
        }
    }
    Ok(())
}

/// BRAKE: the arm stops on its path.
pub(super) fn brake(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if level(context) == 0 {
        return Err(context.argument_error("BRAKE has its place in the routine of an interrupt"));
    }
    match system.hold_motion() {
        Poll::Pending => Ok(Outcome::Blocked),
        Poll::Ready(Ok(())) => {
            if path_state(context) == PathState::Runs {
                set_path_state(context, PathState::Held);
            }
            Ok(Outcome::Done(Value::Absent))
        }
        Poll::Ready(Err(fault)) => Err(context.system_fault(fault)),
    }
}

/// The end of an interrupt's routine: the arm goes on along the path that was held.
pub(super) fn go_on(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if moves_under_way(context, system)? > 0 {
        return Ok(Outcome::Blocked);
    }
    if level(context) > 1 {
        return Ok(Outcome::Done(Value::Absent));
    }
    let state = path_state(context);
    set_path_state(context, PathState::Runs);
    let went_on = match state {
        PathState::Runs => Ok(()),
        PathState::Held => system.resume_motion(),
        PathState::Aside => system.restore_path().and_then(|()| system.resume_motion()),
    };
    match went_on {
        Ok(()) => Ok(Outcome::Done(Value::Absent)),
        Err(fault) => Err(context.system_fault(fault)),
    }
}

/// RESUME: the path is given up, the arm stands.
pub(super) fn leave(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if path_state(context) == PathState::Runs {
        match system.hold_motion() {
            Poll::Pending => return Ok(Outcome::Blocked),
            Poll::Ready(Ok(())) => {}
            Poll::Ready(Err(fault)) => return Err(context.system_fault(fault)),
        }
    }
    // A path put aside for moves of the interrupt is dropped with them.
    let left = system.clear_path().and_then(|()| system.resume_motion());
    left.map_err(|fault| context.system_fault(fault))?;
    set_path_state(context, PathState::Runs);
    forget_moves(context, 0);
    take_events(context);
    Ok(Outcome::Done(Value::Absent))
}
