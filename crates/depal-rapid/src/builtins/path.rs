//! Stopping, holding and putting aside the motion; waiting for the arm; the ends of a program.

use std::task::Poll;

use depal_vm::system::{Fault, System};
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::table::Entry;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 9] = [
    (
        "PROC StopMove(\\switch Quick \\switch AllMotionTasks)",
        stop_move,
    ),
    ("PROC StartMove(\\switch AllMotionTasks)", start_move),
    (
        "PROC StopMoveReset(\\switch AllMotionTasks)",
        stop_move_reset,
    ),
    ("PROC ClearPath()", clear_path),
    ("PROC StorePath(\\switch KeepSync)", store_path),
    ("PROC RestoPath()", resto_path),
    ("PROC WaitRob(\\switch InPos | switch ZeroSpeed)", wait_rob),
    ("PROC Stop(\\switch NoRegain | switch AllMoveTasks)", stop),
    ("PROC ExitCycle()", exit_cycle),
];

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}

fn answer(context: &CallContext<'_>, answer: Poll<Result<(), Fault>>) -> Ran {
    match answer {
        Poll::Pending => Ok(Outcome::Blocked),
        Poll::Ready(Ok(())) => done(),
        Poll::Ready(Err(fault)) => Err(context.system_fault(fault)),
    }
}

/// The arm brakes on its path; the program goes on when it stands. \\Quick brakes as hard: it is always so.
fn stop_move(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let held = system.hold_motion();
    answer(context, held)
}

fn start_move(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let resumed = system.resume_motion();
    answer(context, Poll::Ready(resumed))
}

/// The stop is over and nothing starts: the path that was held is dropped.
fn stop_move_reset(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let cleared = system.clear_path().and_then(|()| system.resume_motion());
    answer(context, Poll::Ready(cleared))
}

fn clear_path(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let cleared = system.clear_path();
    answer(context, Poll::Ready(cleared))
}

fn store_path(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if context.is_given(0) {
        return Err(context.argument_error("StorePath \\KeepSync needs a second robot"));
    }
    let stored = system.store_path();
    answer(context, stored)
}

/// Waits until the moves on the way back are over.
fn resto_path(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if !system.is_standing() {
        return Ok(Outcome::Blocked);
    }
    let restored = system.restore_path();
    answer(context, Poll::Ready(restored))
}

fn wait_rob(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if system.is_standing() {
        done()
    } else {
        Ok(Outcome::Blocked)
    }
}

/// The moves that are queued end first, as at a stop point.
fn stop(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if system.is_standing() {
        Ok(Outcome::Stop("Stop".into()))
    } else {
        Ok(Outcome::Blocked)
    }
}

fn exit_cycle(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Restart)
}
