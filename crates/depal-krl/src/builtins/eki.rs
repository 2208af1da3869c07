//! Ethernet KRL: channels that configuration files describe. The protocol is in `depal-eki`.
//!
//! A channel is looked at whenever a flag is read and whenever it is called; so a WAIT FOR a flag, or an interrupt
//! on one, sees what has arrived.

mod arguments;
mod link;
mod links;
#[cfg(test)]
mod tests;

use std::task::Poll;

use depal_eki::{ElementType, ElementValue, SignalKind, Status};
use depal_vm::system::{LogKind, System};
use depal_vm::{CallContext, HostState, MachineFault, Outcome, Value};

use self::arguments::*;
pub(crate) use self::links::Links;
use self::links::Notice;
use super::state::{CHANNELS, FLAGS};
use super::table::{Entry, Operator, Ran};

pub(super) const ENTRIES: [Entry; 24] = [
    ("EKI_STATUS EKI_Init(CHAR[] Name)", |c, s| {
        simple(c, s, |l, n, _| l.init(n))
    }),
    ("EKI_STATUS EKI_Open(CHAR[] Name)", open),
    ("EKI_STATUS EKI_Close(CHAR[] Name)", |c, s| {
        simple(c, s, Links::close)
    }),
    ("EKI_STATUS EKI_Clear(CHAR[] Name)", |c, s| {
        simple(c, s, Links::clear)
    }),
    ("EKI_STATUS EKI_Lock(CHAR[] Name)", |c, s| {
        simple(c, s, |l, n, s| l.with(n, s, depal_eki::Channel::lock))
    }),
    ("EKI_STATUS EKI_Unlock(CHAR[] Name)", |c, s| {
        simple(c, s, |l, n, s| {
            let now = s.now();
            l.with(n, s, |channel| match channel.unlock(now) {
                Ok(()) => Status {
                    connected: channel.is_connected(),
                    ..Status::default()
                },
                Err(error) => Status::failed(error, false),
            })
        })
    }),
    (
        "EKI_STATUS EKI_CheckBuffer(CHAR[] Name, CHAR[] Path)",
        |c, s| by_path(c, s, depal_eki::Channel::check_buffer),
    ),
    (
        "EKI_STATUS EKI_ClearBuffer(CHAR[] Name, ?CHAR[] Path)",
        |c, s| by_path(c, s, depal_eki::Channel::clear_buffer),
    ),
    (
        "EKI_STATUS EKI_Send(CHAR[] Name, CHAR[] Path, ?INT Length)",
        send,
    ),
    (
        "EKI_STATUS EKI_SetBool(CHAR[] Name, CHAR[] Path, BOOL Data)",
        |c, s| set(c, s, ElementType::Bool),
    ),
    (
        "EKI_STATUS EKI_SetInt(CHAR[] Name, CHAR[] Path, INT Data)",
        |c, s| set(c, s, ElementType::Int),
    ),
    (
        "EKI_STATUS EKI_SetReal(CHAR[] Name, CHAR[] Path, REAL Data)",
        |c, s| set(c, s, ElementType::Real),
    ),
    (
        "EKI_STATUS EKI_SetString(CHAR[] Name, CHAR[] Path, CHAR[] Data)",
        |c, s| set(c, s, ElementType::String),
    ),
    (
        "EKI_STATUS EKI_SetFrame(CHAR[] Name, CHAR[] Path, FRAME Data)",
        |c, s| set(c, s, ElementType::Frame),
    ),
    (
        "EKI_STATUS EKI_GetBool(CHAR[] Name, CHAR[] Path, BOOL Data:OUT)",
        |c, s| get(c, s, ElementType::Bool, false),
    ),
    (
        "EKI_STATUS EKI_GetInt(CHAR[] Name, CHAR[] Path, INT Data:OUT)",
        |c, s| get(c, s, ElementType::Int, false),
    ),
    (
        "EKI_STATUS EKI_GetReal(CHAR[] Name, CHAR[] Path, REAL Data:OUT)",
        |c, s| get(c, s, ElementType::Real, false),
    ),
    (
        "EKI_STATUS EKI_GetString(CHAR[] Name, CHAR[] Path, CHAR[] Data:OUT)",
        |c, s| get(c, s, ElementType::String, false),
    ),
    (
        "EKI_STATUS EKI_GetFrame(CHAR[] Name, CHAR[] Path, FRAME Data:OUT)",
        |c, s| get(c, s, ElementType::Frame, false),
    ),
    (
        "EKI_STATUS EKI_GetBoolArray(CHAR[] Name, CHAR[] Path, BOOL[] Data:OUT)",
        |c, s| get(c, s, ElementType::Bool, true),
    ),
    (
        "EKI_STATUS EKI_GetIntArray(CHAR[] Name, CHAR[] Path, INT[] Data:OUT)",
        |c, s| get(c, s, ElementType::Int, true),
    ),
    (
        "EKI_STATUS EKI_GetRealArray(CHAR[] Name, CHAR[] Path, REAL[] Data:OUT)",
        |c, s| get(c, s, ElementType::Real, true),
    ),
    (
        "EKI_STATUS EKI_GetFrameArray(CHAR[] Name, CHAR[] Path, FRAME[] Data:OUT)",
        |c, s| get(c, s, ElementType::Frame, true),
    ),
    (
        "EKI_CHECK(EKI_STATUS Status, EKRLMSGTYPE Kind, ?CHAR[] Name, ?INT Mode)",
        check,
    ),
];

pub(super) const OPERATORS: [Operator; 2] = [("read flag", read_flag), ("write flag", write_flag)];

/// Where an EKI_STATUS has its message number.
const MESSAGE_NUMBER: usize = 2;

/// How many flags there are.
pub(super) const FLAG_COUNT: usize = 1024;

/// Takes the channels out of the memory for a call, and tells the program what happened.
fn with_links<T>(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    call: impl FnOnce(&mut Links, &mut dyn System) -> T,
) -> T {
    let Some(Value::Host(state)) = context.memory.globals.get_mut(CHANNELS) else {
        unreachable!("the hidden variables keep their kinds");
    };
    let mut state = std::mem::take(state);
    let Some(links) = state.get_mut::<Links>() else {
        unreachable!("the hidden variables keep their kinds");
    };
    let result = call(links, system);
    for notice in links.take_notices() {
        match notice {
            Notice::Signal(target, value) => match target.kind {
                SignalKind::Flag => set_flag(context, target.number as usize, value),
                SignalKind::Output => {
                    let name = format!("$OUT[{}]", target.number);
                    // A cabinet without this output has nothing to switch.
                    let _ = system.set_signal(&name, f64::from(u8::from(value)));
                }
            },
            Notice::Arrival(flag, record) if is_on(context, flag as usize) => {
                links.note_late(flag, record);
            }
            Notice::Arrival(flag, _) => set_flag(context, flag as usize, true),
            Notice::Message(text) => system.log(LogKind::EventLog, context.location, &text),
        }
    }
    context.memory.globals[CHANNELS] = Value::Host(state);
    result
}

fn set_flag(context: &mut CallContext<'_>, number: usize, value: bool) {
    if let Value::Array(flags) = &mut context.memory.globals[FLAGS]
        && let Some(flag) = number.checked_sub(1).and_then(|i| flags.get_mut(i))
    {
        *flag = Value::Bool(value);
    }
}

fn is_on(context: &CallContext<'_>, number: usize) -> bool {
    let Value::Array(flags) = &context.memory.globals[FLAGS] else {
        return false;
    };
    number.checked_sub(1).and_then(|i| flags.get(i)) == Some(&Value::Bool(true))
}

fn flag_number(context: &CallContext<'_>) -> Result<usize, depal_vm::RaisedError> {
    let number = context.number(0)?;
    if (1.0..=FLAG_COUNT as f64).contains(&number) {
        return Ok(number as usize);
    }
    Err(context.raise(&MachineFault::IndexOutOfRange {
        index: number,
        size: FLAG_COUNT,
        dimension: 1,
    }))
}

fn read_flag(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let number = flag_number(context)?;
    with_links(context, system, Links::pump);
    Ok(Outcome::Done(Value::Bool(is_on(context, number))))
}

fn write_flag(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let number = flag_number(context)?;
    let value = *context.required(1)? == Value::Bool(true);
    // What has arrived before is older than this value.
    with_links(context, system, Links::pump);
    set_flag(context, number, value);
    if !value {
        with_links(context, system, |links, system| {
            links.flag_was_reset(number as u32, system);
        });
    }
    Ok(Outcome::Done(Value::Absent))
}

fn simple(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    call: impl FnOnce(&mut Links, &str, &mut dyn System) -> Status,
) -> Ran {
    let name = text(context, 0)?;
    let status = with_links(context, system, |links, system| call(links, &name, system));
    Ok(Outcome::Done(record(&status)))
}

fn open(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let name = text(context, 0)?;
    let started = context.started;
    let status = with_links(context, system, |links, system| {
        links.open(&name, started, system)
    });
    Ok(match status {
        Poll::Pending => Outcome::Blocked,
        Poll::Ready(status) => Outcome::Done(record(&status)),
    })
}

fn by_path(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    call: impl FnOnce(&mut depal_eki::Channel, &str) -> Status,
) -> Ran {
    let path = if context.is_given(1) {
        text(context, 1)?
    } else {
        String::new()
    };
    simple(context, system, |links, name, system| {
        links.with(name, system, |channel| call(channel, &path))
    })
}

/// The second argument is the path of an XML element, or the bytes of a raw record.
fn send(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let path = text(context, 1)?;
    let mut bytes = bytes(context, 1)?;
    if let Some(length) = context.optional_number(2)?
        && length >= 1.0
    {
        bytes.truncate(length as usize);
    }
    simple(context, system, |links, name, system| {
        links.with(name, system, |channel| match channel.config().send {
            depal_eki::SendFormat::Raw(_) => channel.send_bytes(&bytes),
            _ => channel.send(&path),
        })
    })
}

fn set(context: &mut CallContext<'_>, system: &mut dyn System, kind: ElementType) -> Ran {
    let value = element_value(context, 2, kind)?;
    by_path(context, system, |channel, path| channel.set(path, value))
}

fn get(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    kind: ElementType,
    array: bool,
) -> Ran {
    let path = text(context, 1)?;
    let room = if array { elements(context, 2)? } else { 1 };
    let text_room = if kind == ElementType::String {
        elements(context, 2)?
    } else {
        usize::MAX
    };
    let mut values: Vec<ElementValue> = Vec::new();
    let outcome = simple(context, system, |links, name, system| {
        links.with(name, system, |channel| {
            let (found, status) = channel.get_many(&path, kind, room);
            if let Some(error) = too_long(&path, &found, text_room) {
                return Status {
                    error: Some(error),
                    ..status
                };
            }
            values = found;
            status
        })
    })?;
    if array {
        assign_array(context, 2, values)?;
    } else if let Some(value) = values.into_iter().next() {
        assign_value(context, 2, value)?;
    }
    Ok(outcome)
}

/// Shows the message of a status, and with `#QUIT` stops the program.
fn check(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let number = match context.required(0)? {
        Value::Record(parts) => parts.get(MESSAGE_NUMBER).and_then(Value::as_number),
        _ => None,
    };
    let number = number.unwrap_or(0.0) as i64;
    if number == 0 {
        return Ok(Outcome::Done(Value::Absent));
    }
    let channel = if context.is_given(2) {
        format!(" {}", text(context, 2)?)
    } else {
        String::new()
    };
    let message = format!("EKI{number:05}{channel}: a call on an Ethernet channel failed");
    if is_quit(context)? {
        return Err(context.argument_error(message));
    }
    system.log(LogKind::Operator, context.location, &message);
    Ok(Outcome::Done(Value::Absent))
}

/// The hidden variable that holds the channels.
pub(crate) fn channels(links: Links) -> Value {
    Value::Host(HostState::new(links))
}
