//! Calls that store what was received to registers and outputs. They ask nothing of the vision system.

use depal_vm::system::System;
use depal_vm::{CallContext, RaisedError, Value};

use super::link::{argument, report};
use super::stored_point::{StoredPoint, count, point};
use crate::builtins::{Ran, done, number, set_output};
use crate::position::{Position, shown_from_arm};
use crate::state;
use depal_frames::JointPositions;

/// Most custom values that are stored.
const MOST_CUSTOM: usize = 50;

fn stored(context: &CallContext<'_>) -> Result<StoredPoint, RaisedError> {
    let serial = number(context, 0)?;
    point(context.memory, serial).ok_or_else(|| {
        let held = count(context.memory);
        argument(format!("Serial is {serial}, {held} points are held"))
    })
}

/// Puts the values of a point to a position register.
fn store(context: &mut CallContext<'_>, at: usize, point: &StoredPoint) -> Result<(), RaisedError> {
    let register = number(context, at)?;
    let position = if point.is_joint {
        let joints = JointPositions::from_degrees(&point.values);
        Position::joint(shown_from_arm(&joints, state::is_coupled(context.memory)))
    } else {
        Position::cartesian(point.values)
    };
    state::set_position(context.memory, register, &position)
}

fn set(context: &mut CallContext<'_>, at: usize, value: f64) -> Result<(), RaisedError> {
    let register = number(context, at)?;
    state::set_register(context.memory, register, value)
}

/// Values to registers one after the other, from the one whose number is argument `at`.
fn set_all(context: &mut CallContext<'_>, at: usize, values: &[f64]) -> Result<(), RaisedError> {
    let first = number(context, at)?;
    for (index, value) in values.iter().enumerate() {
        state::set_register(context.memory, first + index as f64, *value)?;
    }
    Ok(())
}

fn demand(point: &StoredPoint, is_joint: bool, call: &str) -> Result<(), RaisedError> {
    if point.is_joint == is_joint {
        return Ok(());
    }
    let (held, other) = if is_joint {
        ("tool poses", "MM_GET_POS")
    } else {
        ("joint angles", "MM_GET_JPS")
    };
    Err(argument(format!(
        "{call}: the points held are {held}; {other} stores them"
    )))
}

fn point_with_speed(context: &mut CallContext<'_>, is_joint: bool, call: &str) -> Ran {
    let point = stored(context)?;
    demand(&point, is_joint, call)?;
    store(context, 1, &point)?;
    set(context, 2, point.label)?;
    set(context, 3, point.speed)?;
    report(context, 4, 0)?;
    done()
}

pub(super) fn pose(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    point_with_speed(context, false, "MM_GET_POS")
}

pub(super) fn joints(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    point_with_speed(context, true, "MM_GET_JPS")
}

pub(super) fn custom_point(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let point = stored(context)?;
    demand(&point, false, "MM_GET_DYPOS")?;
    store(context, 1, &point)?;
    set(context, 2, point.label)?;
    let custom = &point.custom[..point.custom.len().min(MOST_CUSTOM)];
    set_all(context, 3, custom)?;
    report(context, 4, 0)?;
    done()
}

pub(super) fn plan_point(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let point = stored(context)?;
    let format = number(context, 1)?;
    if (format == 1.0 || format == 3.0) != point.is_joint {
        return Err(argument(format!(
            "Jps_Pos is {format}, but MM_GET_PLNDT was called with another form"
        )));
    }
    store(context, 2, &point)?;
    set(context, 3, point.move_type)?;
    set(context, 4, point.tool)?;
    set(context, 5, point.speed)?;
    let custom = &point.custom[..point.custom.len().min(MOST_CUSTOM)];
    set_all(context, 6, custom)?;
    set_all(context, 7, &point.plan)?;
    report(context, 8, 0)?;
    done()
}

/// Switches every listed output on; no other is touched.
pub(super) fn outputs(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let listed: Vec<i64> = state::items(context.memory, state::DO_LIST)
        .iter()
        .filter_map(|value| match value {
            Value::Int(output) if *output >= 0 => Some(*output),
            _ => None,
        })
        .collect();
    for output in listed {
        set_output(context.memory, system, output as u32, true)
            .map_err(|f| context.system_fault(f))?;
    }
    report(context, 0, 0)?;
    done()
}
