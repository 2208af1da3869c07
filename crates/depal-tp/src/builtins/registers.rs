//! Numeric and string registers, arguments, flags and system variables.

use depal_vm::system::System;
use depal_vm::{CallContext, RaisedError, Value};

use super::{Entry, Ran, answer, done, number};
use crate::errors::{interpreter, mismatch, uninitialized};
use crate::state;

pub(super) const ENTRIES: [Entry; 11] = [
    ("r get", r_get),
    ("r set", r_set),
    ("sr get", sr_get),
    ("sr set", sr_set),
    ("ar get", ar_get),
    ("bit get", bit_get),
    ("bit set", bit_set),
    ("number get", number_get),
    ("number set", number_set),
    ("system get", system_get),
    ("system set", system_set),
];

fn r_get(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let index = number(context, 0)?;
    answer(Value::Dnum(state::register(context.memory, index)?))
}

/// A number as a register takes it: truth values are 1 and 0, a text begins with its number.
fn as_number(value: &Value) -> Result<f64, RaisedError> {
    match value {
        Value::Bool(on) => Ok(f64::from(u8::from(*on))),
        Value::Str(text) => {
            let text = text.trim();
            let is_part = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+');
            let length = text.find(|c| !is_part(c)).unwrap_or(text.len());
            Ok(text[..length].parse().unwrap_or(0.0))
        }
        value => value
            .as_number()
            .ok_or_else(|| mismatch(format!("a numeric register does not take {}", kind(value)))),
    }
}

/// A few words for messages.
pub(super) fn kind(value: &Value) -> &'static str {
    match value {
        Value::Record(_) => "a position",
        Value::Dnum(_) | Value::Num(_) | Value::Int(_) => "a number",
        Value::Bool(_) => "ON or OFF",
        value => value.kind_name(),
    }
}

fn r_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let index = number(context, 0)?;
    let value = as_number(context.required(1)?)?;
    if !value.is_finite() {
        return Err(interpreter(format!(
            "Overflow: R[{index}] cannot hold {value}"
        )));
    }
    state::set_register(context.memory, index, value)?;
    done()
}

fn sr_get(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let place = state::place(context.memory, state::SR, "SR", number(context, 0)?)?;
    answer(state::items(context.memory, state::SR)[place].clone())
}

/// Most characters of a string register.
const STRING_LIMIT: usize = 254;

fn sr_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let index = number(context, 0)?;
    let place = state::place(context.memory, state::SR, "SR", index)?;
    let text = match context.required(1)? {
        Value::Str(text) => text.clone(),
        Value::Dnum(value) if value.fract() == 0.0 => format!("{value}"),
        Value::Dnum(value) => format!("{value:.6}"),
        other => {
            return Err(mismatch(format!(
                "a string register does not take {}",
                kind(other)
            )));
        }
    };
    let length = text.chars().count();
    if length > STRING_LIMIT {
        return Err(interpreter(format!(
            "String too long: SR[{index}] would have {length} characters, at most {STRING_LIMIT} fit"
        )));
    }
    if let Some(items) = state::items_mut(context.memory, state::SR) {
        items[place] = Value::Str(text);
    }
    done()
}

/// Arguments of a program that a listing's program may have.
pub(crate) const ARGUMENTS: usize = 10;

fn ar_get(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let index = number(context, 0)?;
    if index.fract() != 0.0 || !(1.0..=ARGUMENTS as f64).contains(&index) {
        return Err(interpreter(format!(
            "Invalid index: there is no AR[{index}]; AR[1] to AR[{ARGUMENTS}] are there"
        )));
    }
    let frame = context.memory.frames.last();
    match frame.and_then(|f| f.locals.get(index as usize - 1)) {
        Some(value) if value.is_present() => answer(value.clone()),
        _ => Err(uninitialized(&format!(
            "AR[{index}] (the caller gave no such argument)"
        ))),
    }
}

/// Flags and markers: the slot, then the number.
fn bit_get(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let slot = number(context, 0)? as u32;
    let name = if slot == state::FLAG { "F" } else { "M" };
    let place = state::place(context.memory, slot, name, number(context, 1)?)?;
    answer(state::items(context.memory, slot)[place].clone())
}

fn bit_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let slot = number(context, 0)? as u32;
    let name = if slot == state::FLAG { "F" } else { "M" };
    let place = state::place(context.memory, slot, name, number(context, 1)?)?;
    let on = super::signals::switch(context.required(2)?, name)?;
    if let Some(items) = state::items_mut(context.memory, slot) {
        items[place] = Value::Bool(on);
    }
    done()
}

fn number_get(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let which = number(context, 0)? as usize;
    answer(Value::Dnum(state::number(context.memory, which)))
}

fn number_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let which = number(context, 0)? as usize;
    let value = number(context, 1)?;
    let (name, least, most) = match which {
        state::UFRAME_NUM => ("UFRAME_NUM", 0, state::FRAME_COUNT),
        state::UTOOL_NUM => ("UTOOL_NUM", 0, state::TOOL_COUNT),
        state::OVERRIDE => ("OVERRIDE", 1, 100),
        _ => ("PAYLOAD", 1, 10),
    };
    if value.fract() != 0.0 || value < f64::from(least) || value > f64::from(most) {
        return Err(interpreter(format!(
            "Invalid value: {name} cannot be {value}; {least} to {most} are possible"
        )));
    }
    if let Some(items) = state::items_mut(context.memory, state::NUMBERS) {
        items[which] = Value::Dnum(value);
    }
    done()
}

/// System variables that are something else by another name.
fn linked(name: &str) -> Option<usize> {
    match name {
        "$MCR.$GENOVERRIDE" => Some(state::OVERRIDE),
        "$MNUFRAMENUM[1]" => Some(state::UFRAME_NUM),
        "$MNUTOOLNUM[1]" => Some(state::UTOOL_NUM),
        _ => None,
    }
}

/// The value of a system variable, if it has one.
pub(crate) fn system_variable(memory: &depal_vm::Memory, name: &str) -> Option<Value> {
    if let Some(which) = linked(name) {
        return Some(Value::Dnum(state::number(memory, which)));
    }
    state::items(memory, state::SYSTEM)
        .iter()
        .find_map(|pair| match pair {
            Value::Array(pair) if pair.first() == Some(&Value::Str(name.to_owned())) => {
                pair.get(1).cloned()
            }
            _ => None,
        })
}

fn system_get(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let name = context.string(0)?;
    match system_variable(context.memory, &name) {
        Some(value) => answer(value),
        None => Err(interpreter(format!(
            "Undefined system variable: {name} is not simulated and the program has not set it"
        ))),
    }
}

fn system_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let name = context.string(0)?;
    let value = context.required(1)?.clone();
    if let Some(which) = linked(&name) {
        let value = as_number(&value)?;
        if let Some(items) = state::items_mut(context.memory, state::NUMBERS) {
            items[which] = Value::Dnum(value);
        }
        return done();
    }
    if let Some(items) = state::items_mut(context.memory, state::SYSTEM) {
        let key = Value::Str(name);
        items.retain(|pair| !matches!(pair, Value::Array(pair) if pair.first() == Some(&key)));
        items.push(Value::Array(vec![key, value]));
    }
    done()
}
