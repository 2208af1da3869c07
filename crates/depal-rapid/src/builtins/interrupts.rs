use depal_time::SimDuration;
use depal_vm::system::System;
use depal_vm::{CallContext, Interrupt, Level, Outcome, RaisedError, Trigger, Value};

use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 13] = [
    (
        "PROC ISignalDI(\\switch Single | switch SingleSafe, signaldi Signal, num TriggValue, INOUT intnum Interrupt)",
        signal,
    ),
    (
        "PROC ISignalDO(\\switch Single | switch SingleSafe, signaldo Signal, num TriggValue, INOUT intnum Interrupt)",
        signal,
    ),
    (
        "PROC ISignalGI(\\switch Single | switch SingleSafe, signalgi Signal, INOUT intnum Interrupt)",
        group,
    ),
    (
        "PROC ISignalGO(\\switch Single | switch SingleSafe, signalgo Signal, INOUT intnum Interrupt)",
        group,
    ),
    (
        "PROC ISignalAI(\\switch Single | switch SingleSafe, signalai Signal, num Condition, num HighValue, num LowValue, num DeltaValue \\switch DPos | switch DNeg, INOUT intnum Interrupt)",
        analog,
    ),
    (
        "PROC ISignalAO(\\switch Single | switch SingleSafe, signalao Signal, num Condition, num HighValue, num LowValue, num DeltaValue \\switch DPos | switch DNeg, INOUT intnum Interrupt)",
        analog,
    ),
    (
        "PROC ITimer(\\switch Single | switch SingleSafe, num Time, INOUT intnum Interrupt)",
        timer,
    ),
    (
        "PROC IPers(INOUT anytype Name, INOUT intnum Interrupt)",
        change,
    ),
    ("PROC IDelete(INOUT intnum Interrupt)", delete),
    ("PROC ISleep(INOUT intnum Interrupt)", sleep),
    ("PROC IWatch(INOUT intnum Interrupt)", watch),
    ("PROC IDisable()", disable),
    ("PROC IEnable()", enable),
];

/// Shortest time between two timer interrupts, s.
const SHORTEST_PERIOD: f64 = 0.01;

fn number(context: &CallContext<'_>, argument: usize) -> Result<u32, RaisedError> {
    Ok(context.number(argument)? as u32)
}

/// The connected interrupt of an argument.
fn interrupt<'a>(
    context: &'a mut CallContext<'_>,
    argument: usize,
) -> Result<&'a mut Interrupt, RaisedError> {
    let number = number(context, argument)?;
    context.memory.interrupts.find(number).ok_or_else(|| {
        error(
            "ERR_UNKINO",
            "the interrupt is not connected; write CONNECT .. WITH .. first",
        )
    })
}

pub(super) fn order(
    context: &mut CallContext<'_>,
    argument: usize,
    once: bool,
    trigger: Trigger,
) -> Ran {
    let interrupt = interrupt(context, argument)?;
    if !matches!(interrupt.trigger, Trigger::None) {
        return Err(context.argument_error(
            "the interrupt is ordered already; delete it with IDelete and connect it again",
        ));
    }
    interrupt.trigger = trigger;
    interrupt.once = once;
    done()
}

fn value_of(
    context: &CallContext<'_>,
    system: &dyn System,
    name: &str,
) -> Result<f64, RaisedError> {
    system
        .signal(name)
        .map_err(|fault| context.system_fault(fault))
}

fn is_single(context: &CallContext<'_>) -> bool {
    context.is_given(0) || context.is_given(1)
}

/// The trigger value 2 (`edge`) means both edges.
fn signal(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let name = context.signal(2)?;
    let last = value_of(context, system, &name)?;
    let wanted = Some(context.number(3)?).filter(|wanted| *wanted != 2.0);
    let once = is_single(context);
    order(context, 4, once, Trigger::Signal { name, wanted, last })
}

fn group(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let name = context.signal(2)?;
    let last = value_of(context, system, &name)?;
    let once = is_single(context);
    let wanted = None;
    order(context, 3, once, Trigger::Signal { name, wanted, last })
}

/// The value is compared with that of the last interrupt, the first one with that when it was ordered.
fn analog(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let name = context.signal(2)?;
    let last = value_of(context, system, &name)?;
    let (condition, high, low) = (context.number(3)?, context.number(4)?, context.number(5)?);
    let step = context.number(6)?;
    if low > high || step < 0.0 {
        return Err(context.argument_error(format!(
            "the high value {high} must not be below the low value {low}, nor the delta {step} below 0"
        )));
    }
    let wanted = match condition as i32 {
        1 => Level::Above(high),
        2 => Level::Below(high),
        3 => Level::Above(low),
        4 => Level::Below(low),
        5 => Level::Between(low, high),
        6 => Level::Outside(low, high),
        7 => Level::Anywhere,
        _ => {
            return Err(context.argument_error(format!(
                "the condition is {condition}, expected 1 (AIO_ABOVE_HIGH) to 7 (AIO_ALWAYS)"
            )));
        }
    };
    let direction = i8::from(context.is_given(7)) - i8::from(context.is_given(8));
    let once = is_single(context);
    let trigger = Trigger::Level {
        name,
        wanted,
        step,
        direction,
        last,
    };
    order(context, 9, once, trigger)
}

fn timer(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let seconds = context.number(2)?;
    if seconds < SHORTEST_PERIOD {
        return Err(context.argument_error(format!(
            "ITimer takes at least {SHORTEST_PERIOD} s, found {seconds}"
        )));
    }
    let once = is_single(context);
    let period = SimDuration::from_secs_f64(seconds);
    let due = system.now() + period;
    order(context, 3, once, Trigger::Timer { period, due })
}

fn change(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let last = context.required(0)?.clone();
    let Some(Value::Reference(variable)) = context.arguments.first().cloned() else {
        return Err(context.argument_error("IPers takes a persistent variable"));
    };
    order(context, 1, false, Trigger::Change { variable, last })
}

fn delete(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let number = number(context, 0)?;
    let interrupts = &mut context.memory.interrupts;
    interrupts.connected.retain(|i| i.number != number);
    interrupts.queued.retain(|i| *i != number);
    done()
}

fn sleep(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    interrupt(context, 0)?.asleep = true;
    done()
}

fn watch(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    interrupt(context, 0)?.asleep = false;
    done()
}

fn disable(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    context.memory.interrupts.disabled = true;
    done()
}

fn enable(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    context.memory.interrupts.disabled = false;
    done()
}

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}
