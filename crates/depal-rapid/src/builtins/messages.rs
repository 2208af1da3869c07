use depal_vm::system::{LogKind, System};
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::strings::display;
use super::table::Entry;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 4] = [
    (
        "PROC TPWrite(string String \\num Num | bool Bool | pos Pos | orient Orient | dnum Dnum)",
        tp_write,
    ),
    ("PROC TPErase()", tp_erase),
    (
        "PROC ErrWrite(\\switch W | switch I, string Header, string Reason \\string RL2 \\string RL3 \\string RL4)",
        err_write,
    ),
    ("PROC BookErrNo(INOUT num ErrorName)", book_err_no),
];

fn tp_write(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let mut text = context.string(0)?;
    for index in 1..=5 {
        if let Some(value) = context.value(index)? {
            text.push_str(&display(value));
        }
    }
    system.log(LogKind::Operator, context.location, &text);
    Ok(Outcome::Done(Value::Absent))
}

/// The operator's screen of the simulation is a log: there is nothing to clear.
fn tp_erase(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Done(Value::Absent))
}

fn err_write(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let level = if context.is_given(0) {
        "warning"
    } else if context.is_given(1) {
        "information"
    } else {
        "error"
    };
    let mut text = format!("{level}: {}: {}", context.string(2)?, context.string(3)?);
    for index in 4..=6 {
        if context.is_given(index) {
            text.push(' ');
            text.push_str(&context.string(index)?);
        }
    }
    system.log(LogKind::EventLog, context.location, &text);
    Ok(Outcome::Done(Value::Absent))
}

/// Numbers of the user's own errors that are not taken from 1 to 90.
fn book_err_no(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let booked = context.memory.modal.entry("booked_errors").or_insert(0.0);
    *booked += 1.0;
    let number = 10_000.0 + *booked;
    context.assign(0, Value::Num(number as f32))?;
    Ok(Outcome::Done(Value::Absent))
}
