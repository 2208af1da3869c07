//! Strings are arrays of character codes; what lies behind the last one has no value.

use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::table::{Entry, Ran};

pub(super) const ENTRIES: [Entry; 7] = [
    ("BOOL StrAdd(CHAR[] Dest:OUT, CHAR[] Text)", add),
    ("BOOL StrClear(CHAR[] Text:OUT)", clear),
    ("BOOL StrCopy(CHAR[] Dest:OUT, CHAR[] Text)", copy),
    (
        "BOOL StrComp(CHAR[] First, CHAR[] Second, CASE_SENSE_T Case)",
        compare,
    ),
    (
        "INT StrFind(INT Start, CHAR[] Text, CHAR[] Wanted, CASE_SENSE_T Case)",
        find,
    ),
    ("INT StrLen(CHAR[] Text)", length),
    ("INT StrDeclLen(CHAR[] Text:OUT)", declared_length),
];

/// The codes of the characters before the first place without a value.
pub(super) fn codes(value: &Value) -> Vec<u8> {
    match value {
        Value::Array(items) => items
            .iter()
            .map_while(|item| match item {
                Value::Int(code) => Some(*code as u8),
                _ => None,
            })
            .collect(),
        _ => Vec::new(),
    }
}

/// A string argument, as text.
pub(super) fn text(context: &CallContext<'_>, argument: usize) -> Result<String, RaisedError> {
    let codes = codes(context.required(argument)?);
    Ok(codes.into_iter().map(char::from).collect())
}

fn size(context: &CallContext<'_>, argument: usize) -> Result<usize, RaisedError> {
    match context.required(argument)? {
        Value::Array(items) => Ok(items.len()),
        _ => Ok(0),
    }
}

/// Writes a string into a variable; `false` if it does not fit.
pub(super) fn store(
    context: &mut CallContext<'_>,
    argument: usize,
    codes: &[u8],
) -> Result<bool, RaisedError> {
    let size = size(context, argument)?;
    if codes.len() > size {
        return Ok(false);
    }
    let mut items: Vec<_> = codes.iter().map(|c| Value::Int(i64::from(*c))).collect();
    items.resize(size, Value::Unset);
    context.assign(argument, Value::Array(items))?;
    Ok(true)
}

fn truth(value: bool) -> Ran {
    Ok(Outcome::Done(Value::Bool(value)))
}

fn add(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let mut all = codes(context.required(0)?);
    all.extend(codes(context.required(1)?));
    truth(store(context, 0, &all)?)
}

fn clear(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    truth(store(context, 0, &[])?)
}

fn copy(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let new = codes(context.required(1)?);
    truth(store(context, 0, &new)?)
}

/// `#NOT_CASE_SENS` is the second constant.
fn folded(context: &CallContext<'_>, argument: usize, case: usize) -> Result<Vec<u8>, RaisedError> {
    let mut codes = codes(context.required(argument)?);
    if context.number(case)? == 2.0 {
        codes.make_ascii_lowercase();
    }
    Ok(codes)
}

fn compare(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    truth(folded(context, 0, 2)? == folded(context, 1, 2)?)
}

/// The place, from 1, at or behind the start; 0 if it is not there.
fn find(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let start = context.number(0)?.max(1.0) as usize - 1;
    let (text, wanted) = (folded(context, 1, 3)?, folded(context, 2, 3)?);
    let places = text.get(start..).unwrap_or_default();
    let found = match wanted.len() {
        0 => None,
        count => places.windows(count).position(|part| part == wanted),
    };
    let place = found.map_or(0, |at| (at + start + 1) as i64);
    Ok(Outcome::Done(Value::Int(place)))
}

fn length(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let count = codes(context.required(0)?).len();
    Ok(Outcome::Done(Value::Int(count as i64)))
}

fn declared_length(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Done(Value::Int(size(context, 0)? as i64)))
}
