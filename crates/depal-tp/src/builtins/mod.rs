//! The instructions that the machine calls.

mod control;
mod goal;
mod motion;
mod operators;
mod positions;
mod registers;
mod signals;
mod timing;

pub(crate) use signals::set_output;

use depal_vm::{Builtin, BuiltinFn, CallContext, Outcome, RaisedError, Value};

pub(crate) type Ran = Result<Outcome, RaisedError>;

/// A row of the table: name and code.
pub(crate) type Entry = (&'static str, BuiltinFn);

pub(crate) fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}

pub(crate) fn answer(value: Value) -> Ran {
    Ok(Outcome::Done(value))
}

/// All of them; the lowering finds them by name.
pub(crate) fn table() -> Vec<Builtin> {
    let groups: [&[Entry]; 8] = [
        &registers::ENTRIES,
        &positions::ENTRIES,
        &operators::ENTRIES,
        &signals::ENTRIES,
        &timing::ENTRIES,
        &motion::ENTRIES,
        &control::ENTRIES,
        crate::mm::ENTRIES,
    ];
    let row = |(name, run): &Entry| Builtin { name, run: *run };
    groups.into_iter().flatten().map(row).collect()
}

/// Names of the vision calls that need no listing.
pub fn built_in_names() -> Vec<&'static str> {
    crate::mm::CALLS.iter().map(|call| call.name).collect()
}

/// An argument that the lowering always gives: an index or an amount.
pub(crate) fn number(context: &CallContext<'_>, index: usize) -> Result<f64, RaisedError> {
    match context.value(index)? {
        Some(Value::Bool(value)) => Ok(f64::from(u8::from(*value))),
        Some(value) => value.as_number().ok_or_else(|| {
            crate::errors::mismatch(format!("expected a number, found {}", value.kind_name()))
        }),
        None => Err(crate::errors::uninitialized("an argument")),
    }
}
