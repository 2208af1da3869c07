//! Arithmetic, comparisons, logic and functions.

use depal_vm::system::System;
use depal_vm::{CallContext, RaisedError, Value};

use super::positions::as_position;
use super::registers::kind;
use super::{Entry, Ran, answer, number};
use crate::errors::{interpreter, mismatch};
use crate::position::Position;
use crate::state::stored;
use crate::syntax::tree::{Function, Operator};

pub(super) const ENTRIES: [Entry; 6] = [
    ("operate", operate),
    ("not", not),
    ("negate", negate),
    ("truth", truth),
    ("function", function),
    ("name is", name_is),
];

fn operate(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let which = number(context, 0)? as usize;
    let (operator, ..) = Operator::ALL[which];
    let left = context.required(1)?;
    let right = context.required(2)?;
    answer(combine(operator, left, right)?)
}

fn combine(operator: Operator, left: &Value, right: &Value) -> Result<Value, RaisedError> {
    let refuse = || {
        mismatch(format!(
            "{} does not go with {} and {}",
            operator.text(),
            kind(left),
            kind(right)
        ))
    };
    match (left, right) {
        (Value::Record(_), Value::Record(_)) => {
            let sign = match operator {
                Operator::Add => 1.0,
                Operator::Subtract => -1.0,
                _ => return Err(refuse()),
            };
            let (left, right) = (as_position(left)?, as_position(right)?);
            if left.is_joint != right.is_joint {
                return Err(mismatch(
                    "one position is Cartesian, the other holds joint angles",
                ));
            }
            let mut values = left.values;
            for (value, other) in values.iter_mut().zip(right.values) {
                *value = stored(*value + sign * other);
            }
            Ok(Position { values, ..left }.to_value())
        }
        (Value::Str(a), Value::Str(b)) => Ok(match operator {
            Operator::Add => Value::Str(format!("{a}{b}")),
            Operator::Equal => Value::Bool(a == b),
            Operator::NotEqual => Value::Bool(a != b),
            _ => return Err(refuse()),
        }),
        (Value::Bool(a), Value::Bool(b)) => Ok(Value::Bool(match operator {
            Operator::And => *a && *b,
            Operator::Or => *a || *b,
            Operator::Equal => a == b,
            Operator::NotEqual => a != b,
            _ => return Err(refuse()),
        })),
        (Value::Bool(a), b) | (b, Value::Bool(a)) => {
            let b = b.as_number().ok_or_else(refuse)? != 0.0;
            Ok(Value::Bool(match operator {
                Operator::Equal => *a == b,
                Operator::NotEqual => *a != b,
                _ => return Err(refuse()),
            }))
        }
        (a, b) => {
            let (Some(a), Some(b)) = (a.as_number(), b.as_number()) else {
                return Err(refuse());
            };
            numbers(operator, a, b).ok_or_else(refuse)?
        }
    }
}

/// `/` is real, DIV and MOD are those of whole numbers, towards zero.
fn numbers(operator: Operator, a: f64, b: f64) -> Option<Result<Value, RaisedError>> {
    let divides = matches!(operator, Operator::Divide | Operator::Div | Operator::Mod);
    let whole = |v: f64| v.trunc();
    let is_zero = match operator {
        Operator::Divide => b == 0.0,
        _ => whole(b) == 0.0,
    };
    if divides && is_zero {
        let text = format!("Divide by zero: {a} {} {b}", operator.text());
        return Some(Err(interpreter(text)));
    }
    let number = |value: f64| Value::Dnum(stored(value));
    Some(Ok(match operator {
        Operator::Add => number(a + b),
        Operator::Subtract => number(a - b),
        Operator::Multiply => number(a * b),
        Operator::Divide => number(a / b),
        Operator::Div => number((whole(a) / whole(b)).trunc()),
        Operator::Mod => number(whole(a) % whole(b)),
        Operator::Equal => Value::Bool(a == b),
        Operator::NotEqual => Value::Bool(a != b),
        Operator::Less => Value::Bool(a < b),
        Operator::LessOrEqual => Value::Bool(a <= b),
        Operator::Greater => Value::Bool(a > b),
        Operator::GreaterOrEqual => Value::Bool(a >= b),
        Operator::And | Operator::Or => return None,
    }))
}

fn not(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    match context.required(0)? {
        Value::Bool(value) => answer(Value::Bool(!value)),
        other => Err(mismatch(format!("! does not go with {}", kind(other)))),
    }
}

fn negate(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    match context.required(0)? {
        Value::Bool(_) => Err(mismatch("- does not go with ON or OFF")),
        value => match value.as_number() {
            Some(number) => answer(Value::Dnum(-number)),
            None => Err(mismatch(format!("- does not go with {}", kind(value)))),
        },
    }
}

fn truth(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    match context.required(0)? {
        Value::Bool(value) => answer(Value::Bool(*value)),
        other => Err(mismatch(format!("a condition cannot be {}", kind(other)))),
    }
}

fn function(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let which = number(context, 0)? as usize;
    let (name, function, _) = Function::TABLE[which];
    match function {
        Function::Strlen => {
            let text = context.string(1)?;
            return answer(Value::Dnum(text.chars().count() as f64));
        }
        Function::Findstr => {
            let (text, wanted) = (
                context.string(1)?.to_uppercase(),
                context.string(2)?.to_uppercase(),
            );
            let at = text
                .find(&wanted)
                .map_or(0, |at| text[..at].chars().count() + 1);
            return answer(Value::Dnum(at as f64));
        }
        Function::Substr => {
            let text = context.string(1)?;
            let (from, count) = (number(context, 2)?, number(context, 3)?);
            let length = text.chars().count();
            if from < 1.0
                || from > length as f64
                || count < 0.0
                || from - 1.0 + count > length as f64
            {
                return Err(interpreter(format!(
                    "Invalid argument: SUBSTR from {from}, {count} characters, of a text of {length}"
                )));
            }
            let part = text.chars().skip(from as usize - 1).take(count as usize);
            return answer(Value::Str(part.collect()));
        }
        _ => {}
    }
    let a = number(context, 1)?;
    let value = match function {
        Function::Sqrt => a.sqrt(),
        Function::Sin => a.to_radians().sin(),
        Function::Cos => a.to_radians().cos(),
        Function::Tan => a.to_radians().tan(),
        Function::Asin => a.asin().to_degrees(),
        Function::Acos => a.acos().to_degrees(),
        Function::Atan => a.atan().to_degrees(),
        Function::Atan2 => a.atan2(number(context, 2)?).to_degrees(),
        Function::Abs => a.abs(),
        Function::Exp => a.exp(),
        Function::Ln => a.ln(),
        Function::Round => a.round(),
        _ => a.trunc(),
    };
    if !value.is_finite() {
        return Err(interpreter(format!("Invalid argument: {name} of {a}")));
    }
    answer(Value::Dnum(stored(value)))
}

/// Whether a string register holds the name of a program.
fn name_is(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (held, name) = (context.string(0)?, context.string(1)?);
    answer(Value::Bool(held.trim().eq_ignore_ascii_case(&name)))
}
