//! Analogue signals, group signals as dnum, signals under another name, and bits of numbers.

use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 19] = [
    (
        "PROC WaitAI(signalai Signal \\switch LT | switch GT, num Value \\num MaxTime \\INOUT num ValueAtTimeout)",
        wait_analog,
    ),
    (
        "PROC WaitAO(signalao Signal \\switch LT | switch GT, num Value \\num MaxTime \\INOUT num ValueAtTimeout)",
        wait_analog,
    ),
    ("FUNC num AOutput(signalao Signal)", read),
    ("FUNC dnum GInputDnum(signalgi Signal)", read_dnum),
    ("FUNC dnum GOutputDnum(signalgo Signal)", read_dnum),
    (
        "PROC AliasIO(anytype FromSignal, INOUT anytype ToSignal)",
        alias,
    ),
    ("PROC AliasIOReset(INOUT anytype Signal)", reset_alias),
    ("FUNC bool TestAndSet(INOUT bool Object)", test_and_set),
    ("PROC WaitTestAndSet(INOUT bool Object)", wait_test_and_set),
    ("FUNC num BitOr(num BitData1, num BitData2)", bit_or),
    ("FUNC num BitXOr(num BitData1, num BitData2)", bit_xor),
    ("FUNC num BitNeg(num BitData)", bit_neg),
    ("FUNC num BitLSh(num BitData, num ShiftSteps)", bit_left),
    ("FUNC num BitRSh(num BitData, num ShiftSteps)", bit_right),
    ("FUNC bool BitCheck(num BitData, num BitPos)", bit_check),
    ("PROC BitSet(INOUT num BitData, num BitPos)", bit_set),
    ("PROC BitClear(INOUT num BitData, num BitPos)", bit_clear),
    (
        "FUNC bool StrOrder(string Str1, string Str2, string Order)",
        str_order,
    ),
    (
        "FUNC robtarget ORobT(robtarget OrgPoint \\switch InPDisp | switch InEOffs)",
        same_target,
    ),
];

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}

fn value_of(
    context: &CallContext<'_>,
    system: &dyn System,
    index: usize,
) -> Result<f64, RaisedError> {
    let signal = context.signal(index)?;
    system
        .signal(&signal)
        .map_err(|fault| context.system_fault(fault))
}

/// Without a switch the value must be reached from either side: equal, or passed since the call.
fn wait_analog(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let found = value_of(context, system, 0)?;
    let wanted = context.number(3)?;
    let reached = if context.is_given(1) {
        found < wanted
    } else if context.is_given(2) {
        found > wanted
    } else {
        let before = match context.notes.first() {
            Some(Value::Dnum(before)) => *before,
            _ => found,
        };
        if context.notes.is_empty() {
            context.notes.push(Value::Dnum(found));
        }
        found == wanted || (before < wanted) != (found < wanted)
    };
    if reached {
        return done();
    }
    match context.optional_number(4)? {
        Some(limit) if context.elapsed(system.now()).as_secs_f64() >= limit => {
            if context.is_given(5) {
                context.assign_number(5, found)?;
            }
            Err(error(
                "ERR_WAIT_MAXTIME",
                format!("the signal did not get to {wanted} within {limit} s; it is {found}"),
            ))
        }
        _ => Ok(Outcome::Blocked),
    }
}

fn read(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let value = value_of(context, system, 0)?;
    Ok(Outcome::Done(Value::Num(value as f32)))
}

fn read_dnum(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let value = value_of(context, system, 0)?;
    Ok(Outcome::Done(Value::Dnum(value)))
}

/// The signal is named, or given itself.
fn alias(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let name = match context.required(0)? {
        Value::Signal(name) => name.to_string(),
        Value::Str(name) => name.clone(),
        other => {
            let kind = other.kind_name();
            return Err(error(
                "ERR_ALIASIO_TYPE",
                format!("AliasIO takes a signal or its name, found {kind}"),
            ));
        }
    };
    // A variable of a signal type holds nothing before it is connected.
    if let Ok(Some(held)) = context.value(1)
        && !matches!(held, Value::Signal(_))
    {
        return Err(error(
            "ERR_ALIASIO_TYPE",
            "the second argument of AliasIO is no variable of a signal type",
        ));
    }
    if system.signal(&name).is_err() {
        return Err(error(
            "ERR_ALIASIO_DEF",
            format!("there is no signal {name}"),
        ));
    }
    context.assign(1, Value::Signal(name.into()))?;
    done()
}

fn reset_alias(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    context.assign(0, Value::Absent)?;
    done()
}

/// Whether it was free; it is taken afterwards in any case.
fn take(context: &mut CallContext<'_>) -> Result<bool, RaisedError> {
    let free = context.required(0)? == &Value::Bool(false);
    context.assign(0, Value::Bool(true))?;
    Ok(free)
}

fn test_and_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let free = take(context)?;
    Ok(Outcome::Done(Value::Bool(free)))
}

fn wait_test_and_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    if take(context)? {
        done()
    } else {
        Ok(Outcome::Blocked)
    }
}

fn byte(context: &CallContext<'_>, index: usize) -> Result<u8, RaisedError> {
    let number = context.number(index)?;
    if (0.0..=255.0).contains(&number) && number.fract() == 0.0 {
        return Ok(number as u8);
    }
    Err(context.argument_error(format!(
        "expected a whole number from 0 to 255, found {number}"
    )))
}

/// A place of a bit from 1 to 8, as a mask.
fn mask(context: &CallContext<'_>, index: usize) -> Result<u8, RaisedError> {
    let place = context.number(index)?;
    if (1.0..=8.0).contains(&place) && place.fract() == 0.0 {
        return Ok(1 << (place as u8 - 1));
    }
    Err(context.argument_error(format!("a bit has a place from 1 to 8, found {place}")))
}

fn num(byte: u8) -> Ran {
    Ok(Outcome::Done(Value::Num(f32::from(byte))))
}

fn bit_or(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    num(byte(context, 0)? | byte(context, 1)?)
}

fn bit_xor(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    num(byte(context, 0)? ^ byte(context, 1)?)
}

fn bit_neg(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    num(!byte(context, 0)?)
}

fn shift(context: &CallContext<'_>) -> Result<(u32, u32), RaisedError> {
    let steps = u32::from(byte(context, 1)?);
    if steps > 8 {
        return Err(context.argument_error(format!("a shift of {steps} bits, expected 0 to 8")));
    }
    Ok((u32::from(byte(context, 0)?), steps))
}

fn bit_left(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (value, steps) = shift(context)?;
    num((value << steps) as u8)
}

fn bit_right(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (value, steps) = shift(context)?;
    num((value >> steps) as u8)
}

fn bit_check(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let set = byte(context, 0)? & mask(context, 1)? != 0;
    Ok(Outcome::Done(Value::Bool(set)))
}

fn bit_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let value = byte(context, 0)? | mask(context, 1)?;
    context.assign(0, Value::Num(f32::from(value)))?;
    done()
}

fn bit_clear(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let value = byte(context, 0)? & !mask(context, 1)?;
    context.assign(0, Value::Num(f32::from(value)))?;
    done()
}

/// Whether the first string comes before the second or is equal, by the places of their characters in `Order`;
/// a character that is not there comes behind those that are, by its code.
fn str_order(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let order = context.string(2)?;
    let keys = |text: String| -> Vec<(usize, char)> {
        text.chars()
            .map(|c| (order.chars().position(|o| o == c).unwrap_or(usize::MAX), c))
            .collect()
    };
    let (a, b) = (keys(context.string(0)?), keys(context.string(1)?));
    Ok(Outcome::Done(Value::Bool(a <= b)))
}

/// Program displacements and offsets of external axes are refused elsewhere, so none is there to take off.
fn same_target(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let target = context.required(0)?.clone();
    Ok(Outcome::Done(target))
}
