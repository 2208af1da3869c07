//! Questions to the operator: answered by the cabinet, or waited for.

use std::task::Poll;

use depal_vm::system::{Question, System};
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 4] = [
    (
        "PROC TPReadNum(INOUT num TPAnswer, string TPText \\num MaxTime \\signaldi DIBreak \\INOUT errnum BreakFlag)",
        read_number,
    ),
    (
        "PROC TPReadFK(INOUT num TPAnswer, string TPText, string TPFK1, string TPFK2, string TPFK3, string TPFK4, string TPFK5 \\num MaxTime \\signaldi DIBreak \\INOUT errnum BreakFlag)",
        read_key,
    ),
    (
        "PROC UIMsgBox(\\string Header, string MsgLine1 \\string MsgLine2 \\string MsgLine3 \\string MsgLine4 \\string MsgLine5 \\switch Wrap \\num Buttons \\num Icon \\string Image \\INOUT btnres Result \\num MaxTime)",
        message_box,
    ),
    (
        "FUNC num UINumEntry(\\string Header, string Message \\num Icon \\num InitValue \\num MinValue \\num MaxValue \\switch AsInteger \\num MaxTime)",
        number_entry,
    ),
];

/// The operator's answer as a number; an answer that is none stops the program with a clear message.
fn ask(
    context: &CallContext<'_>,
    system: &mut dyn System,
    instruction: &'static str,
    text: usize,
    max_time: usize,
) -> Result<Option<f64>, RaisedError> {
    let text = context.string(text)?;
    match system.answer(&Question { instruction, text }) {
        Poll::Ready(answer) => match answer.trim().parse() {
            Ok(number) => Ok(Some(number)),
            Err(_) => Err(context.argument_error(format!(
                "the answer to {instruction} is {answer:?}, expected a number"
            ))),
        },
        Poll::Pending => match context.optional_number(max_time)? {
            Some(limit) if context.elapsed(system.now()).as_secs_f64() >= limit => Err(error(
                "ERR_TP_NO_CLIENT",
                format!("nobody answered {instruction} within {limit} s"),
            )),
            _ => Ok(None),
        },
    }
}

fn read_number(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    match ask(context, system, "TPReadNum", 1, 2)? {
        None => Ok(Outcome::Blocked),
        Some(answer) => {
            context.assign_number(0, answer)?;
            Ok(Outcome::Done(Value::Absent))
        }
    }
}

fn read_key(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    match ask(context, system, "TPReadFK", 1, 7)? {
        None => Ok(Outcome::Blocked),
        Some(key) if (1.0..=5.0).contains(&key) && key.fract() == 0.0 => {
            context.assign_number(0, key)?;
            Ok(Outcome::Done(Value::Absent))
        }
        Some(key) => Err(context.argument_error(format!(
            "the answer to TPReadFK is {key}, expected a key from 1 to 5"
        ))),
    }
}

fn message_box(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    match ask(context, system, "UIMsgBox", 1, 11)? {
        None => Ok(Outcome::Blocked),
        Some(answer) => {
            if context.is_given(10) {
                context.assign_number(10, answer)?;
            }
            Ok(Outcome::Done(Value::Absent))
        }
    }
}

fn number_entry(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let Some(answer) = ask(context, system, "UINumEntry", 1, 7)? else {
        return Ok(Outcome::Blocked);
    };
    let least = context.optional_number(4)?.unwrap_or(f64::NEG_INFINITY);
    let most = context.optional_number(5)?.unwrap_or(f64::INFINITY);
    if !(least..=most).contains(&answer) {
        return Err(context.argument_error(format!(
            "the answer to UINumEntry is {answer}, expected {least} to {most}"
        )));
    }
    Ok(Outcome::Done(Value::Num(answer as f32)))
}
