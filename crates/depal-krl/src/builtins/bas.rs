//! BAS: the settings of moves, as the shipped subprogram makes them.

use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::state::{setting, variable, variable_mut};
use super::table::{Entry, Ran};

pub(super) const ENTRIES: [Entry; 1] = [("BAS(BAS_COMMAND Command, ?REAL Value)", bas)];

/// Commands, in the order of the enumeration in the predefined data.
const INITMOV: i64 = 1;
const ACC_CP: i64 = 2;
const ACC_PTP: i64 = 3;
const VEL_CP: i64 = 4;
const VEL_PTP: i64 = 5;
const TOOL: i64 = 7;
const BASE: i64 = 8;
const PTP_PARAMS: i64 = 11;
const CP_PARAMS: i64 = 12;
const PTP_DAT: i64 = 13;
const CP_DAT: i64 = 14;
const FRAMES: i64 = 15;

fn bas(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let command = context.number(0)? as i64;
    let value = context.optional_number(1)?;
    let needed = |context: &CallContext<'_>| {
        value.ok_or_else(|| context.argument_error("BAS needs a value for this command"))
    };
    match command {
        INITMOV => init(context),
        ACC_CP => {
            let value = needed(context)?;
            set_part(context, "$acc", 0, value);
        }
        VEL_CP => {
            let value = needed(context)?;
            set_part(context, "$vel", 0, value);
        }
        ACC_PTP => {
            let value = needed(context)?;
            percent(context, "$acc_axis", value)?;
        }
        VEL_PTP => {
            let value = needed(context)?;
            percent(context, "$vel_axis", value)?;
        }
        TOOL => {
            let value = needed(context)?;
            frame_of(context, "tool_data", "$tool", "$act_tool", value)?;
        }
        BASE => {
            let value = needed(context)?;
            frame_of(context, "base_data", "$base", "$act_base", value)?;
        }
        PTP_PARAMS => {
            let value = needed(context)?;
            ptp_data(context)?;
            frames(context)?;
            percent(context, "$vel_axis", value)?;
        }
        CP_PARAMS => {
            let value = needed(context)?;
            cp_data(context)?;
            frames(context)?;
            set_part(context, "$vel", 0, value);
        }
        PTP_DAT => ptp_data(context)?,
        CP_DAT => cp_data(context)?,
        FRAMES => frames(context)?,
        _ => {
            return Err(context.argument_error("this command of BAS is not simulated"));
        }
    }
    Ok(Outcome::Done(Value::Absent))
}

fn set_part(context: &mut CallContext<'_>, name: &str, part: usize, value: f64) {
    if let Value::Record(parts) | Value::Array(parts) = variable_mut(context, name)
        && let Some(place) = parts.get_mut(part)
    {
        *place = Value::Num(value as f32);
    }
}

fn percent(context: &mut CallContext<'_>, name: &str, value: f64) -> Result<(), RaisedError> {
    if !(0.0..=100.0).contains(&value) || value == 0.0 {
        return Err(context.argument_error(format!(
            "{} is set to {value} %, expected 1 to 100",
            name.to_uppercase()
        )));
    }
    if let Value::Array(items) = variable_mut(context, name) {
        for item in items.iter_mut() {
            *item = Value::Int(value.round() as i64);
        }
    }
    Ok(())
}

/// The settings that every program begins with.
fn init(context: &mut CallContext<'_>) {
    for name in ["$vel_axis", "$acc_axis"] {
        if let Value::Array(items) = variable_mut(context, name) {
            items.fill(Value::Int(100));
        }
    }
    let fastest = variable(context, "$vel_ma").clone();
    *variable_mut(context, "$vel") = fastest;
    let hardest = variable(context, "$acc_ma").clone();
    *variable_mut(context, "$acc") = hardest;
    let null = variable(context, "$nullframe").clone();
    *variable_mut(context, "$base") = null.clone();
    *variable_mut(context, "$tool") = null;
    *variable_mut(context, "$advance") = Value::Int(3);
}

/// A tool or base by its number; 0 is none.
fn frame_of(
    context: &mut CallContext<'_>,
    table: &str,
    target: &str,
    number_of: &str,
    number: f64,
) -> Result<(), RaisedError> {
    let frame = numbered_frame(context, table, number)?;
    if table == "tool_data" {
        let load = numbered_load(context, number);
        *variable_mut(context, "$load") = load;
    }
    *variable_mut(context, target) = frame;
    *variable_mut(context, number_of) = Value::Int(number.round() as i64);
    Ok(())
}

/// The load of a tool by its number; one without a value, and that of number 0, has a mass of -1: that of the cabinet.
pub(super) fn numbered_load(context: &CallContext<'_>, number: f64) -> Value {
    let of_cabinet = || {
        let mut load = variable(context, "$load").clone();
        if let Value::Record(parts) = &mut load
            && let Some(mass) = parts.first_mut()
        {
            *mass = Value::Num(-1.0);
        }
        load
    };
    let index = (number.round() as i64).checked_sub(1);
    match (variable(context, "load_data"), index.map(usize::try_from)) {
        (Value::Array(loads), Some(Ok(index))) => match loads.get(index) {
            Some(load) if !load.is_unset() => load.clone(),
            _ => of_cabinet(),
        },
        _ => of_cabinet(),
    }
}

/// A tool or base by its number; 0 is the null frame.
pub(super) fn numbered_frame(
    context: &CallContext<'_>,
    table: &str,
    number: f64,
) -> Result<Value, RaisedError> {
    let index = number.round() as i64;
    if index == 0 {
        return Ok(variable(context, "$nullframe").clone());
    }
    let Value::Array(frames) = variable(context, table) else {
        return Err(context.argument_error(format!("there is no {}", table.to_uppercase())));
    };
    let frame = usize::try_from(index - 1).ok().and_then(|i| frames.get(i));
    match frame {
        Some(frame) if frame.is_unset() => Err(context.argument_error(format!(
            "{}[{index}] has no value yet",
            table.to_uppercase()
        ))),
        Some(frame) => Ok(frame.clone()),
        None => Err(context.argument_error(format!(
            "{}[{index}] is outside 1..{}",
            table.to_uppercase(),
            frames.len()
        ))),
    }
}

fn part(context: &CallContext<'_>, name: &str, part: usize) -> Option<f64> {
    setting(context, name, &[part]).ok()
}

/// PDAT_ACT: velocity, acceleration, approximation distance.
fn ptp_data(context: &mut CallContext<'_>) -> Result<(), RaisedError> {
    if let Some(acceleration) = part(context, "pdat_act", 1) {
        percent(context, "$acc_axis", acceleration)?;
    }
    if let Some(distance) = part(context, "pdat_act", 2) {
        set_part(context, "$apo", 1, distance);
    }
    Ok(())
}

/// LDAT_ACT: velocity, acceleration in percent, approximation distance.
fn cp_data(context: &mut CallContext<'_>) -> Result<(), RaisedError> {
    if let Some(share) = part(context, "ldat_act", 1) {
        let most = setting(context, "$acc_ma", &[0])?;
        set_part(context, "$acc", 0, most * share / 100.0);
    }
    if let Some(distance) = part(context, "ldat_act", 2) {
        set_part(context, "$apo", 2, distance);
    }
    Ok(())
}

/// FDAT_ACT: tool and base by number.
fn frames(context: &mut CallContext<'_>) -> Result<(), RaisedError> {
    if let Some(tool) = part(context, "fdat_act", 0) {
        frame_of(context, "tool_data", "$tool", "$act_tool", tool)?;
    }
    if let Some(base) = part(context, "fdat_act", 1) {
        frame_of(context, "base_data", "$base", "$act_base", base)?;
    }
    Ok(())
}
