//! CAST_TO and CAST_FROM: values in a buffer of bytes, the lowest byte first.
//!
//! INT and REAL take 4 bytes, BOOL and CHAR 1; structures and arrays their parts in a row.

use depal_vm::system::System;
use depal_vm::{CallContext, MachineFault, Outcome, RaisedError, Reference, Value};

use super::strings::codes;
use super::table::{Entry, Ran};

pub(super) const ENTRIES: [Entry; 2] = [
    ("CAST_TO(CHAR[] Buffer:OUT, INT Offset:OUT, ...)", cast_to),
    (
        "CAST_FROM(CHAR[] Buffer:OUT, INT Offset:OUT, ...:OUT)",
        cast_from,
    ),
];

/// A value of an argument of any type with the name of its type.
pub(super) fn any_value(
    context: &CallContext<'_>,
    argument: usize,
) -> Result<(String, Value), RaisedError> {
    match context.required(argument)? {
        Value::Record(parts) => match parts.as_slice() {
            [Value::Str(kind), value] => Ok((kind.clone(), value.clone())),
            _ => Err(context.argument_error("a value is needed")),
        },
        _ => Err(context.argument_error("a value is needed")),
    }
}

/// A variable of any type with the name of its type.
pub(super) fn any_variable(
    context: &CallContext<'_>,
    argument: usize,
) -> Result<(String, Reference), RaisedError> {
    match any_value(context, argument)? {
        (kind, Value::Reference(reference)) => Ok((kind, reference)),
        _ => Err(context.argument_error("a variable is needed")),
    }
}

/// The type of the simple values in a variable of this type.
fn leaf(kind: &str, place: usize) -> &str {
    let base = kind.split('[').next().unwrap_or(kind);
    match base.to_ascii_uppercase().as_str() {
        "INT" | "REAL" | "BOOL" | "CHAR" => base,
        // Status and turn are integers, all else in a position is REAL.
        "POS" | "E6POS" if place == 6 || place == 7 => "INT",
        "FRAME" | "POS" | "E6POS" | "AXIS" | "E6AXIS" => "REAL",
        _ => "",
    }
}

fn append(
    context: &CallContext<'_>,
    kind: &str,
    value: &Value,
    place: usize,
    bytes: &mut Vec<u8>,
) -> Result<(), RaisedError> {
    let leaf = leaf(kind, place);
    match value {
        Value::Array(items) => {
            for item in items {
                append(context, kind, item, 0, bytes)?;
            }
        }
        Value::Record(parts) => {
            for (i, part) in parts.iter().enumerate() {
                append(context, kind, part, i, bytes)?;
            }
        }
        Value::Int(value) if leaf.eq_ignore_ascii_case("char") => bytes.push(*value as u8),
        Value::Int(value) => bytes.extend((*value as i32).to_le_bytes()),
        Value::Num(value) => bytes.extend(value.to_le_bytes()),
        Value::Bool(value) => bytes.push(u8::from(*value)),
        // The rest of a string.
        Value::Unset if leaf.eq_ignore_ascii_case("char") => bytes.push(0),
        Value::Unset => {
            return Err(context.raise(&MachineFault::NotInitialized {
                name: "an argument of CAST_TO".into(),
            }));
        }
        other => {
            return Err(context.argument_error(format!("{} has no bytes", other.kind_name())));
        }
    }
    Ok(())
}

fn buffer(context: &CallContext<'_>) -> Result<Vec<Value>, RaisedError> {
    match context.required(0)? {
        Value::Array(items) => Ok(items.clone()),
        _ => Err(context.argument_error("a buffer of characters is needed")),
    }
}

fn offset(context: &CallContext<'_>) -> Result<usize, RaisedError> {
    let offset = context.required(1)?;
    match offset {
        Value::Int(offset) if *offset >= 0 => Ok(*offset as usize),
        Value::Unset => Err(context.raise(&MachineFault::NotInitialized {
            name: "the offset".into(),
        })),
        _ => Err(context.argument_error("the offset is below 0")),
    }
}

fn overrun(context: &CallContext<'_>, end: usize, size: usize) -> RaisedError {
    context.argument_error(format!(
        "the values reach to byte {end} of a buffer of {size} bytes"
    ))
}

/// The offset counts from 0 and moves on.
fn cast_to(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let mut items = buffer(context)?;
    let offset = offset(context)?;
    let mut bytes = Vec::new();
    for argument in 2..context.arguments.len() {
        let (kind, value) = any_value(context, argument)?;
        append(context, &kind, &value, 0, &mut bytes)?;
    }
    let end = offset + bytes.len();
    if end > items.len() {
        return Err(overrun(context, end, items.len()));
    }
    for (place, byte) in items[offset..end].iter_mut().zip(bytes) {
        *place = Value::Int(i64::from(byte));
    }
    context.assign(0, Value::Array(items))?;
    context.assign(1, Value::Int(end as i64))?;
    Ok(Outcome::Done(Value::Absent))
}

/// Takes values off the front of the bytes, in the shape of `value`. `None` if there are too few.
fn extract(kind: &str, value: &Value, place: usize, bytes: &mut &[u8]) -> Option<Value> {
    let mut take = |count: usize| {
        let (taken, rest) = bytes.split_at_checked(count)?;
        *bytes = rest;
        Some(taken)
    };
    match value {
        Value::Array(items) => {
            let made: Option<Vec<_>> = items
                .iter()
                .map(|item| extract(kind, item, 0, bytes))
                .collect();
            return made.map(Value::Array);
        }
        Value::Record(parts) => {
            let made: Option<Vec<_>> = parts
                .iter()
                .enumerate()
                .map(|(i, part)| extract(kind, part, i, bytes))
                .collect();
            return made.map(Value::Record);
        }
        _ => {}
    }
    Some(match leaf(kind, place).to_ascii_uppercase().as_str() {
        "INT" => Value::Int(i64::from(i32::from_le_bytes(take(4)?.try_into().ok()?))),
        "REAL" => Value::Num(f32::from_le_bytes(take(4)?.try_into().ok()?)),
        "BOOL" => Value::Bool(take(1)?[0] != 0),
        _ => Value::Int(i64::from(take(1)?[0])),
    })
}

fn cast_from(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let items = buffer(context)?;
    let offset = offset(context)?;
    let filled = codes(&Value::Array(items.clone()));
    let Some(mut rest) = filled.get(offset..) else {
        return Err(overrun(context, offset, filled.len()));
    };
    for argument in 2..context.arguments.len() {
        let (kind, reference) = any_variable(context, argument)?;
        if leaf(&kind, 0).is_empty() {
            return Err(context.argument_error(format!("CAST_FROM does not fill {kind}")));
        }
        let shape = match context.memory.read(&reference) {
            Ok(shape) => shape.clone(),
            Err(fault) => return Err(context.raise(&fault)),
        };
        let Some(value) = extract(&kind, &shape, 0, &mut rest) else {
            return Err(context.argument_error(format!(
                "the values reach behind the {} bytes of the buffer that have a value",
                filled.len()
            )));
        };
        let written = context.memory.write(&reference, value);
        written.map_err(|fault| context.raise(&fault))?;
    }
    let end = filled.len() - rest.len();
    context.assign(1, Value::Int(end as i64))?;
    Ok(Outcome::Done(Value::Absent))
}
