use depal_vm::system::System;
use depal_vm::{CallContext, MachineFault, Outcome, RaisedError, Value};

use super::table::Entry;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 12] = [
    (
        "FUNC string NumToStr(num Val, num Dec \\switch Exp)",
        num_to_str,
    ),
    (
        "FUNC string DnumToStr(dnum Val, num Dec \\switch Exp)",
        num_to_str,
    ),
    ("FUNC string ValToStr(anytype Val)", val_to_str),
    ("FUNC num StrLen(string Str)", str_len),
    (
        "FUNC string StrPart(string Str, num ChPos, num Len)",
        str_part,
    ),
    (
        "FUNC num StrFind(string Str, num ChPos, string Set \\switch NotInSet)",
        str_find,
    ),
    (
        "FUNC num StrMatch(string Str, num ChPos, string Pattern)",
        str_match,
    ),
    (
        "FUNC bool StrToVal(string Str, INOUT anytype Val)",
        str_to_val,
    ),
    (
        "FUNC bool StrMemb(string Str, num ChPos, string Set)",
        str_memb,
    ),
    (
        "FUNC string StrMap(string Str, string FromMap, string ToMap)",
        str_map,
    ),
    (
        "FUNC string ByteToStr(num ByteData \\switch Hex | switch Char)",
        byte_to_str,
    ),
    (
        "FUNC num StrToByte(string ConStr \\switch Hex | switch Char)",
        str_to_byte,
    ),
];

/// A value as ValToStr and TPWrite show it: num with 6 significant digits, dnum with 15.
pub(super) fn display(value: &Value) -> String {
    match value {
        Value::Num(v) => significant(f64::from(*v), 6),
        Value::Dnum(v) => significant(*v, 15),
        Value::Int(v) => v.to_string(),
        Value::Bool(true) => "TRUE".into(),
        Value::Bool(false) => "FALSE".into(),
        Value::Str(text) => text.clone(),
        Value::Record(items) | Value::Array(items) => {
            let parts: Vec<_> = items
                .iter()
                .map(|item| match item {
                    Value::Str(text) => format!("\"{text}\""),
                    item => display(item),
                })
                .collect();
            format!("[{}]", parts.join(","))
        }
        other => other.kind_name().into(),
    }
}

fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}").replace("-0", "0");
    }
    let scientific = format!("{:.*e}", digits - 1, value);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trim = |text: &str| {
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text.to_owned()
        }
    };
    if exponent < -5 || exponent >= digits as i32 {
        let sign = if exponent < 0 { '-' } else { '+' };
        return format!("{}E{sign}{:02}", trim(mantissa), exponent.abs());
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    trim(&format!("{value:.decimals$}"))
}

fn text(context: &CallContext<'_>, text: String) -> Ran {
    let length = text.chars().count();
    let limit = context.rules.string_limit;
    if length > limit {
        return Err(context.raise(&MachineFault::StringTooLong { length, limit }));
    }
    Ok(Outcome::Done(Value::Str(text)))
}

fn num_to_str(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let value = context.number(0)?;
    let decimals = context.number(1)?;
    if decimals < 0.0 {
        return Err(context.argument_error(format!("{decimals} decimals")));
    }
    let decimals = decimals.min(20.0) as usize;
    if context.is_given(2) {
        let shown = format!("{value:.decimals$e}");
        let (mantissa, exponent) = shown.split_once('e').unwrap_or((&shown, "0"));
        let exponent: i32 = exponent.parse().unwrap_or(0);
        let sign = if exponent < 0 { '-' } else { '+' };
        return text(context, format!("{mantissa}E{sign}{:02}", exponent.abs()));
    }
    text(context, crate::rules::with_decimals(value, decimals))
}

fn val_to_str(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let shown = match context.required(0)? {
        Value::Str(text) => format!("\"{text}\""),
        value => display(value),
    };
    text(context, shown)
}

fn characters(context: &CallContext<'_>, index: usize) -> Result<Vec<char>, RaisedError> {
    Ok(context.string(index)?.chars().collect())
}

/// A position from 1 in a text of `length`, as an offset; one past the end is allowed.
fn position(context: &CallContext<'_>, index: usize, length: usize) -> Result<usize, RaisedError> {
    let value = context.number(index)?;
    if value < 1.0 || value > length as f64 + 1.0 {
        return Err(context.argument_error(format!(
            "position {value} is outside the string of {length} characters"
        )));
    }
    Ok(value as usize - 1)
}

fn str_len(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Done(Value::Num(
        characters(context, 0)?.len() as f32
    )))
}

fn str_part(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let characters = characters(context, 0)?;
    let from = position(context, 1, characters.len())?;
    let count = context.number(2)?;
    if count < 0.0 || from + count as usize > characters.len() {
        return Err(context.argument_error(format!(
            "{count} characters from position {} of a string of {}",
            from + 1,
            characters.len()
        )));
    }
    text(
        context,
        characters[from..from + count as usize].iter().collect(),
    )
}

/// Position of the first character of a set; the length plus 1 if there is none.
fn str_find(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let characters = characters(context, 0)?;
    let from = position(context, 1, characters.len())?;
    let set = context.string(2)?;
    let wanted = !context.is_given(3);
    let found = characters[from..]
        .iter()
        .position(|c| set.contains(*c) == wanted)
        .map_or(characters.len(), |i| from + i);
    Ok(Outcome::Done(Value::Num(found as f32 + 1.0)))
}

/// Position of a pattern; the length plus 1 if it is not there.
fn str_match(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let characters = characters(context, 0)?;
    let from = position(context, 1, characters.len())?;
    let pattern: Vec<char> = context.string(2)?.chars().collect();
    if pattern.is_empty() {
        return Err(context.argument_error("the pattern is empty"));
    }
    let found = characters[from..]
        .windows(pattern.len())
        .position(|window| window == pattern)
        .map_or(characters.len(), |i| from + i);
    Ok(Outcome::Done(Value::Num(found as f32 + 1.0)))
}

fn str_memb(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let characters = characters(context, 0)?;
    let at = position(context, 1, characters.len())?;
    let set = context.string(2)?;
    let found = characters.get(at).is_some_and(|c| set.contains(*c));
    Ok(Outcome::Done(Value::Bool(found)))
}

fn str_map(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (from, to) = (characters(context, 1)?, characters(context, 2)?);
    if from.len() != to.len() {
        return Err(context.argument_error("FromMap and ToMap differ in length"));
    }
    let mapped = characters(context, 0)?
        .into_iter()
        .map(|c| from.iter().position(|f| *f == c).map_or(c, |i| to[i]))
        .collect();
    text(context, mapped)
}

fn byte_to_str(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let byte = context.number(0)?;
    if byte.fract() != 0.0 || !(0.0..=255.0).contains(&byte) {
        return Err(context.argument_error(format!("{byte} is no byte")));
    }
    let byte = byte as u8;
    let shown = if context.is_given(1) {
        format!("{byte:02X}")
    } else if context.is_given(2) {
        char::from(byte).to_string()
    } else {
        byte.to_string()
    };
    text(context, shown)
}

fn str_to_byte(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let given = context.string(0)?;
    let byte = if context.is_given(1) {
        u8::from_str_radix(&given, 16).ok()
    } else if context.is_given(2) {
        given
            .chars()
            .next()
            .and_then(|c| u8::try_from(u32::from(c)).ok())
    } else {
        given.trim().parse().ok()
    };
    match byte {
        Some(byte) => Ok(Outcome::Done(Value::Num(f32::from(byte)))),
        None => Err(context.argument_error(format!("{given:?} is no byte"))),
    }
}

fn str_to_val(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let given = context.string(0)?;
    let like = context.required(1)?.clone();
    let mut rest = given.as_str();
    let parsed = read_like(&like, &mut rest).filter(|_| rest.trim().is_empty());
    let fits = parsed.is_some();
    if let Some(value) = parsed {
        context.assign(1, value)?;
    }
    Ok(Outcome::Done(Value::Bool(fits)))
}

/// Reads a value of the same type as `like` from the start of `rest`.
fn read_like(like: &Value, rest: &mut &str) -> Option<Value> {
    *rest = rest.trim_start();
    match like {
        Value::Num(_) | Value::Dnum(_) => {
            let length = rest
                .find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)))
                .unwrap_or(rest.len());
            let number: f64 = rest[..length].parse().ok()?;
            *rest = &rest[length..];
            Some(match like {
                Value::Num(_) => Value::Num(number as f32),
                _ => Value::Dnum(number),
            })
        }
        Value::Bool(_) => {
            for (word, value) in [("TRUE", true), ("FALSE", false)] {
                if rest
                    .get(..word.len())
                    .is_some_and(|s| s.eq_ignore_ascii_case(word))
                {
                    *rest = &rest[word.len()..];
                    return Some(Value::Bool(value));
                }
            }
            None
        }
        Value::Str(_) => {
            let inner = rest.strip_prefix('"')?;
            let end = inner.find('"')?;
            let value = Value::Str(inner[..end].to_owned());
            *rest = &inner[end + 1..];
            Some(value)
        }
        Value::Record(items) | Value::Array(items) => {
            *rest = rest.strip_prefix('[')?;
            let mut values = Vec::with_capacity(items.len());
            for (i, item) in items.iter().enumerate() {
                if i > 0 {
                    *rest = rest.trim_start().strip_prefix(',')?;
                }
                values.push(read_like(item, rest)?);
            }
            *rest = rest.trim_start().strip_prefix(']')?;
            Some(match like {
                Value::Record(_) => Value::Record(values),
                _ => Value::Array(values),
            })
        }
        _ => None,
    }
}
