//! Messages, alarms, stops, and what is refused.

use depal_vm::system::{LogKind, System};
use depal_vm::{CallContext, Outcome, Value};

use super::registers::system_variable;
use super::{Entry, Ran, done, number};
use crate::errors::{error, interpreter};
use crate::state;

pub(super) const ENTRIES: [Entry; 9] = [
    ("message", message),
    ("alarm", alarm),
    ("pause", pause),
    ("abort", abort),
    ("refuse", refuse),
    ("missing label", missing_label),
    ("missing program", missing_program),
    ("condition set", condition_set),
    ("run", run),
];

fn message(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let text = context.string(0)?;
    system.log(LogKind::Operator, context.location, &text);
    done()
}

/// A user alarm stops the program, with the text of `$UALRM_MSG` if there is one.
fn alarm(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let index = number(context, 0)?;
    let text = match system_variable(context.memory, &format!("$UALRM_MSG[{index}]")) {
        Some(Value::Str(text)) => format!(": {text}"),
        _ => String::new(),
    };
    Err(error("INTP", format!("User alarm UALM[{index}]{text}")))
}

fn pause(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Stop("PAUSE".into()))
}

fn abort(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    system.stop_motion();
    Ok(Outcome::Stop("ABORT".into()))
}

fn refuse(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Err(interpreter(format!(
        "Unimplemented TP instruction: {}",
        context.string(0)?
    )))
}

fn missing_label(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let index = number(context, 0)?;
    Err(interpreter(format!(
        "Label not found: there is no LBL[{index}] in this program"
    )))
}

fn missing_program(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Err(error(
        "MEMO",
        format!("Program does not exist: {}", context.string(0)?),
    ))
}

/// Asks for a program to be run beside this one: its routine, then the arguments.
fn run(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let start = Value::Array(context.arguments.clone());
    if let Some(items) = state::items_mut(context.memory, state::STARTS) {
        items.push(start);
    }
    done()
}

/// Keeps a value of OFFSET CONDITION, TOOL_OFFSET CONDITION or SKIP CONDITION.
fn condition_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let which = number(context, 0)? as usize;
    let value = context.required(1)?.clone();
    if let Some(items) = state::items_mut(context.memory, state::CONDITIONS) {
        items[which] = value;
    }
    done()
}
