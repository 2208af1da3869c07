use depal_time::{SimDuration, SimTime};
use depal_vm::system::System;
use depal_vm::{CallContext, MachineFault, Outcome, RaisedError, Value};

use super::state::TIMERS;
use super::table::{Operator, Ran};

pub(super) const OPERATORS: [Operator; 8] = [
    ("wait sec", wait_sec),
    ("read timer", read_timer),
    ("write timer", write_timer),
    ("read timer stop", read_stop),
    ("write timer stop", write_stop),
    ("read timer flag", read_flag),
    ("standing", standing),
    ("milliseconds", milliseconds),
];

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}

fn wait_sec(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let seconds = context.number(0)?;
    if seconds.is_nan() {
        return Err(context.argument_error("WAIT SEC takes seconds, found no number"));
    }
    let wanted = SimDuration::from_secs_f64(seconds.clamp(0.0, 1e9));
    if context.elapsed(system.now()) >= wanted {
        done()
    } else {
        Ok(Outcome::Blocked)
    }
}

fn standing(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    Ok(Outcome::Done(Value::Bool(system.is_standing())))
}

fn milliseconds(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let milliseconds = system.now().as_nanos() / 1_000_000;
    let shown = milliseconds % (1 << 31);
    Ok(Outcome::Done(Value::Int(shown as i64)))
}

/// What a timer showed when it was stopped or set, milliseconds, and since when it runs.
#[derive(Debug, Clone, Copy)]
struct Timer {
    milliseconds: i64,
    since: Option<SimTime>,
}

impl Timer {
    fn shown(self, now: SimTime) -> i64 {
        let run = self.since.map_or(0, |since| {
            (now.saturating_since(since).as_nanos() / 1_000_000) as i64
        });
        (self.milliseconds + run).min(i64::from(i32::MAX))
    }
}

fn place(context: &CallContext<'_>) -> Result<usize, RaisedError> {
    let number = context.number(0)?;
    let Value::Array(timers) = &context.memory.globals[TIMERS] else {
        unreachable!("the hidden variables keep their kinds");
    };
    let size = timers.len();
    if (1.0..=size as f64).contains(&number) {
        return Ok(number as usize - 1);
    }
    Err(context.raise(&MachineFault::IndexOutOfRange {
        index: number,
        size,
        dimension: 1,
    }))
}

fn timer(context: &CallContext<'_>) -> Result<Timer, RaisedError> {
    let place = place(context)?;
    if let Value::Array(timers) = &context.memory.globals[TIMERS]
        && let Some(Value::Record(parts)) = timers.get(place)
        && let [Value::Int(milliseconds), Value::Int(since)] = parts.as_slice()
    {
        return Ok(Timer {
            milliseconds: *milliseconds,
            since: u64::try_from(*since).ok().map(SimTime::from_nanos),
        });
    }
    unreachable!("the hidden variables keep their kinds")
}

fn set_timer(context: &mut CallContext<'_>, timer: Timer) -> Ran {
    let place = place(context)?;
    let since = timer.since.map_or(-1, |since| since.as_nanos() as i64);
    if let Value::Array(timers) = &mut context.memory.globals[TIMERS] {
        timers[place] = Value::Record(vec![Value::Int(timer.milliseconds), Value::Int(since)]);
    }
    done()
}

fn read_timer(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let shown = timer(context)?.shown(system.now());
    Ok(Outcome::Done(Value::Int(shown)))
}

fn write_timer(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let before = timer(context)?;
    let milliseconds = context.number(1)? as i64;
    let since = before.since.map(|_| system.now());
    set_timer(
        context,
        Timer {
            milliseconds,
            since,
        },
    )
}

fn read_stop(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let stands = timer(context)?.since.is_none();
    Ok(Outcome::Done(Value::Bool(stands)))
}

fn write_stop(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let before = timer(context)?;
    let stop = *context.required(1)? == Value::Bool(true);
    let now = system.now();
    match (stop, before.since) {
        (true, Some(_)) => set_timer(
            context,
            Timer {
                milliseconds: before.shown(now),
                since: None,
            },
        ),
        (false, None) => set_timer(
            context,
            Timer {
                since: Some(now),
                ..before
            },
        ),
        _ => done(),
    }
}

/// TRUE once the timer has passed zero.
fn read_flag(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let passed = timer(context)?.shown(system.now()) > 0;
    Ok(Outcome::Done(Value::Bool(passed)))
}
