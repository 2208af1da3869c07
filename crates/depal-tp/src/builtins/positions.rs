//! Position registers, taught positions, frames and where the arm is.

use depal_vm::system::System;
use depal_vm::{CallContext, RaisedError, Value};

use super::registers::kind;
use super::{Entry, Ran, answer, done, number};
use crate::errors::{interpreter, mismatch, uninitialized};
use crate::position::{Position, shown_from_arm};
use crate::state;

pub(super) const ENTRIES: [Entry; 12] = [
    ("pr get", pr_get),
    ("pr set", pr_set),
    ("pr element get", pr_element_get),
    ("pr element set", pr_element_set),
    ("p get", p_get),
    ("p set", p_set),
    ("p element get", p_element_get),
    ("p element set", p_element_set),
    ("frame get", frame_get),
    ("frame set", frame_set),
    ("lpos", lpos),
    ("jpos", jpos),
];

/// A position out of a value.
pub(crate) fn as_position(value: &Value) -> Result<Position, RaisedError> {
    Position::from_value(value)
        .ok_or_else(|| mismatch(format!("expected a position, found {}", kind(value))))
}

fn pr_get(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let index = number(context, 0)?;
    answer(state::position(context.memory, index)?.to_value())
}

/// A position register belongs to no frame: it means the one in use.
fn pr_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let index = number(context, 0)?;
    let mut position = as_position(context.required(1)?)?;
    position.frame = None;
    position.tool = None;
    state::set_position(context.memory, index, &position)?;
    done()
}

fn element(index: f64, name: &str) -> Result<usize, RaisedError> {
    if index.fract() == 0.0 && (1.0..=6.0).contains(&index) {
        Ok(index as usize - 1)
    } else {
        Err(interpreter(format!(
            "Invalid index: {name} has no element {index}; 1 to 6 are there"
        )))
    }
}

fn pr_element_get(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let index = number(context, 0)?;
    let part = number(context, 1)?;
    let name = format!("PR[{index}]");
    let at = element(part, &name)?;
    let value = state::raw_position(context.memory, index)?.map(|p| p.values[at]);
    match value.filter(|v| v.is_finite()) {
        Some(value) => answer(Value::Dnum(value)),
        None => Err(uninitialized(&format!("PR[{index},{part}]"))),
    }
}

/// The others of a register that had no value stay without one.
fn pr_element_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let index = number(context, 0)?;
    let at = element(number(context, 1)?, &format!("PR[{index}]"))?;
    let mut position = state::raw_position(context.memory, index)?
        .unwrap_or_else(|| Position::cartesian([f64::NAN; 6]));
    position.values[at] = state::stored(number(context, 2)?);
    state::set_position(context.memory, index, &position)?;
    done()
}

/// Place of a taught position in its program's list.
fn taught(context: &CallContext<'_>, slot: u32, index: f64) -> Option<usize> {
    let items = state::items(context.memory, slot);
    items.iter().position(|item| {
        matches!(item, Value::Array(pair) if pair.first().and_then(Value::as_number) == Some(index))
    })
}

fn read_taught(context: &CallContext<'_>) -> Result<Position, RaisedError> {
    let slot = number(context, 0)? as u32;
    let index = number(context, 1)?;
    let found =
        taught(context, slot, index).and_then(|at| match &state::items(context.memory, slot)[at] {
            Value::Array(pair) => pair.get(1).and_then(Position::from_value),
            _ => None,
        });
    found.ok_or_else(|| uninitialized(&format!("P[{index}]")))
}

fn p_get(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let position = read_taught(context)?;
    if !position.is_complete() {
        let index = number(context, 1)?;
        return Err(uninitialized(&format!("P[{index}]")));
    }
    answer(position.to_value())
}

fn write_taught(context: &mut CallContext<'_>, position: &Position) -> Result<(), RaisedError> {
    let slot = number(context, 0)? as u32;
    let index = number(context, 1)?;
    if index.fract() != 0.0 || index < 1.0 {
        return Err(interpreter(format!(
            "Invalid index: there is no P[{index}]"
        )));
    }
    let at = taught(context, slot, index);
    let pair = Value::Array(vec![Value::Dnum(index), position.to_value()]);
    if let Some(items) = state::items_mut(context.memory, slot) {
        match at {
            Some(at) => items[at] = pair,
            None => items.push(pair),
        }
    }
    Ok(())
}

/// A position that is taught belongs to the frames in use.
fn p_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let mut position = as_position(context.required(2)?)?;
    let in_use = |which| Some(state::number(context.memory, which) as u32);
    position.frame = position.frame.or(in_use(state::UFRAME_NUM));
    position.tool = position.tool.or(in_use(state::UTOOL_NUM));
    write_taught(context, &position)?;
    done()
}

fn p_element_get(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let part = number(context, 2)?;
    let at = element(part, "P")?;
    let value = read_taught(context)?.values[at];
    if value.is_finite() {
        answer(Value::Dnum(value))
    } else {
        let index = number(context, 1)?;
        Err(uninitialized(&format!("P[{index},{part}]")))
    }
}

fn p_element_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let at = element(number(context, 2)?, "P")?;
    let mut position = read_taught(context)?;
    position.values[at] = state::stored(number(context, 3)?);
    write_taught(context, &position)?;
    done()
}

/// The slot, then the number; 0 is the world or the flange.
fn frame_get(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let slot = number(context, 0)? as u32;
    let index = number(context, 1)?;
    if index == 0.0 {
        return answer(Position::cartesian([0.0; 6]).to_value());
    }
    let place = state::place(context.memory, slot, frame_name(slot), index)?;
    answer(state::items(context.memory, slot)[place].clone())
}

fn frame_name(slot: u32) -> &'static str {
    if slot == state::FRAMES {
        "UFRAME"
    } else {
        "UTOOL"
    }
}

fn frame_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let slot = number(context, 0)? as u32;
    let place = state::place(context.memory, slot, frame_name(slot), number(context, 1)?)?;
    let position = as_position(context.required(2)?)?;
    if position.is_joint {
        return Err(mismatch(format!(
            "{} is a frame and takes no joint position",
            frame_name(slot)
        )));
    }
    if let Some(items) = state::items_mut(context.memory, slot) {
        items[place] = position.to_value();
    }
    done()
}

/// The tool in the user frame, now.
pub(crate) fn here(memory: &depal_vm::Memory, system: &dyn System) -> Position {
    let base_from_frame = state::frame(
        memory,
        state::FRAMES,
        state::number(memory, state::UFRAME_NUM),
    );
    let flange_from_tcp = state::frame(
        memory,
        state::TOOLS,
        state::number(memory, state::UTOOL_NUM),
    );
    let base_from_tcp = system.forward(&system.joints()) * flange_from_tcp;
    Position::from_pose(&(base_from_frame.inverse() * base_from_tcp))
}

fn lpos(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    answer(here(context.memory, system).to_value())
}

fn jpos(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let shown = shown_from_arm(&system.joints(), state::is_coupled(context.memory));
    answer(Position::joint(shown).to_value())
}
