use depal_vm::system::{LogKind, System};
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::strings::display;
use super::table::Entry;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 2] = [
    (
        "PROC TPWrite(string String \\num Num | bool Bool | pos Pos | orient Orient | dnum Dnum)",
        tp_write,
    ),
    ("PROC TPErase()", tp_erase),
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
