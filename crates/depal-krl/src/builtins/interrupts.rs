use depal_vm::system::System;
use depal_vm::{CallContext, Interrupt, Outcome, Trigger, Value};

use super::path;
use super::table::{Entry, Operator, Ran};

/// IR_STOPM stops the message handling of the standard INI fold; there is nothing to do here.
pub(super) const ENTRIES: [Entry; 1] = [("IR_STOPM()", nothing)];

pub(super) const OPERATORS: [Operator; 7] = [
    ("interrupt declare", declare),
    ("interrupt switch", switch),
    ("interrupt end", path::go_on),
    ("brake", path::brake),
    ("leave path", path::leave),
    ("trigger", path::trigger),
    ("trigger call", path::trigger_call),
];

/// Numbers of interrupts, which are their priorities: 1 is the most urgent.
const NUMBERS: std::ops::RangeInclusive<i64> = 1..=128;

fn nothing(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Done(Value::Absent))
}

/// Number, routine of the condition, routine to run, whether it stays when this routine is left.
fn declare(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let number = context.number(0)? as i64;
    if !NUMBERS.contains(&number) {
        return Err(context.argument_error(format!(
            "an interrupt has a number from {} to {}, found {number}",
            NUMBERS.start(),
            NUMBERS.end()
        )));
    }
    let condition = context.number(1)? as u32;
    let routine = context.number(2)? as u32;
    let stays = matches!(context.required(3)?, Value::Bool(true));
    let level = context.memory.frames.len() as u32;
    let number = number as u32;
    let interrupts = &mut context.memory.interrupts;
    interrupts.connected.retain(|i| i.number != number);
    interrupts.queued.retain(|i| *i != number);
    interrupts.connected.push(Interrupt {
        number,
        routine,
        trigger: Trigger::Condition {
            routine: condition,
            last: None,
        },
        asleep: true,
        priority: Some(number),
        level: if stays { 0 } else { level },
        ..Interrupt::default()
    });
    Ok(Outcome::Done(Value::Absent))
}

/// Number (0: all) and what to do: 0 ON, 1 OFF, 2 ENABLE, 3 DISABLE.
fn switch(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let number = context.number(0)? as i64;
    let action = context.number(1)? as i64;
    let interrupts = &mut context.memory.interrupts;
    let known = interrupts
        .connected
        .iter()
        .any(|i| i64::from(i.number) == number);
    if number != 0 && !known && action == 0 {
        return Err(context.argument_error(format!("the interrupt {number} is not declared")));
    }
    for interrupt in &mut interrupts.connected {
        if number != 0 && i64::from(interrupt.number) != number {
            continue;
        }
        match action {
            0 | 1 => {
                interrupt.asleep = action == 1;
                if let Trigger::Condition { last, .. } = &mut interrupt.trigger {
                    // Only a change from now on counts.
                    *last = None;
                }
            }
            _ => interrupt.held = action == 3,
        }
    }
    Ok(Outcome::Done(Value::Absent))
}
