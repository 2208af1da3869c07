use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 17] = [
    (
        "PROC SetDO(\\switch Sync, signaldo Signal, num Value)",
        set_do,
    ),
    ("PROC SetGO(signalgo Signal, numeric Value)", set_value),
    ("PROC SetAO(signalao Signal, num Value)", set_value),
    (
        "PROC PulseDO(\\switch High \\num PLength, signaldo Signal)",
        pulse,
    ),
    ("PROC InvertDO(signaldo Signal)", invert),
    ("PROC Set(signaldo Signal)", set),
    ("PROC Reset(signaldo Signal)", reset),
    (
        "PROC WaitDI(signaldi Signal, num Value \\num MaxTime \\INOUT bool TimeFlag)",
        wait_digital,
    ),
    (
        "PROC WaitDO(signaldo Signal, num Value \\num MaxTime \\INOUT bool TimeFlag)",
        wait_digital,
    ),
    (
        "PROC WaitGI(signalgi Signal, numeric Value \\num MaxTime \\INOUT bool TimeFlag)",
        wait_digital,
    ),
    (
        "PROC WaitGO(signalgo Signal, numeric Value \\num MaxTime \\INOUT bool TimeFlag)",
        wait_digital,
    ),
    ("FUNC num DInput(signaldi Signal)", read),
    ("FUNC num DOutput(signaldo Signal)", read),
    ("FUNC num GInput(signalgi Signal)", read),
    ("FUNC num GOutput(signalgo Signal)", read),
    ("FUNC num AInput(signalai Signal)", read),
    ("FUNC num TestDI(signaldi Signal)", read),
];

fn write(context: &CallContext<'_>, system: &mut dyn System, index: usize, value: f64) -> Ran {
    let signal = context.signal(index)?;
    match system.set_signal(&signal, value) {
        Ok(()) => Ok(Outcome::Done(Value::Absent)),
        Err(fault) => Err(context.system_fault(fault)),
    }
}

/// Any value but 0 is 1.
fn set_do(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let value = f64::from(u8::from(context.number(2)? != 0.0));
    write(context, system, 1, value)
}

fn set_value(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let value = context.number(1)?;
    write(context, system, 0, value)
}

fn set(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    write(context, system, 0, 1.0)
}

fn reset(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    write(context, system, 0, 0.0)
}

/// Seconds of a pulse unless told otherwise, and the least and most that can be told.
const PULSE_LENGTH: f64 = 0.2;
const PULSE_LENGTHS: std::ops::RangeInclusive<f64> = 0.001..=2000.0;

/// Inverts the output for a time; with \\High it is 1 for that time, whatever it was. The program goes on at once.
fn pulse(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let length = context.optional_number(1)?.unwrap_or(PULSE_LENGTH);
    if !PULSE_LENGTHS.contains(&length) {
        return Err(
            context.argument_error(format!("\\PLength is {length} s, expected 0.001 to 2000"))
        );
    }
    let signal = context.signal(2)?;
    let before = match system.signal(&signal) {
        Ok(value) => value,
        Err(fault) => return Err(context.system_fault(fault)),
    };
    let (during, after) = if context.is_given(0) {
        (1.0, 0.0)
    } else {
        (1.0 - before, before)
    };
    let length = depal_time::SimDuration::from_secs_f64(length);
    let set = system.set_signal(&signal, during);
    match set.and_then(|()| system.set_signal_later(&signal, after, length)) {
        Ok(()) => Ok(Outcome::Done(Value::Absent)),
        Err(fault) => Err(context.system_fault(fault)),
    }
}

fn invert(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let signal = context.signal(0)?;
    match system.signal(&signal) {
        Ok(value) => write(context, system, 0, 1.0 - value),
        Err(fault) => Err(context.system_fault(fault)),
    }
}

fn read(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let signal = context.signal(0)?;
    match system.signal(&signal) {
        Ok(value) => Ok(Outcome::Done(Value::Num(value as f32))),
        Err(fault) => Err(context.system_fault(fault)),
    }
}

fn wait_digital(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let signal = context.signal(0)?;
    let wanted = context.number(1)?;
    let found = match system.signal(&signal) {
        Ok(value) => value,
        Err(fault) => return Err(context.system_fault(fault)),
    };
    let flag = context.is_given(3);
    if found == wanted {
        if flag {
            context.assign(3, Value::Bool(false))?;
        }
        return Ok(Outcome::Done(Value::Absent));
    }
    let Some(limit) = context.optional_number(2)? else {
        return Ok(Outcome::Blocked);
    };
    if context.elapsed(system.now()).as_secs_f64() < limit {
        return Ok(Outcome::Blocked);
    }
    if flag {
        context.assign(3, Value::Bool(true))?;
        return Ok(Outcome::Done(Value::Absent));
    }
    Err(error(
        "ERR_WAIT_MAXTIME",
        format!("signal {signal} did not become {wanted} within {limit} s; it is {found}"),
    ))
}
