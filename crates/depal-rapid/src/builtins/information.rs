//! What a program may ask about the cabinet it runs in. The calendar begins at 2000-01-01 00:00:00, when the
//! simulated time does: a program must give the same result on every day.

use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 12] = [
    (
        "FUNC string GetSysInfo(\\switch SerialNo | switch SWVersion | switch RobotType | switch CtrlId | switch LanIp | switch CtrlLang | switch SystemName)",
        system_info,
    ),
    (
        "FUNC string GetTaskName(\\INOUT num TaskNo | INOUT num MecTaskNo)",
        task_name,
    ),
    (
        "PROC ReadCfgData(string InstancePath, string Attribute, INOUT anytype CfgData)",
        read_configuration,
    ),
    ("FUNC string CDate()", date),
    ("FUNC string CTime()", time),
    (
        "FUNC num GetTime(\\switch WDay | switch Hour | switch Min | switch Sec)",
        get_time,
    ),
    ("FUNC bool RobOS()", robot_system),
    ("FUNC num OpMode()", operating_mode),
    ("FUNC num RunMode(\\switch Main)", run_mode),
    ("PROC SkipWarn()", nothing),
    ("FUNC bool TaskRunRob()", moves_robot),
    ("FUNC bool TaskRunMec()", moves_robot),
];

fn text(text: impl Into<String>) -> Ran {
    Ok(Outcome::Done(Value::Str(text.into())))
}

fn num(value: f64) -> Ran {
    Ok(Outcome::Done(Value::Num(value as f32)))
}

fn system_info(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    const ANSWERS: [&str; 7] = [
        "00-00000",
        "6.15.0",
        "simulated",
        "depal",
        "127.0.0.1",
        "en",
        "depal",
    ];
    let given = (0..ANSWERS.len()).find(|index| context.is_given(*index));
    match given {
        Some(index) => text(ANSWERS[index]),
        None => Err(context
            .argument_error("GetSysInfo needs one of its switches, as in GetSysInfo(\\SWVersion)")),
    }
}

fn task_name(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    for index in [0, 1] {
        if context.is_given(index) {
            context.assign_number(index, system.task_number() as f64)?;
        }
    }
    text(context.location.task.clone())
}

/// The value takes the type of the variable: a number, TRUE or FALSE, or any text.
fn read_configuration(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let path = context.string(0)?;
    let attribute = context.string(1)?;
    let parts: Vec<&str> = path.trim_start_matches('/').splitn(3, '/').collect();
    let found = <[&str; 3]>::try_from(parts)
        .ok()
        .and_then(|instance| system.configuration(instance, &attribute));
    let Some(found) = found else {
        return Err(error(
            "ERR_CFG_NOTFND",
            format!(
                "the configuration has no attribute {attribute} of {path}; expected /DOMAIN/TYPE/name of a .cfg file \
                 that was loaded"
            ),
        ));
    };
    let wrong = |expected: &str| {
        error(
            "ERR_CFG_ILLTYPE",
            format!("{attribute} of {path} is {found:?}, expected {expected}"),
        )
    };
    let value = match context.required(2)? {
        Value::Num(_) => Value::Num(found.parse().map_err(|_| wrong("a number"))?),
        Value::Dnum(_) => Value::Dnum(found.parse().map_err(|_| wrong("a number"))?),
        // A flag stands without a value.
        Value::Bool(_) => match found.to_ascii_uppercase().as_str() {
            "TRUE" | "" => Value::Bool(true),
            "FALSE" => Value::Bool(false),
            _ => return Err(wrong("TRUE or FALSE")),
        },
        _ => Value::Str(found),
    };
    context.assign(2, value)?;
    Ok(Outcome::Done(Value::Absent))
}

/// Days since the calendar's beginning, and seconds of the day.
fn calendar(system: &dyn System) -> (u64, u64) {
    let seconds = system.now().as_nanos() / 1_000_000_000;
    (seconds / 86_400, seconds % 86_400)
}

fn date(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let (mut day, _) = calendar(system);
    let mut year = 2000;
    let leap = |year: u64| {
        year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
    };
    while day >= 365 + u64::from(leap(year)) {
        day -= 365 + u64::from(leap(year));
        year += 1;
    }
    let february = 28 + u64::from(leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if day < length {
            break;
        }
        day -= length;
        month += 1;
    }
    text(format!("{year}-{month:02}-{:02}", day + 1))
}

fn time(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let (_, second) = calendar(system);
    text(format!(
        "{:02}:{:02}:{:02}",
        second / 3600,
        second / 60 % 60,
        second % 60
    ))
}

/// The first day was a Saturday; weeks begin with Monday as 1.
fn get_time(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let (day, second) = calendar(system);
    let given = (0..4).find(|index| context.is_given(*index));
    match given {
        Some(0) => num(((day + 5) % 7 + 1) as f64),
        Some(1) => num((second / 3600) as f64),
        Some(2) => num((second / 60 % 60) as f64),
        Some(_) => num((second % 60) as f64),
        None => {
            Err(context.argument_error("GetTime needs one of its switches, as in GetTime(\\Hour)"))
        }
    }
}

/// TRUE: programs skip their signals and sockets where it is FALSE, and here they are simulated.
fn robot_system(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Done(Value::Bool(true)))
}

/// OP_AUTO.
fn operating_mode(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    num(1.0)
}

/// RUN_CONT_CYCLE.
fn run_mode(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    num(1.0)
}

fn moves_robot(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    Ok(Outcome::Done(Value::Bool(system.task_moves_arm())))
}

/// The event log has no pending warning that could be skipped.
fn nothing(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Done(Value::Absent))
}
