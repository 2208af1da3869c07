use depal_time::SimDuration;
use depal_vm::system::System;
use depal_vm::{BuiltinFn, CallContext, ClockState, Outcome, RaisedError, Value};

use super::table::Entry;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 5] = [
    ("PROC WaitTime(\\switch InPos, num Time)", wait_time),
    ("PROC ClkReset(INOUT clock Clock)", clk_reset),
    ("PROC ClkStart(INOUT clock Clock)", clk_start),
    ("PROC ClkStop(INOUT clock Clock)", clk_stop),
    (
        "FUNC num ClkRead(INOUT clock Clock \\switch HighRes)",
        clk_read,
    ),
];

/// Used by WaitUntil \InPos.
pub(super) const OPERATORS: [(&str, BuiltinFn); 1] = [("standing", standing)];

fn standing(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    Ok(Outcome::Done(Value::Bool(system.is_standing())))
}

/// With \InPos the time begins when the arm stands; the first note is that instant.
fn wait_time(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let seconds = context.number(1)?;
    let now = system.now();
    let start = match context.notes.first() {
        Some(Value::Int(nanos)) => depal_time::SimTime::from_nanos(*nanos as u64),
        _ if !context.is_given(0) => context.started,
        _ if system.is_standing() => {
            context.notes.push(Value::Int(now.as_nanos() as i64));
            now
        }
        _ => return Ok(Outcome::Blocked),
    };
    if now.saturating_since(start) >= SimDuration::from_secs_f64(seconds) {
        Ok(Outcome::Done(Value::Absent))
    } else {
        Ok(Outcome::Blocked)
    }
}

fn clock(context: &CallContext<'_>) -> Result<ClockState, RaisedError> {
    match context.required(0)? {
        Value::Clock(clock) => Ok(*clock),
        other => {
            Err(context.argument_error(format!("expected a clock, found {}", other.kind_name())))
        }
    }
}

fn store(context: &mut CallContext<'_>, clock: ClockState) -> Ran {
    context.assign(0, Value::Clock(clock))?;
    Ok(Outcome::Done(Value::Absent))
}

fn clk_reset(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    store(context, ClockState::default())
}

fn clk_start(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let mut clock = clock(context)?;
    clock.running_since.get_or_insert(system.now());
    store(context, clock)
}

fn clk_stop(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let clock = clock(context)?;
    let stopped = ClockState {
        running_since: None,
        accumulated: clock.elapsed(system.now()),
    };
    store(context, stopped)
}

/// Seconds, in steps of 1 ms unless \HighRes.
fn clk_read(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let seconds = clock(context)?.elapsed(system.now()).as_secs_f64();
    let seconds = if context.is_given(1) {
        seconds
    } else {
        (seconds * 1e3).floor() / 1e3
    };
    Ok(Outcome::Done(Value::Num(seconds as f32)))
}
