//! Tasks that wait for each other.

use std::task::Poll;

use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 1] = [(
    "PROC WaitSyncTask(\\switch InPos, VAR syncident SyncID, PERS tasks TaskList{*} \\num TimeOut)",
    wait_sync_task,
)];

/// The text of a record of one.
fn only_text(value: &Value) -> Option<String> {
    match value {
        Value::Record(fields) => match fields.as_slice() {
            [Value::Str(text)] if !text.is_empty() => Some(text.clone()),
            _ => None,
        },
        _ => None,
    }
}

fn names(context: &CallContext<'_>) -> Result<Vec<String>, RaisedError> {
    let Value::Array(items) = context.required(2)? else {
        return Err(context.argument_error("the task list of WaitSyncTask is an array of tasks"));
    };
    let names: Option<Vec<_>> = items.iter().map(only_text).collect();
    names.ok_or_else(|| {
        context.argument_error("a task in the list of WaitSyncTask has no name, as in [\"T_ROB1\"]")
    })
}

/// Waits until every task of the list is at the point of this name.
fn wait_sync_task(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if context.is_given(0) && !system.is_standing() {
        return Ok(Outcome::Blocked);
    }
    let Some(point) = only_text(context.required(1)?) else {
        return Err(context.argument_error(
            "the syncident of WaitSyncTask must be declared in a module: its name is the meeting point",
        ));
    };
    let names = names(context)?;
    match system.meet(&point, &names) {
        Poll::Ready(Ok(())) => Ok(Outcome::Done(Value::Absent)),
        Poll::Ready(Err(fault)) => Err(context.system_fault(fault)),
        Poll::Pending => {
            if let Some(limit) = context.optional_number(3)?
                && context.elapsed(system.now()).as_secs_f64() >= limit
            {
                system.leave_meeting(&point);
                return Err(error(
                    "ERR_WAITSYNCTASK",
                    format!("not all tasks came to {point} within {limit} s"),
                ));
            }
            Ok(Outcome::Blocked)
        }
    }
}
