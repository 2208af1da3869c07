use std::task::Poll;

use depal_vm::system::{LogKind, Question, System};
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::bytes::any_value;
use super::strings::text;
use super::swrite::plain;
use super::table::{Entry, Ran};

/// Messages go to the event log. `%1` to `%3` stand for the values behind the text.
/// An acknowledgement message is acknowledged at once.
pub(super) const ENTRIES: [Entry; 4] = [
    ("!MsgNotify(CHAR[] Text, ...)", |context, system| {
        say(context, system, "")
    }),
    ("!MsgQuit(CHAR[] Text, ...)", |context, system| {
        say(context, system, "")
    }),
    ("!BOOL MsgLoop(CHAR[] Text, ...)", |context, system| {
        say(context, system, "")?;
        Ok(Outcome::Done(Value::Bool(true)))
    }),
    ("!MsgDialog(INT Answer:OUT, CHAR[] Text, ...)", dialog),
];

fn message(context: &CallContext<'_>, argument: usize) -> Result<String, RaisedError> {
    let mut message = text(context, argument)?;
    // A text as the second one names the module that speaks, if there are values behind it.
    let is_text = |at| any_value(context, at).is_ok_and(|(kind, _)| kind.starts_with("CHAR["));
    let named = context.is_given(argument + 2) && is_text(argument + 1);
    for place in 1..=3 {
        let at = argument + place + usize::from(named);
        if context.is_given(at) {
            let (kind, value) = any_value(context, at)?;
            message = message.replace(&format!("%{place}"), &plain(&kind, &value));
        }
    }
    Ok(message)
}

fn say(context: &CallContext<'_>, system: &mut dyn System, before: &str) -> Ran {
    let text = format!("{before}{}", message(context, 0)?);
    system.log(LogKind::EventLog, context.location, &text);
    Ok(Outcome::Done(Value::Absent))
}

/// Waits for the operator: the number of the key, from 1.
fn dialog(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let text = message(context, 1)?;
    if context.notes.is_empty() {
        context.notes.push(Value::Bool(true));
        system.log(LogKind::EventLog, context.location, &text);
    }
    let question = Question {
        instruction: "MsgDialog",
        text,
    };
    match system.answer(&question) {
        Poll::Pending => Ok(Outcome::Blocked),
        Poll::Ready(answer) => match answer.trim().parse::<i32>() {
            Ok(key) => {
                context.assign(0, Value::Int(i64::from(key)))?;
                Ok(Outcome::Done(Value::Absent))
            }
            Err(_) => Err(context.argument_error(format!(
                "the answer to MsgDialog is the number of a key, found {answer:?}"
            ))),
        },
    }
}
