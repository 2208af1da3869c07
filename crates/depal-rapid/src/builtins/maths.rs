use depal_vm::system::System;
use depal_vm::{CallContext, MachineFault, Outcome, RaisedError, Value};

use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 24] = [
    ("FUNC num Abs(num Value)", abs),
    ("FUNC dnum AbsDnum(dnum Value)", abs),
    ("FUNC num Round(num Val \\num Dec)", round),
    ("FUNC num Trunc(num Val \\num Dec)", trunc),
    ("FUNC num Sqrt(num Value)", sqrt),
    ("FUNC num Pow(num Base, num Exponent)", pow),
    ("FUNC num Exp(num Exponent)", exp),
    ("FUNC num Sin(num Angle)", sin),
    ("FUNC num Cos(num Angle)", cos),
    ("FUNC num Tan(num Angle)", tan),
    ("FUNC num ASin(num Value)", asin),
    ("FUNC num ACos(num Value)", acos),
    ("FUNC num ATan(num Value)", atan),
    ("FUNC num ATan2(num Y, num X)", atan2),
    ("FUNC dnum NumToDnum(num Value)", to_dnum),
    ("FUNC num DnumToNum(dnum Value \\switch Integer)", to_num),
    ("FUNC dnum RoundDnum(dnum Val \\num Dec)", round),
    ("FUNC dnum TruncDnum(dnum Val \\num Dec)", trunc),
    ("PROC Incr(INOUT numeric Name)", incr),
    ("PROC Decr(INOUT numeric Name)", decr),
    ("PROC Add(INOUT numeric Name, numeric AddValue)", add),
    ("PROC Clear(INOUT numeric Name)", clear),
    ("FUNC num Dim(anytype ArrPar, num DimNo)", dim),
    ("FUNC num BitAnd(num BitData1, num BitData2)", bit_and),
];

/// The result, as wide as the first argument.
fn number(context: &CallContext<'_>, value: f64) -> Ran {
    Ok(Outcome::Done(match context.required(0)? {
        Value::Dnum(_) => Value::Dnum(value),
        _ => Value::Num(value as f32),
    }))
}

fn one(context: &mut CallContext<'_>, f: impl Fn(f64) -> f64) -> Ran {
    let value = f(context.number(0)?);
    number(context, value)
}

fn abs(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    one(context, f64::abs)
}

fn scaled(context: &mut CallContext<'_>, f: impl Fn(f64) -> f64) -> Ran {
    let scale = 10f64.powi(context.number(1)?.clamp(0.0, 12.0) as i32);
    let value = context.number(0)?;
    // The shortest decimal of the number is what the user sees: 0.15 is rounded as 0.15.
    let shown = match context.required(0)? {
        Value::Num(v) => v.to_string().parse().unwrap_or(value),
        _ => value,
    };
    number(context, f(shown * scale) / scale)
}

fn round(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    scaled(context, f64::round)
}

fn trunc(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    scaled(context, f64::trunc)
}

fn sqrt(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let value = context.number(0)?;
    if value < 0.0 {
        return Err(error("ERR_NEGARG", format!("the square root of {value}")));
    }
    number(context, value.sqrt())
}

fn pow(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (base, exponent) = (context.number(0)?, context.number(1)?);
    let value = base.powf(exponent);
    if !value.is_finite() {
        return Err(
            context.argument_error(format!("{base} to the power of {exponent} is no number"))
        );
    }
    number(context, value)
}

fn exp(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    one(context, f64::exp)
}

fn sin(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    one(context, |v| v.to_radians().sin())
}

fn cos(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    one(context, |v| v.to_radians().cos())
}

fn tan(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    one(context, |v| v.to_radians().tan())
}

fn arc(context: &mut CallContext<'_>, f: impl Fn(f64) -> f64) -> Ran {
    let value = context.number(0)?;
    if !(-1.0..=1.0).contains(&value) {
        return Err(context.argument_error(format!("{value} is outside -1..1")));
    }
    number(context, f(value).to_degrees())
}

fn asin(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    arc(context, f64::asin)
}

fn acos(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    arc(context, f64::acos)
}

fn atan(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    one(context, |v| v.atan().to_degrees())
}

fn atan2(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let value = context.number(0)?.atan2(context.number(1)?);
    number(context, value.to_degrees())
}

fn to_dnum(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Done(Value::Dnum(context.number(0)?)))
}

fn to_num(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let value = context.number(0)?;
    if context.is_given(1) && f64::from(value as f32) != value.trunc() {
        return Err(
            context.argument_error(format!("{value} is no whole number that a num can hold"))
        );
    }
    Ok(Outcome::Done(Value::Num(value as f32)))
}

fn change(context: &mut CallContext<'_>, f: impl Fn(f64) -> f64) -> Ran {
    let value = f(context.number(0)?);
    context.assign_number(0, value)?;
    Ok(Outcome::Done(Value::Absent))
}

fn incr(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    change(context, |v| v + 1.0)
}

fn decr(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    change(context, |v| v - 1.0)
}

fn add(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let more = context.number(1)?;
    change(context, |v| v + more)
}

fn clear(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    change(context, |_| 0.0)
}

fn dim(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let wanted = context.number(1)?;
    let mut value = context.required(0)?;
    let mut dimension = 1.0;
    loop {
        match value {
            Value::Array(items) if dimension == wanted => {
                return Ok(Outcome::Done(Value::Num(items.len() as f32)));
            }
            Value::Array(items) if !items.is_empty() => value = &items[0],
            _ => {
                return Err(error(
                    "ERR_ILLDIM",
                    format!("the array has no dimension {wanted}"),
                ));
            }
        }
        dimension += 1.0;
    }
}

fn bit_and(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (a, b) = (context.number(0)?, context.number(1)?);
    let fits = |v: f64| v.fract() == 0.0 && (0.0..=255.0).contains(&v);
    if !fits(a) || !fits(b) {
        return Err(context.raise(&MachineFault::Argument {
            message: format!("BitAnd takes whole numbers from 0 to 255, found {a} and {b}"),
        }));
    }
    Ok(Outcome::Done(Value::Num(f32::from(a as u8 & b as u8))))
}
