//! Files that are open: what is read from an `iodev` and written to it.

use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, RawBytes, Value};

use super::{Ran, done, inside, message, read, store};
use crate::builtins::records::part;
use crate::builtins::strings::display;
use crate::errors::error;

/// What an open `iodev` is used for.
const READ: f64 = 1.0;
const WRITE: f64 = 2.0;

pub(super) fn open(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let object = context.string(0)?;
    let whole = if context.is_given(1) {
        let file = context.string(1)?;
        let joint = if object.ends_with(':') || object.is_empty() {
            ""
        } else {
            "/"
        };
        format!("{object}{joint}{file}")
    } else {
        object
    };
    let path = inside(&whole).map_err(|message| error("ERR_FILEOPEN", message))?;
    if path.is_empty() {
        return Err(error("ERR_FILEOPEN", format!("{whole} names no file")));
    }
    let reads = context.is_given(3);
    if reads {
        system
            .read_file(&path)
            .map_err(|fault| error("ERR_FILEOPEN", message(&fault)))?;
    } else if context.is_given(5) {
        let old = system.read_file(&path).unwrap_or_default();
        store(system, &path, &old)?;
    } else {
        store(system, &path, &[])?;
    }
    let mode = if reads { READ } else { WRITE };
    let device = [Value::Str(path), Value::Dnum(mode), Value::Dnum(0.0)];
    context.assign(2, Value::Record(device.to_vec()))?;
    done()
}

/// Path and position of an open device.
fn device(context: &CallContext<'_>, mode: f64) -> Result<(String, usize), RaisedError> {
    let device = context.required(0)?;
    let (Value::Str(path), Some(found)) = (part(device, 0), part(device, 1).as_number()) else {
        return Err(context.argument_error("this is no file"));
    };
    if found != mode {
        let wanted = if mode == READ { "reading" } else { "writing" };
        return Err(error(
            "ERR_FILEACC",
            if found == 0.0 {
                "the file is not open".to_owned()
            } else {
                format!("{path} is not open for {wanted}")
            },
        ));
    }
    let position = part(device, 2).as_number().unwrap_or(0.0) as usize;
    Ok((path.clone(), position))
}

fn go_to(context: &mut CallContext<'_>, path: String, position: usize) -> Result<(), RaisedError> {
    let device = [
        Value::Str(path),
        Value::Dnum(READ),
        Value::Dnum(position as f64),
    ];
    context.assign(0, Value::Record(device.to_vec()))
}

fn append(context: &CallContext<'_>, system: &mut dyn System, bytes: &[u8]) -> Ran {
    let (path, _) = device(context, WRITE)?;
    match system.append_file(&path, bytes) {
        Ok(()) => done(),
        Err(fault) => Err(error("ERR_FILEACC", message(&fault))),
    }
}

pub(super) fn close(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let closed = [
        Value::Str(String::new()),
        Value::Dnum(0.0),
        Value::Dnum(0.0),
    ];
    context.assign(0, Value::Record(closed.to_vec()))?;
    done()
}

/// Text in a file is one byte a character, as in the program.
fn bytes_of(text: &str) -> Vec<u8> {
    text.chars()
        .map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?'))
        .collect()
}

fn text_of(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| char::from(*byte)).collect()
}

pub(super) fn write(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let mut text = context.string(1)?;
    for index in 2..=6 {
        if let Some(value) = context.value(index)? {
            text.push_str(&display(value));
        }
    }
    if !context.is_given(7) {
        text.push('\n');
    }
    append(context, system, &bytes_of(&text))
}

pub(super) fn write_bin(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let count = context.number(2)?;
    let Value::Array(items) = context.required(1)? else {
        return Err(context.argument_error("WriteBin takes an array of num"));
    };
    if count < 0.0 || count > items.len() as f64 {
        return Err(context.argument_error(format!(
            "WriteBin: {count} of an array of {} numbers",
            items.len()
        )));
    }
    let bytes: Option<Vec<u8>> = items
        .iter()
        .take(count as usize)
        .map(|item| {
            let number = item.as_number()?;
            ((0.0..=255.0).contains(&number) && number.fract() == 0.0).then_some(number as u8)
        })
        .collect();
    let Some(bytes) = bytes else {
        return Err(context.argument_error("WriteBin: a number is no byte (0 to 255)"));
    };
    append(context, system, &bytes)
}

pub(super) fn write_str_bin(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let text = context.string(1)?;
    append(context, system, &bytes_of(&text))
}

pub(super) fn write_raw(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let Value::Raw(raw) = context.required(1)? else {
        return Err(context.argument_error("WriteRawBytes takes rawbytes"));
    };
    let mut bytes = raw.as_slice().to_vec();
    if let Some(count) = context.optional_number(2)? {
        bytes.truncate(count.max(0.0) as usize);
    }
    append(context, system, &bytes)
}

/// What is left of the file, with its path and the position.
fn rest(
    context: &CallContext<'_>,
    system: &mut dyn System,
) -> Result<(String, usize, Vec<u8>), RaisedError> {
    let (path, position) = device(context, READ)?;
    let bytes = read(system, &path)?;
    let rest = bytes.get(position..).unwrap_or_default().to_vec();
    Ok((path, position, rest))
}

pub(super) fn read_raw(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let (path, position, mut bytes) = rest(context, system)?;
    if bytes.is_empty() {
        return Err(error(
            "ERR_RANYBIN_EOF",
            format!("{path}: nothing is left to read"),
        ));
    }
    bytes.truncate(depal_vm::RAW_BYTES_LIMIT);
    let count = bytes.len();
    let raw = RawBytes::from_bytes(bytes).unwrap_or_default();
    context.assign(1, Value::Raw(Box::new(raw)))?;
    go_to(context, path, position + count)?;
    done()
}

/// One line, or up to a character of `delim`; the end of the file is the text EOF.
fn line(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    delim: usize,
) -> Result<Option<Vec<u8>>, RaisedError> {
    let (path, position, bytes) = rest(context, system)?;
    let mut ends = vec![b'\n'];
    if context.is_given(delim) {
        ends.extend(bytes_of(&context.string(delim)?));
    }
    if bytes.is_empty() {
        return Ok(None);
    }
    let length = bytes.iter().position(|byte| ends.contains(byte));
    let text = bytes[..length.unwrap_or(bytes.len())].to_vec();
    let next = position + length.map_or(bytes.len(), |length| length + 1);
    go_to(context, path, next)?;
    Ok(Some(text))
}

pub(super) fn read_str(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    loop {
        let Some(mut text) = line(context, system, 1)? else {
            return Ok(Outcome::Done(Value::Str("EOF".to_owned())));
        };
        if context.is_given(2) {
            text.retain(|byte| *byte != b'\r');
        }
        if context.is_given(3) && text.is_empty() {
            continue;
        }
        // A longer line is read in pieces of the length of a string.
        let limit = context.rules.string_limit;
        if text.len() > limit {
            let (path, position) = device(context, READ)?;
            let back = text.len() - limit + 1;
            go_to(context, path, position.saturating_sub(back))?;
            text.truncate(limit);
        }
        return Ok(Outcome::Done(Value::Str(text_of(&text))));
    }
}

pub(super) fn read_num(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const EOF_NUM: f32 = 9.998e36;
    let Some(text) = line(context, system, 1)? else {
        return Ok(Outcome::Done(Value::Num(EOF_NUM)));
    };
    let text = text_of(&text);
    match text.trim().parse::<f64>() {
        Ok(number) => Ok(Outcome::Done(Value::Num(number as f32))),
        Err(_) => Err(error(
            "ERR_RCVDATA",
            format!("the line {text:?} is no number"),
        )),
    }
}

pub(super) fn read_bin(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const EOF_BIN: f32 = -1.0;
    let (path, position, bytes) = rest(context, system)?;
    let Some(byte) = bytes.first() else {
        return Ok(Outcome::Done(Value::Num(EOF_BIN)));
    };
    go_to(context, path, position + 1)?;
    Ok(Outcome::Done(Value::Num(f32::from(*byte))))
}

pub(super) fn read_str_bin(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let count = context.number(1)?;
    let limit = context.rules.string_limit as f64;
    if !(0.0..=limit).contains(&count) {
        return Err(context.argument_error(format!(
            "ReadStrBin: {count} characters, expected 0 to {limit}"
        )));
    }
    let (path, position, mut bytes) = rest(context, system)?;
    if bytes.is_empty() {
        return Ok(Outcome::Done(Value::Str("EOF".to_owned())));
    }
    bytes.truncate(count as usize);
    go_to(context, path, position + bytes.len())?;
    Ok(Outcome::Done(Value::Str(text_of(&bytes))))
}

pub(super) fn rewind(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (path, _) = device(context, READ)?;
    go_to(context, path, 0)?;
    done()
}

/// Files have no buffer that could be cleared.
pub(super) fn clear(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    done()
}
