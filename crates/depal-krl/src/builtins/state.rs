//! What the built-ins remember: variables that no program can name.

use depal_frames::Point;
use depal_vm::system::{MoveId, System};
use depal_vm::{CallContext, RaisedError, Value};

use super::eki::{FLAG_COUNT, Links, channels};
use super::table::slot_of;

const MOVES: usize = 0;
const EVENTS: usize = 1;
const PATH: usize = 2;
pub(crate) const CHANNELS: usize = 3;
const SUBMIT: usize = 4;
pub(super) const TIMERS: usize = 5;
pub(super) const FLAGS: usize = 6;

/// Number of `$TIMER`.
const TIMER_COUNT: usize = 64;

/// How many global slots at the front belong to each task alone, whatever tasks share.
pub const OWN_GLOBALS: usize = 5;

const HIDDEN_GLOBALS: usize = 7;

/// Variables before all others.
pub(crate) fn hidden_globals() -> [(&'static str, Value); HIDDEN_GLOBALS] {
    // Milliseconds while it stands, and since when it runs (nanoseconds, -1 while it stands).
    let timer = Value::Record(vec![Value::Int(0), Value::Int(-1)]);
    [
        ("moves under way", Value::Array(Vec::new())),
        ("outputs along the next move", Value::Array(Vec::new())),
        ("path", Value::Int(0)),
        ("channels", channels(Links::default())),
        ("runs beside the robot", Value::Bool(false)),
        ("timers", Value::Array(vec![timer; TIMER_COUNT])),
        ("flags", Value::Array(vec![Value::Bool(false); FLAG_COUNT])),
    ]
}

/// The program is one of the submit interpreter: it never waits for the arm.
pub(crate) fn make_submit(globals: &mut [Value]) {
    globals[SUBMIT] = Value::Bool(true);
}

pub(super) fn is_submit(context: &CallContext<'_>) -> bool {
    context.memory.globals[SUBMIT] == Value::Bool(true)
}

/// What became of the path that an interrupt stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PathState {
    Runs,
    Held,
    /// Put aside for other moves.
    Aside,
}

pub(super) fn path_state(context: &CallContext<'_>) -> PathState {
    match context.memory.globals.get(PATH) {
        Some(Value::Int(1)) => PathState::Held,
        Some(Value::Int(2)) => PathState::Aside,
        _ => PathState::Runs,
    }
}

pub(super) fn set_path_state(context: &mut CallContext<'_>, state: PathState) {
    context.memory.globals[PATH] = Value::Int(state as i64);
}

/// How many interrupt routines are inside each other.
pub(super) fn level(context: &CallContext<'_>) -> i64 {
    let frames = context.memory.frames.iter();
    frames.filter(|frame| frame.serves().is_some()).count() as i64
}

fn list<'a>(context: &'a mut CallContext<'_>, slot: usize) -> &'a mut Vec<Value> {
    match &mut context.memory.globals[slot] {
        Value::Array(items) => items,
        _ => unreachable!("the hidden variables keep their kinds"),
    }
}

fn number(value: &Value, part: usize) -> i64 {
    match value {
        Value::Record(parts) => match parts.get(part) {
            Some(Value::Int(value)) => *value,
            _ => 0,
        },
        _ => 0,
    }
}

/// How many moves of this level are under way. What is over is forgotten; a move that failed is an error.
pub(super) fn moves_under_way(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
) -> Result<usize, RaisedError> {
    let level = level(context);
    let all = std::mem::take(list(context, MOVES));
    let mut rest = Vec::new();
    for entry in all {
        let id = MoveId(number(&entry, 0) as u64);
        // Of moves that an interrupt put aside nothing is asked.
        let over = number(&entry, 1) >= level
            && system
                .is_move_done(id)
                .map_err(|fault| context.system_fault(fault))?;
        if !over {
            rest.push(entry);
        }
    }
    let count = rest.iter().filter(|e| number(e, 1) >= level).count();
    *list(context, MOVES) = rest;
    Ok(count)
}

pub(super) fn note_move(context: &mut CallContext<'_>, id: MoveId) {
    let level = level(context);
    let entry = Value::Record(vec![Value::Int(id.0 as i64), Value::Int(level)]);
    list(context, MOVES).push(entry);
}

/// The moves of this level are over, or given up.
pub(super) fn forget_moves(context: &mut CallContext<'_>, from_level: i64) {
    list(context, MOVES).retain(|entry| number(entry, 1) < from_level);
}

/// What happens along the next move: a record that the motion reads.
pub(super) fn note_event(context: &mut CallContext<'_>, event: Value) {
    list(context, EVENTS).push(event);
}

pub(super) fn take_events(context: &mut CallContext<'_>) -> Vec<Value> {
    std::mem::take(list(context, EVENTS))
}

pub(super) fn events<'a>(context: &'a CallContext<'_>) -> &'a [Value] {
    match &context.memory.globals[EVENTS] {
        Value::Array(items) => items,
        _ => &[],
    }
}

/// A predefined variable.
pub(super) fn variable<'a>(context: &'a CallContext<'_>, name: &str) -> &'a Value {
    &context.memory.globals[slot_of(name)]
}

pub(super) fn variable_mut<'a>(context: &'a mut CallContext<'_>, name: &str) -> &'a mut Value {
    &mut context.memory.globals[slot_of(name)]
}

/// `$LOAD`, tool and workpiece together: mass, kg, and centre of mass, m in the flange frame. None while its mass is
/// negative or has no value: then what the cabinet was set up with counts. Moments of inertia do not count.
pub(super) fn load_at_flange(context: &CallContext<'_>) -> Option<(f64, Point)> {
    let part = |path: &[usize]| setting(context, "$load", path).ok();
    let mass = part(&[0]).filter(|mass| *mass >= 0.0)?;
    let centre = [0, 1, 2].map(|axis| part(&[1, axis]).unwrap_or(0.0) * 1e-3);
    Some((mass, Point::from(centre)))
}

/// A number of a predefined variable or of a part of it.
pub(super) fn setting(
    context: &CallContext<'_>,
    name: &str,
    path: &[usize],
) -> Result<f64, RaisedError> {
    let mut value = variable(context, name);
    for part in path {
        if let Value::Record(parts) | Value::Array(parts) = value
            && let Some(part) = parts.get(*part)
        {
            value = part;
        }
    }
    value
        .as_number()
        .ok_or_else(|| context.argument_error(format!("{} has no value yet", name.to_uppercase())))
}
