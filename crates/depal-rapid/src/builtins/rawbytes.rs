use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RAW_BYTES_LIMIT, RaisedError, RawBytes, Value};

use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 5] = [
    (
        "PROC PackRawBytes(anytype Value, INOUT rawbytes RawData \\switch Network, num StartIndex \\switch Hex1 | num IntX | switch Float4 | switch Float8 | switch ASCII)",
        pack,
    ),
    (
        "PROC UnpackRawBytes(INOUT rawbytes RawData \\switch Network, num StartIndex, INOUT anytype Value \\switch Hex1 | num IntX | switch Float4 | switch Float8 | num ASCII)",
        unpack,
    ),
    (
        "PROC ClearRawBytes(INOUT rawbytes RawData \\num FromIndex)",
        clear,
    ),
    (
        "PROC CopyRawBytes(INOUT rawbytes FromRawData, num FromIndex, INOUT rawbytes ToRawData, num ToIndex \\num NoOfBytes)",
        copy,
    ),
    ("FUNC num RawBytesLen(INOUT rawbytes RawData)", length),
];

fn raw(context: &CallContext<'_>, index: usize) -> Result<RawBytes, RaisedError> {
    match context.required(index)? {
        Value::Raw(raw) => Ok((**raw).clone()),
        other => {
            Err(context.argument_error(format!("expected rawbytes, found {}", other.kind_name())))
        }
    }
}

/// An index from 1 as an offset from 0.
fn offset(context: &CallContext<'_>, index: usize) -> Result<usize, RaisedError> {
    let value = context.number(index)?;
    if value.fract() != 0.0 || !(1.0..=RAW_BYTES_LIMIT as f64).contains(&value) {
        return Err(context.argument_error(format!(
            "the byte index {value} is outside 1..{RAW_BYTES_LIMIT}"
        )));
    }
    Ok(value as usize - 1)
}

/// Width in bytes and sign of an `\IntX`.
fn integer_format(context: &CallContext<'_>, code: f64) -> Result<(usize, bool), RaisedError> {
    let width = code.abs() as usize;
    if matches!(width, 1 | 2 | 4 | 8) && code.fract() == 0.0 {
        Ok((width, code < 0.0))
    } else {
        Err(context.argument_error(format!(
            "\\IntX is {code}; use USINT, UINT, UDINT, ULINT, SINT, INT, DINT or LINT"
        )))
    }
}

fn ordered(mut bytes: Vec<u8>, network: bool) -> Vec<u8> {
    if network {
        bytes.reverse();
    }
    bytes
}

fn pack(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let network = context.is_given(2);
    let at = offset(context, 3)?;
    let value = context.required(0)?.clone();
    let number = value.as_number();
    let bytes = if context.is_given(4) || context.optional_number(5)?.is_some() {
        let code = context.optional_number(5)?.unwrap_or(1.0);
        let (width, signed) = integer_format(context, code)?;
        let Some(number) = number else {
            return Err(context.argument_error("\\IntX and \\Hex1 pack numbers"));
        };
        let bits = width as i32 * 8;
        let (low, high) = if signed {
            (-(2f64.powi(bits - 1)), 2f64.powi(bits - 1))
        } else {
            (0.0, 2f64.powi(bits))
        };
        let whole = number.round();
        if !(low..high).contains(&whole) {
            return Err(context.argument_error(format!(
                "{number} does not fit in {width} bytes: {low} to {}",
                high - 1.0
            )));
        }
        let integer = i128::from(whole as i64).max(whole as i128);
        ordered(integer.to_le_bytes()[..width].to_vec(), network)
    } else if context.is_given(6) || context.is_given(7) {
        let Some(number) = number else {
            return Err(context.argument_error("\\Float4 packs numbers"));
        };
        if context.is_given(6) {
            ordered((number as f32).to_le_bytes().to_vec(), network)
        } else {
            ordered(number.to_le_bytes().to_vec(), network)
        }
    } else if context.is_given(8) {
        match value {
            Value::Str(text) => text
                .chars()
                .map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?'))
                .collect(),
            Value::Num(code) => vec![code.round() as u8],
            other => {
                return Err(context.argument_error(format!(
                    "\\ASCII packs strings, found {}",
                    other.kind_name()
                )));
            }
        }
    } else {
        return Err(context.argument_error(
            "PackRawBytes needs one of \\Hex1, \\IntX, \\Float4, \\Float8, \\ASCII",
        ));
    };
    let mut target = raw(context, 1)?;
    if !target.write(at, &bytes) {
        return Err(context.argument_error(format!(
            "{} bytes from index {} on do not fit in {RAW_BYTES_LIMIT}",
            bytes.len(),
            at + 1
        )));
    }
    context.assign(1, Value::Raw(Box::new(target)))?;
    done()
}

fn unpack(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let network = context.is_given(1);
    let at = offset(context, 2)?;
    let source = raw(context, 0)?;
    let take = |width: usize| -> Result<Vec<u8>, RaisedError> {
        source
            .as_slice()
            .get(at..at + width)
            .map(|bytes| ordered(bytes.to_vec(), network))
            .ok_or_else(|| {
                error(
                    "ERR_RANYBIN_EOF",
                    format!(
                        "{width} bytes from index {} on: only {} bytes are there",
                        at + 1,
                        source.as_slice().len()
                    ),
                )
            })
    };
    if context.is_given(4) || context.is_given(5) {
        let code = context.optional_number(5)?.unwrap_or(1.0);
        let (width, signed) = integer_format(context, code)?;
        let mut wide = [0u8; 8];
        wide[..width].copy_from_slice(&take(width)?);
        let unsigned = u64::from_le_bytes(wide);
        let number = if signed {
            let shift = 64 - width as u32 * 8;
            ((unsigned << shift) as i64 >> shift) as f64
        } else {
            unsigned as f64
        };
        context.assign_number(3, number)?;
    } else if context.is_given(6) {
        let mut four = [0u8; 4];
        four.copy_from_slice(&take(4)?);
        context.assign_number(3, f64::from(f32::from_le_bytes(four)))?;
    } else if context.is_given(7) {
        let mut eight = [0u8; 8];
        eight.copy_from_slice(&take(8)?);
        context.assign_number(3, f64::from_le_bytes(eight))?;
    } else if let Some(count) = context.optional_number(8)? {
        if !(1.0..=80.0).contains(&count) {
            return Err(
                context.argument_error(format!("\\ASCII is {count}; a string holds 1 to 80"))
            );
        }
        let bytes = source.as_slice().get(at..at + count as usize);
        let Some(bytes) = bytes else {
            return Err(take(count as usize)
                .err()
                .unwrap_or_else(|| error("ERR_RANYBIN_EOF", "not enough bytes")));
        };
        let text = bytes.iter().map(|b| char::from(*b)).collect();
        context.assign(3, Value::Str(text))?;
    } else {
        return Err(context.argument_error(
            "UnpackRawBytes needs one of \\Hex1, \\IntX, \\Float4, \\Float8, \\ASCII",
        ));
    }
    done()
}

fn clear(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let keep = if context.is_given(1) {
        offset(context, 1)?
    } else {
        0
    };
    let mut target = raw(context, 0)?;
    target.truncate(keep);
    context.assign(0, Value::Raw(Box::new(target)))?;
    done()
}

fn copy(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let source = raw(context, 0)?;
    let (from, to) = (offset(context, 1)?, offset(context, 3)?);
    let there = source.as_slice().len();
    let count = match context.optional_number(4)? {
        Some(count) => count.max(0.0) as usize,
        None => there.saturating_sub(from).min(RAW_BYTES_LIMIT - to),
    };
    let Some(bytes) = source.as_slice().get(from..from + count) else {
        return Err(error(
            "ERR_RANYBIN_EOF",
            format!(
                "{count} bytes from index {} on: only {there} are there",
                from + 1
            ),
        ));
    };
    let mut target = raw(context, 2)?;
    if !target.write(to, bytes) {
        return Err(context.argument_error(format!("{count} bytes do not fit at index {}", to + 1)));
    }
    context.assign(2, Value::Raw(Box::new(target)))?;
    done()
}

fn length(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let length = raw(context, 0)?.as_slice().len();
    Ok(Outcome::Done(Value::Num(length as f32)))
}

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}
