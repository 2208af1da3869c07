//! The connection to the vision system, and one request with its reply.

use std::task::Poll;

use depal_time::SimTime;
use depal_vm::system::{Received, SocketId, SocketState, System};
use depal_vm::{CallContext, Memory, Outcome, RaisedError, RawBytes, Value};
use depal_wire::{Profile, Reply, Request, Status};

use crate::builtins::{Ran, done, number};
use crate::errors::error;
use crate::state;

/// The socket is not open, or could not be opened.
pub(super) const NOT_OPEN: i32 = 3099;
/// No complete reply within the time of MM_INIT_SKT.
pub(super) const NO_REPLY: i32 = 3098;
/// The vision system closed the connection.
pub(super) const CLOSED: i32 = 3097;
/// The reply answers another command, or its status is no status code (wrong port, wrong byte order).
pub(super) const WRONG_REPLY: i32 = 3096;

/// Bytes of a cell: a request leaves cell by cell.
const CELL: usize = 4;
/// Bytes that are read at once: a point of a list.
const PIECE: usize = 32;

/// What is kept of the connection: the socket and the seconds to wait.
pub(super) fn link(memory: &Memory) -> Option<(SocketId, f64)> {
    match memory.globals.get(state::LINK as usize) {
        Some(Value::Array(items)) => match items.as_slice() {
            [Value::Socket(Some(id)), Value::Dnum(seconds)] => Some((*id, *seconds)),
            _ => None,
        },
        _ => None,
    }
}

fn set_link(memory: &mut Memory, link: Option<(SocketId, f64)>) {
    if let Some(slot) = memory.globals.get_mut(state::LINK as usize) {
        *slot = match link {
            Some((id, seconds)) => {
                Value::Array(vec![Value::Socket(Some(id)), Value::Dnum(seconds)])
            }
            None => Value::Absent,
        };
    }
}

/// Closes the connection: a late reply must not be taken for the next one.
fn drop_link(context: &mut CallContext<'_>, system: &mut dyn System) {
    if let Some((id, _)) = link(context.memory) {
        system.socket_close(id);
        set_link(context.memory, None);
    }
}

/// `MM_INIT_SKT(C_Tag,Ip_Addr,Svr_Port,Time_Out)`: opens the connection. The time is in minutes.
pub(super) fn init(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const STATUS: usize = 4;
    let tag = match context.required(0)? {
        Value::Str(text) => text.trim().parse().unwrap_or(0),
        value => value.as_number().unwrap_or(0.0) as i64,
    };
    if !(1..=8).contains(&tag) {
        return Err(argument("the tag of the socket is '1' to '8'"));
    }
    let address = context.string(1)?;
    let port = number(context, 2)?;
    if port.fract() != 0.0 || !(1.0..=65_535.0).contains(&port) {
        return Err(argument(format!("{port} is no port; 1 to 65535 are")));
    }
    let minutes = number(context, 3)?;
    if minutes <= 0.0 || minutes > 1e6 {
        return Err(argument(format!(
            "Time_Out is {minutes} minutes, expected more than 0"
        )));
    }
    let id = if let Some(Value::Socket(Some(id))) = context.notes.first() {
        *id
    } else {
        drop_link(context, system);
        let id = system.socket_create();
        context.notes.push(Value::Socket(Some(id)));
        id
    };
    let seconds = minutes * 60.0;
    match system.socket_connect(id, &address, port as u16) {
        Poll::Ready(Ok(())) => {
            set_link(context.memory, Some((id, seconds)));
            report(context, STATUS, 0)?;
            done()
        }
        Poll::Pending if context.elapsed(system.now()).as_secs_f64() < seconds => {
            Ok(Outcome::Blocked)
        }
        _ => {
            system.socket_close(id);
            if report(context, STATUS, NOT_OPEN)? {
                return done();
            }
            Err(error(
                "Robot_Socket_Closed",
                format!("no connection to the vision system at {address}:{port}"),
            ))
        }
    }
}

/// A wrong argument of a call.
pub(super) fn argument(message: impl Into<String>) -> RaisedError {
    error("Robot_Argument_Error", message)
}

/// Writes a status to the register whose number is argument `at`, if it was given. Whether it was.
pub(super) fn report(
    context: &mut CallContext<'_>,
    at: usize,
    code: i32,
) -> Result<bool, RaisedError> {
    if !context.is_given(at) {
        return Ok(false);
    }
    let register = number(context, at)?;
    state::set_register(context.memory, register, f64::from(code))?;
    Ok(true)
}

/// The error of a code for a call without a status register.
pub(super) fn failure(call: &str, code: i32) -> RaisedError {
    match code {
        NOT_OPEN => error(
            "Robot_Socket_Closed",
            format!("{call}: the connection is not open; call MM_INIT_SKT first"),
        ),
        CLOSED => error(
            "Robot_Socket_Closed",
            format!("{call}: the vision system closed the connection"),
        ),
        NO_REPLY => error(
            "Robot_Socket_Closed",
            format!("{call}: no complete reply within the time of MM_INIT_SKT"),
        ),
        WRONG_REPLY => error(
            "Robot_CMD_Error",
            format!(
                "{call}: the reply does not fit the command (another command, or another byte order)"
            ),
        ),
        code => {
            let meaning = Status::from_code(code).map_or("an unknown code", Status::meaning);
            error(
                "Robot_CMD_Error",
                format!("{call}: status {code}: {meaning}"),
            )
        }
    }
}

/// Sends a request and gathers its reply. The first note is the caller's; the ones behind it are kept here, and
/// cleared when the reply is there.
pub(super) fn exchange(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    request: &Request,
) -> Poll<Result<Reply, i32>> {
    let Some((id, seconds)) = link(context.memory) else {
        return Poll::Ready(Err(NOT_OPEN));
    };
    let finished = exchange_on(context, system, request, id, seconds);
    if let Poll::Ready(result) = &finished {
        context.notes.truncate(1);
        if result.is_err() {
            drop_link(context, system);
        }
    }
    finished
}

fn exchange_on(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    request: &Request,
    id: SocketId,
    seconds: f64,
) -> Poll<Result<Reply, i32>> {
    let profile = Profile::v1_8();
    let encoding = state::encoding(context.memory);
    if context.notes.len() < 3 {
        context.notes.truncate(1);
        if system.socket_state(id) != SocketState::Connected {
            return Poll::Ready(Err(NOT_OPEN));
        }
        for cell in request.encode(encoding, &profile).chunks(CELL) {
            if system.socket_send(id, cell).is_err() {
                return Poll::Ready(Err(CLOSED));
            }
        }
        context
            .notes
            .push(Value::Int(system.now().as_nanos() as i64));
        context.notes.push(Value::Raw(Box::default()));
    }
    let (Some(Value::Int(begun)), Some(Value::Raw(held))) =
        (context.notes.get(1), context.notes.get(2))
    else {
        return Poll::Ready(Err(WRONG_REPLY));
    };
    let begun = SimTime::from_nanos(*begun as u64);
    let mut bytes = held.as_slice().to_vec();
    let length = profile.hex_reply_len(0);
    while bytes.len() < length {
        match system.socket_receive(id, PIECE.min(length - bytes.len())) {
            Poll::Ready(Ok(Received::Data(data))) if !data.is_empty() => bytes.extend(data),
            Poll::Ready(Ok(Received::Data(_))) | Poll::Pending => {
                let passed = system.now().saturating_since(begun).as_secs_f64();
                if passed >= seconds {
                    return Poll::Ready(Err(NO_REPLY));
                }
                let raw = RawBytes::from_bytes(bytes).unwrap_or_default();
                context.notes[2] = Value::Raw(Box::new(raw));
                return Poll::Pending;
            }
            Poll::Ready(Ok(Received::Closed) | Err(_)) => return Poll::Ready(Err(CLOSED)),
        }
    }
    let reply = Reply::decode_as(encoding, &profile, request, &bytes);
    Poll::Ready(reply.map_err(|_| WRONG_REPLY))
}

/// The status code of a reply; a message has none.
pub(super) fn code(reply: &Reply) -> i32 {
    reply.verdict().map_or(0, Status::code)
}

/// A whole number for a cell.
pub(super) fn whole(context: &CallContext<'_>, at: usize, name: &str) -> Result<i32, RaisedError> {
    let value = number(context, at)?;
    if value.fract() == 0.0 && value.abs() <= f64::from(i32::MAX) {
        Ok(value as i32)
    } else {
        Err(argument(format!(
            "{name} is {value}, expected a whole number"
        )))
    }
}
