//! What the inline forms of spline moves call behind WITH: settings from the data of a point.

use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::bas::{numbered_frame, numbered_load};
use super::state::{setting, variable};
use super::table::{Entry, Ran};

pub(super) const ENTRIES: [Entry; 14] = [
    ("INT SVEL_JOINT(REAL Percent)", |context, _| {
        percent(context.number(0)?)
    }),
    ("INT SACC_JOINT(PDAT Data)", |context, _| {
        percent(part(context, 0, 1)?.unwrap_or(100.0))
    }),
    ("INT SGEAR_JERK(PDAT Data)", |context, _| {
        percent(part(context, 0, 4)?.unwrap_or(100.0))
    }),
    ("FRAME STOOL2(FDAT Data)", |context, _| {
        let number = part(context, 0, 0)?.unwrap_or(0.0);
        Ok(Outcome::Done(numbered_frame(context, "tool_data", number)?))
    }),
    ("FRAME SBASE(INT Number)", |context, _| {
        let number = context.number(0)?;
        Ok(Outcome::Done(numbered_frame(context, "base_data", number)?))
    }),
    ("LOAD SLOAD(INT Number)", load),
    ("IPO_MODE_T SIPO_MODE(IPO_M_T Frame)", |_, _| {
        Ok(Outcome::Done(Value::Int(1)))
    }),
    ("APO_STRUC SAPO_PTP(PDAT Data)", |context, _| {
        apo(context, 1)
    }),
    ("APO_STRUC SAPO(LDAT Data)", |context, _| apo(context, 2)),
    (
        "CP SVEL_CP(REAL Speed, ?CP Most, ?LDAT Data)",
        |context, _| cp(context, "$vel_ma", Some(context.number(0)?)),
    ),
    ("CP SACC_CP(LDAT Data)", |context, _| {
        let share = part(context, 0, 1)?.unwrap_or(100.0) / 100.0;
        let most = setting(context, "$acc_ma", &[0])?;
        cp(context, "$acc_ma", Some(most * share))
    }),
    ("ORI_TYPE SORI_TYP(LDAT Data)", |context, _| {
        let kind = part(context, 0, 6)?.unwrap_or(1.0);
        Ok(Outcome::Done(Value::Int(kind as i64)))
    }),
    ("JERK_STRUC SJERK(LDAT Data)", |context, _| {
        Ok(Outcome::Done(variable(context, "$jerk").clone()))
    }),
    ("INT USE_CM_PRO_VALUES(INT Number)", |context, _| {
        Ok(Outcome::Done(Value::Int(context.number(0)? as i64)))
    }),
];

/// A number of a structure, if it has a value.
fn part(
    context: &CallContext<'_>,
    argument: usize,
    part: usize,
) -> Result<Option<f64>, RaisedError> {
    Ok(match context.required(argument)? {
        Value::Record(parts) => parts.get(part).and_then(Value::as_number),
        _ => None,
    })
}

fn percent(value: f64) -> Ran {
    Ok(Outcome::Done(Value::Int(value.round() as i64)))
}

/// `$APO` with the distance of the data in one of its parts.
fn apo(context: &CallContext<'_>, place: usize) -> Ran {
    let mut made = variable(context, "$apo").clone();
    if let (Value::Record(parts), Some(distance)) = (&mut made, part(context, 0, 2)?) {
        parts[place] = Value::Num(distance as f32);
    }
    Ok(Outcome::Done(made))
}

/// The most the arm can, with this along the path.
fn cp(context: &CallContext<'_>, most: &str, along: Option<f64>) -> Ran {
    let mut made = variable(context, most).clone();
    if let (Value::Record(parts), Some(along)) = (&mut made, along) {
        parts[0] = Value::Num(along as f32);
    }
    Ok(Outcome::Done(made))
}

fn load(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let number = context.number(0)?;
    Ok(Outcome::Done(numbered_load(context, number)))
}
