//! Values of the language and values of a channel, each made from the other.

use depal_eki::{EkiError, ElementType, ElementValue, Status};
use depal_vm::{CallContext, RaisedError, Value};

/// An EKI_STATUS.
pub(super) fn record(status: &Status) -> Value {
    let int = |value: i32| Value::Int(i64::from(value));
    Value::Record(vec![
        int(status.buff),
        int(status.read),
        int(status.message_number()),
        Value::Bool(status.connected),
        int(status.counter),
        int(status.timestamp_ms),
    ])
}

/// The codes of a character array up to the last one that has a value; what has none before it is zero.
pub(super) fn bytes(context: &CallContext<'_>, argument: usize) -> Result<Vec<u8>, RaisedError> {
    match context.required(argument)? {
        Value::Array(codes) => {
            let last = codes.iter().rposition(|code| code.as_number().is_some());
            let codes = codes.iter().take(last.map_or(0, |last| last + 1));
            Ok(codes
                .map(|code| code.as_number().unwrap_or(0.0) as u8)
                .collect())
        }
        Value::Str(text) => Ok(text.chars().map(|c| c as u32 as u8).collect()),
        other => Err(context.argument_error(format!(
            "expected a character array, found {}",
            other.kind_name()
        ))),
    }
}

/// A string: up to the first character that is zero or has no value.
pub(super) fn text(context: &CallContext<'_>, argument: usize) -> Result<String, RaisedError> {
    let codes = bytes(context, argument)?;
    let text = codes.into_iter().take_while(|code| *code != 0);
    Ok(text.map(char::from).collect())
}

/// Elements of an array that was lent.
pub(super) fn elements(context: &CallContext<'_>, argument: usize) -> Result<usize, RaisedError> {
    match array(context, argument)? {
        Value::Array(items) => Ok(items.len()),
        other => {
            Err(context.argument_error(format!("expected an array, found {}", other.kind_name())))
        }
    }
}

/// What was lent, whether it has a value or not.
fn array<'a>(context: &'a CallContext<'_>, argument: usize) -> Result<&'a Value, RaisedError> {
    context.required(argument)
}

pub(super) fn element_value(
    context: &CallContext<'_>,
    argument: usize,
    kind: ElementType,
) -> Result<ElementValue, RaisedError> {
    Ok(match kind {
        ElementType::Bool => ElementValue::Bool(*context.required(argument)? == Value::Bool(true)),
        ElementType::Int => ElementValue::Int(context.number(argument)? as i32),
        ElementType::Real => ElementValue::Real(context.number(argument)?),
        ElementType::Frame => {
            let mut frame = [0.0; 6];
            if let Value::Record(parts) = context.required(argument)? {
                for (number, part) in frame.iter_mut().zip(parts) {
                    *number = part.as_number().ok_or_else(|| {
                        context.argument_error("a component of the frame has no value yet")
                    })?;
                }
            }
            ElementValue::Frame(frame)
        }
        ElementType::String | ElementType::Byte | ElementType::Stream => {
            ElementValue::String(text(context, argument)?)
        }
    })
}

/// Codes of a text: ISO 8859-1, `?` for what is not in it.
fn codes(text: &str) -> Vec<u8> {
    let code = |c: char| u8::try_from(u32::from(c)).unwrap_or(b'?');
    text.chars().map(code).collect()
}

fn value(value: ElementValue) -> Value {
    let characters = |codes: Vec<u8>| {
        let codes = codes.into_iter().map(|code| Value::Int(i64::from(code)));
        Value::Array(codes.collect())
    };
    match value {
        ElementValue::String(text) => characters(codes(&text)),
        ElementValue::Bytes(bytes) => characters(bytes),
        ElementValue::Real(number) => Value::Num(number as f32),
        ElementValue::Int(number) => Value::Int(i64::from(number)),
        ElementValue::Bool(truth) => Value::Bool(truth),
        ElementValue::Frame(parts) => {
            Value::Record(parts.iter().map(|part| Value::Num(*part as f32)).collect())
        }
    }
}

/// Whether a text does not fit into the array for it.
pub(super) fn too_long(tag: &str, values: &[ElementValue], room: usize) -> Option<EkiError> {
    let length = values.iter().map(|value| match value {
        ElementValue::String(text) => text.chars().count(),
        ElementValue::Bytes(bytes) => bytes.len(),
        _ => 0,
    });
    let length = length.max().filter(|length| *length > room)?;
    Some(EkiError::TooLong {
        tag: tag.to_owned(),
        length,
        room,
    })
}

/// Gives the variable a value; characters behind a text have none then.
pub(super) fn assign_value(
    context: &mut CallContext<'_>,
    argument: usize,
    new: ElementValue,
) -> Result<(), RaisedError> {
    match value(new) {
        Value::Array(mut items) => {
            items.resize(elements(context, argument)?, Value::Unset);
            context.assign(argument, Value::Array(items))
        }
        value => context.assign(argument, value),
    }
}

/// Gives the first elements of an array values.
pub(super) fn assign_array(
    context: &mut CallContext<'_>,
    argument: usize,
    new: Vec<ElementValue>,
) -> Result<(), RaisedError> {
    let mut array = array(context, argument)?.clone();
    if let Value::Array(items) = &mut array {
        for (item, new) in items.iter_mut().zip(new) {
            *item = value(new);
        }
    }
    context.assign(argument, array)
}

/// Whether the second argument is `#QUIT`.
pub(super) fn is_quit(context: &CallContext<'_>) -> Result<bool, RaisedError> {
    const QUIT: f64 = 3.0;
    Ok(context.number(1)? == QUIT)
}
