//! Messages that a program puts into the event log, errors that it raises with them, and the interrupts that they
//! order.
//!
//! Numbers of messages have their domain in front (110000 and up: processes, 80000 and up: the user) as on a
//! controller; ErrWrite makes 80001 to 80003, ErrLog and ErrRaise what they are given. The texts of the numbers are
//! not here: a message is its number and its arguments.

use depal_vm::system::{LogKind, System};
use depal_vm::{CallContext, Outcome, RaisedError, Report, ReportFilter, Trigger, Value};

use super::interrupts::order;
use super::records::{num, number, part};
use super::table::Entry;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 7] = [
    (
        "PROC ErrWrite(\\switch W | switch I, string Header, string Reason \\string RL2 \\string RL3 \\string RL4)",
        err_write,
    ),
    (
        "PROC ErrLog(num ErrorId \\switch W | switch I, errstr Argument1, errstr Argument2, errstr Argument3, errstr Argument4, errstr Argument5)",
        err_log,
    ),
    (
        "PROC ErrRaise(string ErrorName, num ErrorId, errstr Argument1, errstr Argument2, errstr Argument3, errstr Argument4, errstr Argument5)",
        err_raise,
    ),
    ("PROC BookErrNo(INOUT num ErrorName)", book_err_no),
    (
        "PROC IError(\\switch Single | switch SingleSafe, errdomain ErrorDomain \\num ErrorId, errtype ErrorType, INOUT intnum Interrupt)",
        interrupt_on_message,
    ),
    ("PROC GetTrapData(VAR trapdata TrapEvent)", get_trap_data),
    (
        "PROC ReadErrData(VAR trapdata TrapEvent, INOUT errdomain ErrorDomain, INOUT num ErrorId, INOUT errtype ErrorType \\INOUT string Title \\INOUT string Str1 \\INOUT string Str2 \\INOUT string Str3 \\INOUT string Str4 \\INOUT string Str5)",
        read_err_data,
    ),
];

const USER: u32 = 8;
const PROCESS: u32 = 11;

const INFORMATION: u32 = 1;
const WARNING: u32 = 2;
const ERROR: u32 = 3;

fn severity(context: &CallContext<'_>, warning: usize) -> u32 {
    if context.is_given(warning) {
        WARNING
    } else if context.is_given(warning + 1) {
        INFORMATION
    } else {
        ERROR
    }
}

fn severity_name(severity: u32) -> &'static str {
    match severity {
        INFORMATION => "information",
        WARNING => "warning",
        _ => "error",
    }
}

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}

fn err_write(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let severity = severity(context, 0);
    let title = context.string(2)?;
    let mut texts = vec![context.string(3)?];
    for index in 4..=6 {
        if context.is_given(index) {
            texts.push(context.string(index)?);
        }
    }
    let text = format!("{}: {title}: {}", severity_name(severity), texts.join(" "));
    system.log(LogKind::EventLog, context.location, &text);
    context.memory.report(&Report {
        domain: USER,
        // 80001 is an error, 80002 a warning, 80003 an information.
        number: 4 - severity,
        severity,
        title,
        texts,
    });
    done()
}

/// Five arguments, with the marks of the task and of the place filled in.
fn texts(context: &CallContext<'_>, first: usize) -> Result<Vec<String>, RaisedError> {
    let mut texts = Vec::new();
    for index in first..first + 5 {
        texts.push(match context.string(index)?.as_str() {
            "\u{1}" => context.location.task.clone(),
            "\u{2}" => {
                let place = context.location;
                format!("{}/{}/{}", place.module, place.routine, place.line)
            }
            text => text.to_owned(),
        });
    }
    Ok(texts)
}

/// A message of the process domain, as the event log shows it.
fn process_message(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    (identity, severity): (f64, u32),
    texts: Vec<String>,
) -> Result<String, RaisedError> {
    if !(4800.0..=9999.0).contains(&identity) || identity.fract() != 0.0 {
        return Err(context.argument_error(format!(
            "the number of the message is {identity}, expected 4800 to 4814 or 5000 to 9999"
        )));
    }
    let shown: Vec<_> = texts.iter().filter(|t| !t.is_empty()).cloned().collect();
    let shown = shown.join(" ");
    let text = format!(
        "{}: {PROCESS}{identity:04}: {shown}",
        severity_name(severity)
    );
    system.log(LogKind::EventLog, context.location, &text);
    context.memory.report(&Report {
        domain: PROCESS,
        number: identity as u32,
        severity,
        title: String::new(),
        texts,
    });
    Ok(shown)
}

fn err_log(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let texts = texts(context, 3)?;
    let message = (context.number(0)?, severity(context, 1));
    process_message(context, system, message, texts)?;
    done()
}

/// Raises the error whose number the named variable was given by BookErrNo. The message is a warning; inside an
/// error clause the error goes to the caller, as with RAISE.
fn err_raise(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let name = context.string(0)?;
    let identity = context.number(1)?;
    let texts = texts(context, 2)?;
    let slot = context
        .program
        .visible_datum(&name, &context.location.module);
    let value = slot.and_then(|slot| context.memory.globals.get(slot));
    let Some(number) = value.and_then(Value::as_number) else {
        return Err(context.argument_error(format!(
            "there is no module data {name} of type errnum to raise an error with"
        )));
    };
    if number <= 0.0 {
        return Err(context.argument_error(format!(
            "the error {name} has the number {number}; book one first with BookErrNo {name}"
        )));
    }
    let shown = process_message(context, system, (identity, WARNING), texts)?;
    Ok(Outcome::Raise(RaisedError {
        number: number as i64,
        message: format!("raised by the program: {PROCESS}{identity:04}: {shown}"),
        name,
    }))
}

/// Numbers of the user's own errors that are not taken from 1 to 90.
fn book_err_no(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let booked = context.memory.modal.entry("booked_errors").or_insert(0.0);
    *booked += 1.0;
    let number = 10_000.0 + *booked;
    context.assign(0, Value::Num(number as f32))?;
    done()
}

/// Orders an interrupt by the messages that this task itself puts into the event log.
fn interrupt_on_message(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let once = context.is_given(0) || context.is_given(1);
    let whole = |value: f64| (value != 0.0).then_some(value as u32);
    let filter = ReportFilter {
        domain: whole(context.number(2)?),
        number: context.optional_number(3)?.map(|number| number as u32),
        severity: whole(context.number(4)?),
    };
    if filter.number.is_some() && filter.domain.is_none() {
        return Err(context.argument_error(
            "a number of a message belongs to a domain; COMMON_ERR with \\ErrorId names none",
        ));
    }
    order(context, 5, once, Trigger::Report(filter))
}

fn get_trap_data(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let Some(report) = context.memory.served_report() else {
        return Err(context.argument_error(
            "GetTrapData has its place in the TRAP of an interrupt that IError ordered",
        ));
    };
    let texts = (0..5).map(|i| report.texts.get(i).cloned().unwrap_or_default());
    let mut fields = vec![
        Value::Bool(true),
        num(f64::from(report.domain)),
        num(f64::from(report.number)),
        num(f64::from(report.severity)),
        Value::Str(report.title.clone()),
    ];
    fields.extend(texts.map(Value::Str));
    context.assign(0, Value::Record(fields))?;
    done()
}

fn read_err_data(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let data = context.required(0)?.clone();
    if part(&data, 0) != &Value::Bool(true) {
        return Err(context.argument_error(
            "the trapdata holds nothing; take it down with GetTrapData in the TRAP first",
        ));
    }
    for index in 1..=3 {
        context.assign_number(index, number(&data, index))?;
    }
    for index in 4..=9 {
        if context.is_given(index) {
            context.assign(index, part(&data, index).clone())?;
        }
    }
    done()
}
