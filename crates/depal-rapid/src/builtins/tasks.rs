//! Tasks that wait for each other.

use std::task::Poll;

use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 5] = [
    (
        "PROC WaitSyncTask(\\switch InPos, VAR syncident SyncID, PERS tasks TaskList{*} \\num TimeOut)",
        wait_sync_task,
    ),
    (
        "PROC SyncMoveOn(VAR syncident SyncID, PERS tasks TaskList{*} \\num TimeOut)",
        sync_move_on,
    ),
    (
        "PROC SyncMoveOff(VAR syncident SyncID \\num TimeOut)",
        sync_move_off,
    ),
    ("PROC SyncMoveUndo()", sync_move_undo),
    ("FUNC bool IsSyncMoveOn()", is_sync_move_on),
];

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

/// The tasks in the list of an argument.
fn names(context: &CallContext<'_>, index: usize) -> Result<Vec<String>, RaisedError> {
    let Value::Array(items) = context.required(index)? else {
        return Err(context.argument_error("the task list is an array of tasks"));
    };
    let names: Option<Vec<_>> = items.iter().map(only_text).collect();
    names
        .ok_or_else(|| context.argument_error("a task in the list has no name, as in [\"T_ROB1\"]"))
}

/// Waits until every task of the list is at the point of this name.
fn wait_sync_task(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if context.is_given(0) && !system.is_standing() {
        return Ok(Outcome::Blocked);
    }
    let names = names(context, 2)?;
    gather(context, system, (1, 3), &names, "ERR_WAITSYNCTASK")
}

/// Waits until all tasks are at the point of an argument, at most as long as another one says; then another error.
fn gather(
    context: &CallContext<'_>,
    system: &mut dyn System,
    (point, limit): (usize, usize),
    names: &[String],
    late: &str,
) -> Ran {
    let Some(point) = only_text(context.required(point)?) else {
        return Err(context.argument_error(
            "the syncident must be declared in a module: its name is the meeting point",
        ));
    };
    match system.meet(&point, names) {
        Poll::Ready(Ok(())) => Ok(Outcome::Done(Value::Absent)),
        Poll::Ready(Err(fault)) => Err(context.system_fault(fault)),
        Poll::Pending => {
            if let Some(limit) = context.optional_number(limit)?
                && context.elapsed(system.now()).as_secs_f64() >= limit
            {
                system.leave_meeting(&point);
                return Err(error(
                    late,
                    format!("not all tasks came to {point} within {limit} s"),
                ));
            }
            Ok(Outcome::Blocked)
        }
    }
}

/// From here to SyncMoveOff the tasks of the list move in step: they meet at both ends, with the arm at rest. The cabinet
/// has one arm, so between the two only one of them moves.
fn sync_move_on(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if !context.memory.partners.is_empty() {
        return Err(error(
            "ERR_SYNCMOVEON",
            "the task moves in step already; end that with SyncMoveOff first",
        ));
    }
    if !rests(system) {
        return Ok(Outcome::Blocked);
    }
    let names = names(context, 1)?;
    let met = gather(context, system, (0, 2), &names, "ERR_SYNCMOVEON")?;
    if met != Outcome::Blocked {
        context.memory.partners = names;
    }
    Ok(met)
}

fn sync_move_off(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if context.memory.partners.is_empty() {
        return Err(error(
            "ERR_SYNCMOVEOFF",
            "the task does not move in step; begin that with SyncMoveOn first",
        ));
    }
    if !rests(system) {
        return Ok(Outcome::Blocked);
    }
    let names = context.memory.partners.clone();
    let met = gather(context, system, (0, 1), &names, "ERR_SYNCMOVEOFF")?;
    if met != Outcome::Blocked {
        context.memory.partners.clear();
    }
    Ok(met)
}

/// Whether the arm stands, for the task that moves it.
fn rests(system: &dyn System) -> bool {
    !system.task_moves_arm() || system.is_standing()
}

/// Ends moving in step in this task, without waiting for the others.
fn sync_move_undo(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    context.memory.partners.clear();
    Ok(Outcome::Done(Value::Absent))
}

fn is_sync_move_on(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let on = !context.memory.partners.is_empty();
    Ok(Outcome::Done(Value::Bool(on)))
}
