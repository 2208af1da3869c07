//! Inputs and outputs. The cabinet knows them by their names, `$IN[5]`.

use depal_time::SimDuration;
use depal_vm::system::System;
use depal_vm::{CallContext, MachineFault, Outcome, RaisedError, Value};

use super::path::output_here;
use super::table::{Entry, Operator, Ran};

pub(super) const ENTRIES: [Entry; 1] = [("!PULSE(SIGNAL Output, BOOL Level, REAL Seconds)", pulse)];

pub(super) const OPERATORS: [Operator; 10] = [
    ("read in", |context, system| digital(context, system, "$IN")),
    ("read out", |context, system| {
        digital(context, system, "$OUT")
    }),
    ("read anin", |context, system| {
        analogue(context, system, "$ANIN")
    }),
    ("read anout", |context, system| {
        analogue(context, system, "$ANOUT")
    }),
    ("read in group", |context, system| {
        group(context, system, "$IN")
    }),
    ("read out group", |context, system| {
        group(context, system, "$OUT")
    }),
    ("write out", write_out),
    ("write out group", write_group),
    ("write anout", write_analogue),
    ("write out on time", output_here),
];

/// The greatest number of an input or output.
const HIGHEST: usize = 8192;

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}

fn number(context: &CallContext<'_>, argument: usize) -> Result<i64, RaisedError> {
    let number = context.number(argument)?;
    if (1.0..=HIGHEST as f64).contains(&number) {
        return Ok(number as i64);
    }
    Err(context.raise(&MachineFault::IndexOutOfRange {
        index: number,
        size: HIGHEST,
        dimension: 1,
    }))
}

fn read(
    context: &CallContext<'_>,
    system: &dyn System,
    array: &str,
    number: i64,
) -> Result<f64, RaisedError> {
    let found = system.signal(&format!("{array}[{number}]"));
    match (found, array, number) {
        (Ok(value), ..) => Ok(value),
        // Two inputs of the system itself: one always TRUE, one always FALSE.
        (Err(_), "$IN", 1025) => Ok(1.0),
        (Err(_), "$IN", 1026) => Ok(0.0),
        (Err(fault), ..) => Err(context.system_fault(fault)),
    }
}

fn write(
    context: &CallContext<'_>,
    system: &mut dyn System,
    array: &str,
    number: i64,
    value: f64,
) -> Result<(), RaisedError> {
    let name = format!("{array}[{number}]");
    let written = system.set_signal(&name, value);
    written.map_err(|fault| context.system_fault(fault))
}

fn truth(context: &CallContext<'_>, argument: usize) -> Result<f64, RaisedError> {
    let value = context.required(argument)?;
    Ok(f64::from(u8::from(*value == Value::Bool(true))))
}

fn digital(context: &CallContext<'_>, system: &dyn System, array: &str) -> Ran {
    let value = read(context, system, array, number(context, 0)?)?;
    Ok(Outcome::Done(Value::Bool(value != 0.0)))
}

fn analogue(context: &CallContext<'_>, system: &dyn System, array: &str) -> Ran {
    let value = read(context, system, array, number(context, 0)?)?;
    Ok(Outcome::Done(Value::Num(value as f32)))
}

/// The first signal is the lowest bit.
fn group(context: &CallContext<'_>, system: &dyn System, array: &str) -> Ran {
    let (from, to) = (number(context, 0)?, number(context, 1)?);
    let mut value = 0i64;
    for (bit, number) in (from..=to).enumerate() {
        if read(context, system, array, number)? != 0.0 {
            value |= 1 << bit;
        }
    }
    // 32 bits are an integer with its sign.
    let value = if to - from >= 31 {
        i64::from(value as i32)
    } else {
        value
    };
    Ok(Outcome::Done(Value::Int(value)))
}

pub(super) fn write_out(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let value = truth(context, 1)?;
    write(context, system, "$OUT", number(context, 0)?, value)?;
    done()
}

fn write_group(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let (from, to) = (number(context, 0)?, number(context, 1)?);
    let value = context.number(2)? as i64;
    let width = to - from + 1;
    let most = (1i64 << width) - 1;
    if width < 32 && !(0..=most).contains(&value) {
        return Err(context.argument_error(format!(
            "{value} does not fit into the {width} outputs $OUT[{from}] to $OUT[{to}]: 0 to {most}"
        )));
    }
    for (bit, number) in (from..=to).enumerate() {
        write(context, system, "$OUT", number, ((value >> bit) & 1) as f64)?;
    }
    done()
}

fn write_analogue(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let value = context.number(1)?;
    write(context, system, "$ANOUT", number(context, 0)?, value)?;
    done()
}

/// Shortest and longest pulse, s.
const PULSE: std::ops::RangeInclusive<f64> = 0.012..=31.0;

/// The output has the level for that time, then the other one. The program goes on at once.
fn pulse(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let number = number(context, 0)?;
    let level = truth(context, 1)?;
    let seconds = context.number(2)?;
    if !PULSE.contains(&seconds) {
        return Err(context.argument_error(format!(
            "a pulse lasts {} to {} s, found {seconds}",
            PULSE.start(),
            PULSE.end()
        )));
    }
    write(context, system, "$OUT", number, level)?;
    let name = format!("$OUT[{number}]");
    let length = SimDuration::from_secs_f64(seconds);
    let later = system.set_signal_later(&name, 1.0 - level, length);
    later.map_err(|fault| context.system_fault(fault))?;
    done()
}
