//! Inputs and outputs of the cabinet.

use depal_time::SimDuration;
use depal_vm::system::{Fault, System};
use depal_vm::{CallContext, Memory, RaisedError, Value};

use super::registers::kind;
use super::{Entry, Ran, answer, done, number};
use crate::errors::{interpreter, mismatch};
use crate::state;

pub(super) const ENTRIES: [Entry; 3] = [
    ("signal get", signal_get),
    ("signal set", signal_set),
    ("signal pulse", signal_pulse),
];

fn is_number(word: &str) -> bool {
    matches!(word, "GI" | "GO" | "AI" | "AO")
}

fn index(context: &CallContext<'_>, word: &str) -> Result<u32, RaisedError> {
    let index = number(context, 1)?;
    if index.fract() != 0.0 || !(1.0..=32_767.0).contains(&index) {
        return Err(interpreter(format!(
            "Invalid index: there is no {word}[{index}]"
        )));
    }
    Ok(index as u32)
}

fn fault(context: &CallContext<'_>, fault: Fault) -> RaisedError {
    context.system_fault(fault)
}

fn signal_get(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let word = context.string(0)?;
    let index = index(context, &word)?;
    if word == "DO"
        && let Some((signal, bit)) = state::group_of(context.memory, index)
    {
        let value = system.signal(&signal).map_err(|f| fault(context, f))?;
        return answer(Value::Bool((value as u64 >> bit) & 1 == 1));
    }
    let value = system
        .signal(&format!("{word}[{index}]"))
        .map_err(|f| fault(context, f))?;
    answer(if is_number(&word) {
        Value::Dnum(value)
    } else {
        Value::Bool(value != 0.0)
    })
}

/// ON or OFF; a number other than 0 is ON.
pub(super) fn switch(value: &Value, word: &str) -> Result<bool, RaisedError> {
    match value {
        Value::Bool(on) => Ok(*on),
        value => match value.as_number() {
            Some(number) => Ok(number != 0.0),
            None => Err(mismatch(format!(
                "{word}[...] does not take {}",
                kind(value)
            ))),
        },
    }
}

/// Switches a digital output, or its bit of a group.
pub(crate) fn set_output(
    memory: &Memory,
    system: &mut dyn System,
    output: u32,
    on: bool,
) -> Result<(), Fault> {
    match state::group_of(memory, output) {
        Some((signal, bit)) => {
            let before = system.signal(&signal)? as u64;
            let after = if on {
                before | 1 << bit
            } else {
                before & !(1 << bit)
            };
            system.set_signal(&signal, after as f64)
        }
        None => system.set_signal(&format!("DO[{output}]"), f64::from(u8::from(on))),
    }
}

fn signal_set(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let word = context.string(0)?;
    let index = index(context, &word)?;
    let value = context.required(2)?.clone();
    let result = if is_number(&word) {
        let number = value
            .as_number()
            .ok_or_else(|| mismatch(format!("{word}[{index}] does not take {}", kind(&value))))?;
        // A group holds whole numbers.
        let number = if word == "GO" { number.round() } else { number };
        system.set_signal(&format!("{word}[{index}]"), number)
    } else {
        let on = switch(&value, &word)?;
        match word.as_str() {
            "DO" => set_output(context.memory, system, index, on),
            _ => system.set_signal(&format!("{word}[{index}]"), f64::from(u8::from(on))),
        }
    };
    result.map_err(|f| fault(context, f))?;
    done()
}

/// ON now, OFF after a time; the program goes on.
fn signal_pulse(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let word = context.string(0)?;
    let index = index(context, &word)?;
    let width = if context.is_given(2) {
        number(context, 2)?
    } else {
        0.1
    };
    if !(0.0..=25.5).contains(&width) {
        return Err(interpreter(format!(
            "Invalid value: a pulse of {width} s; 0 to 25.5 s are possible"
        )));
    }
    if word == "DO" && state::group_of(context.memory, index).is_some() {
        return Err(interpreter(format!(
            "a pulse on DO[{index}], a bit of a group, is not simulated"
        )));
    }
    let name = format!("{word}[{index}]");
    system
        .set_signal(&name, 1.0)
        .map_err(|f| fault(context, f))?;
    system
        .set_signal_later(&name, 0.0, SimDuration::from_secs_f64(width))
        .map_err(|f| fault(context, f))?;
    done()
}
