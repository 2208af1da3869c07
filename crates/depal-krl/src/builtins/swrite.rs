//! SWRITE and SREAD: values in a string by a format.

use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::bytes::{any_value, any_variable};
use super::strings::{codes, store, text};
use super::table::{Entry, Ran};

pub(super) const ENTRIES: [Entry; 2] = [
    (
        "SWRITE(CHAR[] Text:OUT, STATE_T State:OUT, INT Offset:OUT, CHAR[] Format, ...)",
        swrite,
    ),
    (
        "SREAD(CHAR[] Text:OUT, STATE_T State:OUT, INT Offset:OUT, CHAR[] Format, ...:OUT)",
        sread,
    ),
];

/// Constants of CMD_STAT: #CMD_OK, #CMD_FMT_ERR, #DATA_OK, #DATA_END.
const FORMAT_ERROR: i64 = 3;
const DATA_OK: i64 = 4;
const DATA_END: i64 = 5;

/// A piece of a format.
#[derive(Debug, PartialEq)]
enum Piece {
    Character(char),
    Value {
        width: Option<usize>,
        decimals: Option<usize>,
        left: bool,
        zeros: bool,
        conversion: char,
    },
}

/// `None` if it is no format.
fn pieces(format: &str) -> Option<Vec<Piece>> {
    let mut pieces = Vec::new();
    let mut rest = format.chars().peekable();
    while let Some(c) = rest.next() {
        if c != '%' {
            pieces.push(Piece::Character(c));
            continue;
        }
        if rest.peek() == Some(&'%') {
            rest.next();
            pieces.push(Piece::Character('%'));
            continue;
        }
        let (mut left, mut zeros) = (false, false);
        while let Some(flag) = rest.peek().filter(|c| "-+0".contains(**c)) {
            left |= *flag == '-';
            zeros |= *flag == '0';
            rest.next();
        }
        let number = |rest: &mut std::iter::Peekable<std::str::Chars<'_>>| {
            let mut digits = String::new();
            while let Some(digit) = rest.peek().filter(|c| c.is_ascii_digit()) {
                digits.push(*digit);
                rest.next();
            }
            digits.parse::<usize>().ok().map(|n| n.min(200))
        };
        let width = number(&mut rest);
        let mut decimals = None;
        if rest.peek() == Some(&'.') {
            rest.next();
            decimals = Some(number(&mut rest).unwrap_or(0));
        }
        let conversion = rest.next().filter(|c| "dixfegcsr".contains(*c))?;
        pieces.push(Piece::Value {
            width,
            decimals,
            left,
            zeros,
            conversion,
        });
    }
    Some(pieces)
}

/// A value without a format.
pub(super) fn plain(kind: &str, value: &Value) -> String {
    match value {
        Value::Array(_) => codes(value).into_iter().map(char::from).collect(),
        Value::Int(code) if kind.eq_ignore_ascii_case("char") => {
            char::from(*code as u8).to_string()
        }
        Value::Int(value) => value.to_string(),
        Value::Num(value) => value.to_string(),
        Value::Bool(value) => if *value { "TRUE" } else { "FALSE" }.to_owned(),
        _ => "?".to_owned(),
    }
}

/// `None` if the conversion does not fit the value.
fn converted(
    kind: &str,
    value: &Value,
    conversion: char,
    decimals: Option<usize>,
) -> Option<String> {
    let digits = decimals.unwrap_or(6);
    Some(match (conversion, value) {
        ('d' | 'i', Value::Int(value)) => value.to_string(),
        ('d' | 'i', Value::Bool(value)) => i32::from(*value).to_string(),
        ('x', Value::Int(value)) => format!("{:x}", *value as u32),
        ('f', value) => format!("{:.digits$}", value.as_number()?),
        ('e', value) => exponent(value.as_number()?, digits),
        ('g', value) => value.as_number()?.to_string(),
        ('c', Value::Int(code)) => char::from(*code as u8).to_string(),
        ('s', value @ Value::Array(_)) => {
            let text = plain(kind, value);
            match decimals {
                Some(most) => text.chars().take(most).collect(),
                None => text,
            }
        }
        ('s', value) => plain(kind, value),
        _ => return None,
    })
}

/// `1.500000e+03`.
fn exponent(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$e}");
    match text.split_once('e') {
        Some((mantissa, exponent)) => {
            let exponent: i32 = exponent.parse().unwrap_or(0);
            let sign = if exponent < 0 { '-' } else { '+' };
            format!("{mantissa}e{sign}{:02}", exponent.abs())
        }
        None => text,
    }
}

fn padded(text: String, width: Option<usize>, left: bool, zeros: bool) -> String {
    let missing = width.unwrap_or(0).saturating_sub(text.chars().count());
    if left {
        return text + &" ".repeat(missing);
    }
    if zeros {
        let (sign, digits) = match text.strip_prefix('-') {
            Some(digits) => ("-", digits),
            None => ("", text.as_str()),
        };
        return format!("{sign}{}{digits}", "0".repeat(missing));
    }
    " ".repeat(missing) + &text
}

fn finish(context: &mut CallContext<'_>, status: i64, hits: usize, length: usize) -> Ran {
    let state = [status, hits as i64, length as i64, 0].map(Value::Int);
    context.assign(1, Value::Record(state.to_vec()))?;
    Ok(Outcome::Done(Value::Absent))
}

fn offset(context: &CallContext<'_>) -> Result<usize, RaisedError> {
    match context.required(2)? {
        Value::Int(offset) if *offset >= 0 => Ok(*offset as usize),
        _ => Err(context.argument_error("the offset has no value yet, or is below 0")),
    }
}

/// Writes from the offset on, which counts from 0 and moves on.
fn swrite(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let offset = offset(context)?;
    let Some(pieces) = pieces(&text(context, 3)?) else {
        return finish(context, FORMAT_ERROR, 0, 0);
    };
    let mut written = String::new();
    let mut hits = 0;
    let mut argument = 4;
    for piece in pieces {
        match piece {
            Piece::Character(c) => written.push(c),
            Piece::Value {
                width,
                decimals,
                left,
                zeros,
                conversion,
            } => {
                if argument >= context.arguments.len() {
                    return finish(context, FORMAT_ERROR, hits, 0);
                }
                let (kind, value) = any_value(context, argument)?;
                argument += 1;
                let Some(text) = converted(&kind, &value, conversion, decimals) else {
                    return finish(context, FORMAT_ERROR, hits, 0);
                };
                written.push_str(&padded(text, width, left, zeros));
                hits += 1;
            }
        }
    }
    let mut all = codes(context.required(0)?);
    all.resize(offset, b' ');
    let new: Vec<u8> = written.chars().map(|c| c as u8).collect();
    let length = new.len();
    all.extend(new);
    if !store(context, 0, &all)? {
        return finish(context, DATA_END, hits, 0);
    }
    context.assign(2, Value::Int((offset + length) as i64))?;
    finish(context, DATA_OK, hits, length)
}

/// How many characters of a text a conversion takes, and the value of the variable's type.
fn read_value(kind: &str, text: &str, conversion: char) -> Option<(usize, Value)> {
    let blank = if conversion == 'c' {
        0
    } else {
        text.len() - text.trim_start().len()
    };
    let rest = &text[blank..];
    let upper = kind.to_ascii_uppercase();
    let (count, value) = match conversion {
        'd' | 'i' => {
            let end = rest
                .char_indices()
                .find(|(i, c)| !(c.is_ascii_digit() || (*i == 0 && "+-".contains(*c))))
                .map_or(rest.len(), |(i, _)| i);
            let value: i64 = rest[..end].parse().ok()?;
            let value = match upper.as_str() {
                "REAL" => Value::Num(value as f32),
                "BOOL" => Value::Bool(value != 0),
                _ => Value::Int(value),
            };
            (end, value)
        }
        'x' => {
            let end = rest.find(|c: char| !c.is_ascii_hexdigit());
            let end = end.unwrap_or(rest.len());
            let value = u32::from_str_radix(&rest[..end], 16).ok()?;
            (end, Value::Int(i64::from(value as i32)))
        }
        'f' | 'e' | 'g' => {
            let end = rest.find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)));
            let end = end.unwrap_or(rest.len());
            let value: f64 = rest[..end].parse().ok()?;
            let value = match upper.as_str() {
                "INT" => Value::Int(value.round() as i64),
                _ => Value::Num(value as f32),
            };
            (end, value)
        }
        'c' => {
            let c = rest.chars().next()?;
            (c.len_utf8(), Value::Int(i64::from(c as u8)))
        }
        's' => {
            let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
            let codes = rest[..end].chars().map(|c| Value::Int(i64::from(c as u8)));
            (end, Value::Array(codes.collect()))
        }
        _ => return None,
    };
    Some((blank + count, value))
}

/// Reads from the offset on.
fn sread(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let begin = offset(context)?;
    let Some(pieces) = pieces(&text(context, 3)?) else {
        return finish(context, FORMAT_ERROR, 0, 0);
    };
    let all = text(context, 0)?;
    let all: String = all.chars().skip(begin).collect();
    let mut at = 0;
    let mut hits = 0;
    let mut argument = 4;
    for piece in pieces {
        let rest = &all[at..];
        match piece {
            Piece::Character(c) if c.is_whitespace() => {
                at += rest.len() - rest.trim_start().len();
            }
            Piece::Character(c) => {
                if !rest.starts_with(c) {
                    break;
                }
                at += c.len_utf8();
            }
            Piece::Value {
                width, conversion, ..
            } => {
                if argument >= context.arguments.len() {
                    return finish(context, FORMAT_ERROR, hits, 0);
                }
                let (kind, reference) = any_variable(context, argument)?;
                argument += 1;
                let end = width.and_then(|w| rest.char_indices().nth(w));
                let field = &rest[..end.map_or(rest.len(), |(i, _)| i)];
                let Some((count, value)) = read_value(&kind, field, conversion) else {
                    break;
                };
                at += count;
                hits += 1;
                let value = match (context.memory.read(&reference), value) {
                    (Ok(Value::Array(old)), Value::Array(mut new)) => {
                        new.resize(old.len(), Value::Unset);
                        Value::Array(new)
                    }
                    (_, value) => value,
                };
                let written = context.memory.write(&reference, value);
                written.map_err(|fault| context.raise(&fault))?;
            }
        }
    }
    let count = all[..at].chars().count();
    context.assign(2, Value::Int((begin + count) as i64))?;
    let wanted = context.arguments.len() - 4;
    let status = if hits == wanted { DATA_OK } else { DATA_END };
    finish(context, status, hits, count)
}
