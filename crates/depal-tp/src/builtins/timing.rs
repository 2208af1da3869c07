//! Waits and timers.

use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::registers::system_variable;
use super::{Entry, Ran, answer, done, number};
use crate::errors::interpreter;
use crate::state;

pub(super) const ENTRIES: [Entry; 7] = [
    ("wait", wait),
    ("timed out", timed_out),
    ("timer get", timer_get),
    ("timer set", timer_set),
    ("timer start", timer_start),
    ("timer stop", timer_stop),
    ("timer reset", timer_reset),
];

fn wait(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let seconds = number(context, 0)?;
    if !(0.0..=1e6).contains(&seconds) {
        return Err(interpreter(format!("Invalid value: WAIT {seconds} s")));
    }
    if context.elapsed(system.now()).as_secs_f64() + 1e-9 >= seconds {
        done()
    } else {
        Ok(Outcome::Blocked)
    }
}

/// Whether a wait has lasted longer than `$WAITTMOUT` hundredths of a second.
fn timed_out(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let elapsed = number(context, 0)?;
    let limit = system_variable(context.memory, "$WAITTMOUT");
    let limit = limit.and_then(|v| v.as_number()).unwrap_or(3000.0) / 100.0;
    answer(Value::Bool(elapsed + 1e-9 >= limit))
}

/// Whether it runs, its seconds when it was last touched, and when that was.
fn timer(context: &CallContext<'_>) -> Result<(usize, bool, f64, i64), RaisedError> {
    let place = state::place(context.memory, state::TIMER, "TIMER", number(context, 0)?)?;
    let state = match &state::items(context.memory, state::TIMER)[place] {
        Value::Record(fields) => match fields.as_slice() {
            [Value::Bool(runs), Value::Dnum(base), Value::Int(since)] => (*runs, *base, *since),
            _ => (false, 0.0, 0),
        },
        _ => (false, 0.0, 0),
    };
    Ok((place, state.0, state.1, state.2))
}

fn seconds(context: &CallContext<'_>, system: &dyn System) -> Result<f64, RaisedError> {
    let (_, runs, base, since) = timer(context)?;
    let passed = system.now().as_nanos() as i64 - since;
    Ok(if runs {
        base + passed as f64 * 1e-9
    } else {
        base
    })
}

fn touch(context: &mut CallContext<'_>, system: &dyn System, runs: bool, base: f64) -> Ran {
    let (place, ..) = timer(context)?;
    let now = system.now().as_nanos() as i64;
    if let Some(items) = state::items_mut(context.memory, state::TIMER) {
        items[place] = Value::Record(vec![Value::Bool(runs), Value::Dnum(base), Value::Int(now)]);
    }
    done()
}

fn timer_get(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    answer(Value::Dnum(seconds(context, system)?))
}

/// It goes on running, or standing, from the value.
fn timer_set(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let value = number(context, 1)?;
    let (_, runs, ..) = timer(context)?;
    touch(context, system, runs, value)
}

fn timer_start(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let value = seconds(context, system)?;
    touch(context, system, true, value)
}

fn timer_stop(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let value = seconds(context, system)?;
    touch(context, system, false, value)
}

fn timer_reset(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let (_, runs, ..) = timer(context)?;
    touch(context, system, runs, 0.0)
}
