use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::table::{Entry, Ran};

/// Angles in degrees.
pub(super) const ENTRIES: [Entry; 9] = [
    ("REAL ABS(REAL X)", |context, _| one(context, f64::abs)),
    ("REAL SQRT(REAL X)", sqrt),
    ("REAL SIN(REAL Degrees)", |context, _| {
        one(context, |x| x.to_radians().sin())
    }),
    ("REAL COS(REAL Degrees)", |context, _| {
        one(context, |x| x.to_radians().cos())
    }),
    ("REAL TAN(REAL Degrees)", |context, _| {
        one(context, |x| x.to_radians().tan())
    }),
    ("REAL ASIN(REAL X)", |context, _| arc(context, f64::asin)),
    ("REAL ACOS(REAL X)", |context, _| arc(context, f64::acos)),
    ("REAL ATAN2(REAL Y, REAL X)", atan2),
    ("REAL EXP(REAL X)", |context, _| one(context, f64::exp)),
];

fn answer(value: f64) -> Ran {
    Ok(Outcome::Done(Value::Num(value as f32)))
}

fn one(context: &CallContext<'_>, compute: fn(f64) -> f64) -> Ran {
    answer(compute(context.number(0)?))
}

fn outside(context: &CallContext<'_>, value: f64, range: &str) -> RaisedError {
    context.argument_error(format!("the argument is {value}, expected {range}"))
}

fn arc(context: &CallContext<'_>, compute: fn(f64) -> f64) -> Ran {
    let value = context.number(0)?;
    if !(-1.0..=1.0).contains(&value) {
        return Err(outside(context, value, "-1 to 1"));
    }
    answer(compute(value).to_degrees())
}

fn sqrt(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let value = context.number(0)?;
    if value < 0.0 {
        return Err(outside(context, value, "0 or more"));
    }
    answer(value.sqrt())
}

fn atan2(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (y, x) = (context.number(0)?, context.number(1)?);
    answer(y.atan2(x).to_degrees())
}
