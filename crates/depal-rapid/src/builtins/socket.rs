use std::task::Poll;

use depal_vm::system::{Fault, Received, SocketId, SocketState, System};
use depal_vm::{CallContext, Outcome, RAW_BYTES_LIMIT, RaisedError, RawBytes, Value};

use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 9] = [
    (
        "PROC SocketCreate(INOUT socketdev Socket \\switch UDP)",
        create,
    ),
    (
        "PROC SocketConnect(INOUT socketdev Socket, string Address, num Port \\num Time)",
        connect,
    ),
    (
        "PROC SocketSend(INOUT socketdev Socket \\string Str | INOUT rawbytes RawData | num Data{*} \\num NoOfBytes)",
        send,
    ),
    (
        "PROC SocketReceive(INOUT socketdev Socket \\INOUT string Str | INOUT rawbytes RawData | INOUT num Data{*} \\num ReadNoOfBytes \\INOUT num NoRecBytes \\num Time)",
        receive,
    ),
    (
        "PROC SocketBind(INOUT socketdev Socket, string LocalAddress, num LocalPort)",
        bind,
    ),
    ("PROC SocketListen(INOUT socketdev Socket)", listen),
    (
        "PROC SocketAccept(INOUT socketdev Socket, INOUT socketdev ClientSocket \\INOUT string ClientAddress \\num Time)",
        accept,
    ),
    ("PROC SocketClose(INOUT socketdev Socket)", close),
    ("FUNC num SocketGetStatus(INOUT socketdev Socket)", status),
];

/// Seconds that SocketConnect and SocketReceive wait unless told otherwise.
const DEFAULT_TIME: f64 = 60.0;
/// WAIT_MAX and above: for ever.
const FOR_EVER: f64 = 8_388_607.0;

fn socket(context: &CallContext<'_>) -> Result<SocketId, RaisedError> {
    match context.required(0)? {
        Value::Socket(Some(id)) => Ok(*id),
        _ => Err(error("ERR_SOCK_CLOSED", "the socket has not been created")),
    }
}

fn timed_out(
    context: &CallContext<'_>,
    system: &dyn System,
    time: usize,
) -> Result<Option<f64>, RaisedError> {
    let limit = context.optional_number(time)?.unwrap_or(DEFAULT_TIME);
    let over = limit < FOR_EVER && context.elapsed(system.now()).as_secs_f64() >= limit;
    Ok(over.then_some(limit))
}

fn create(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if context.is_given(1) {
        return Err(context.argument_error("SocketCreate \\UDP is not simulated"));
    }
    if let Value::Socket(Some(id)) = context.required(0)?
        && system.socket_state(*id) != SocketState::Closed
    {
        return Err(error(
            "ERR_SOCK_UNSPEC",
            "the socket is already created; close it with SocketClose first",
        ));
    }
    let id = system.socket_create();
    context.assign(0, Value::Socket(Some(id)))?;
    done()
}

fn connect(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let id = socket(context)?;
    let port = context.number(2)?;
    if port.fract() != 0.0 || !(1.0..=65_535.0).contains(&port) {
        return Err(context.argument_error(format!("{port} is no port; 1 to 65535 are")));
    }
    if system.socket_state(id) == SocketState::Connected && context.notes.is_empty() {
        return Err(error(
            "ERR_SOCK_IS_CONNECTED",
            "the socket is already connected",
        ));
    }
    let address = context.string(1)?;
    match system.socket_connect(id, &address, port as u16) {
        Poll::Ready(Ok(())) => done(),
        Poll::Ready(Err(fault)) => Err(context.system_fault(fault)),
        Poll::Pending => {
            if let Some(limit) = timed_out(context, system, 3)? {
                return Err(error(
                    "ERR_SOCK_TIMEOUT",
                    format!("no connection to {address}:{port} within {limit} s"),
                ));
            }
            if context.notes.is_empty() {
                context.notes.push(Value::Bool(true));
            }
            Ok(Outcome::Blocked)
        }
    }
}

fn bind(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let id = socket(context)?;
    let port = context.number(2)?;
    if port.fract() != 0.0 || !(1.0..=65_535.0).contains(&port) {
        return Err(context.argument_error(format!("{port} is no port; 1 to 65535 are")));
    }
    match system.socket_bind(id, &context.string(1)?, port as u16) {
        Ok(()) => done(),
        Err(fault) => Err(context.system_fault(fault)),
    }
}

fn listen(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let id = socket(context)?;
    match system.socket_listen(id) {
        Ok(()) => done(),
        Err(fault) => Err(context.system_fault(fault)),
    }
}

fn accept(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let id = socket(context)?;
    match system.socket_accept(id) {
        Poll::Ready(Ok((client, peer))) => {
            context.assign(1, Value::Socket(Some(client)))?;
            if context.is_given(2) {
                context.assign(2, Value::Str(peer))?;
            }
            done()
        }
        Poll::Ready(Err(fault)) => Err(context.system_fault(fault)),
        Poll::Pending => match timed_out(context, system, 3)? {
            Some(limit) => Err(error(
                "ERR_SOCK_TIMEOUT",
                format!("nobody connected within {limit} s"),
            )),
            None => Ok(Outcome::Blocked),
        },
    }
}

fn send(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let id = socket(context)?;
    let mut bytes = if context.is_given(1) {
        text_bytes(&context.string(1)?)
    } else if let Some(Value::Raw(raw)) = context.value(2)? {
        raw.as_slice().to_vec()
    } else if let Some(Value::Array(items)) = context.value(3)? {
        items
            .iter()
            .map(|v| v.as_number().unwrap_or(0.0).round() as u8)
            .collect()
    } else {
        return Err(context.argument_error("SocketSend needs \\Str, \\RawData or \\Data"));
    };
    if let Some(count) = context.optional_number(4)? {
        if count < 0.0 || count as usize > bytes.len() {
            return Err(context.argument_error(format!(
                "\\NoOfBytes is {count}, but there are {} bytes",
                bytes.len()
            )));
        }
        bytes.truncate(count as usize);
    }
    match system.socket_send(id, &bytes) {
        Ok(()) => done(),
        Err(fault) => Err(context.system_fault(fault)),
    }
}

/// Bytes that have arrived are kept with the socket until they are enough, so that a time-out loses none.
fn receive(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let id = socket(context)?;
    let most = if context.is_given(1) {
        80
    } else if context.is_given(2) {
        RAW_BYTES_LIMIT
    } else if let Some(Value::Array(items)) = context.value(3)? {
        items.len().min(RAW_BYTES_LIMIT)
    } else {
        return Err(context.argument_error("SocketReceive needs \\Str, \\RawData or \\Data"));
    };
    let wanted = match context.optional_number(4)? {
        Some(count) if count >= 1.0 && count <= most as f64 => Some(count as usize),
        Some(count) => {
            return Err(
                context.argument_error(format!("\\ReadNoOfBytes is {count}; 1 to {most} fit here"))
            );
        }
        None => None,
    };
    let limit = wanted.unwrap_or(most);
    let mut held = context.memory.unread.remove(&id).unwrap_or_default();
    let mut closed = None;
    while held.len() < limit {
        match system.socket_receive(id, limit - held.len()) {
            Poll::Ready(Ok(Received::Data(data))) if !data.is_empty() => held.extend(data),
            Poll::Ready(Ok(Received::Data(_))) | Poll::Pending => break,
            Poll::Ready(Ok(Received::Closed)) => {
                closed = Some(Fault::SocketClosed);
                break;
            }
            Poll::Ready(Err(fault)) => {
                closed = Some(fault);
                break;
            }
        }
    }
    let enough = match wanted {
        Some(wanted) => held.len() >= wanted,
        None => !held.is_empty(),
    };
    if enough {
        let rest = held.split_off(held.len().min(limit));
        if !rest.is_empty() {
            context.memory.unread.insert(id, rest);
        }
        return deliver(context, held);
    }
    if let Some(fault) = closed {
        return Err(context.system_fault(fault));
    }
    let count = held.len();
    if !held.is_empty() {
        context.memory.unread.insert(id, held);
    }
    match timed_out(context, system, 6)? {
        Some(limit) => {
            let needed = wanted.map_or_else(String::new, |w| format!(" of {w}"));
            Err(error(
                "ERR_SOCK_TIMEOUT",
                format!("{count}{needed} bytes arrived within {limit} s"),
            ))
        }
        None => Ok(Outcome::Blocked),
    }
}

fn deliver(context: &mut CallContext<'_>, bytes: Vec<u8>) -> Ran {
    let count = bytes.len();
    if context.is_given(1) {
        let text = bytes.iter().map(|b| char::from(*b)).collect();
        context.assign(1, Value::Str(text))?;
    } else if context.is_given(2) {
        let raw = RawBytes::from_bytes(bytes).unwrap_or_default();
        context.assign(2, Value::Raw(Box::new(raw)))?;
    } else if let Some(Value::Array(items)) = context.value(3)? {
        let mut items = items.clone();
        for (item, byte) in items.iter_mut().zip(bytes) {
            *item = Value::Num(f32::from(byte));
        }
        context.assign(3, Value::Array(items))?;
    }
    if context.is_given(5) {
        context.assign_number(5, count as f64)?;
    }
    done()
}

fn close(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if let Value::Socket(Some(id)) = context.required(0)? {
        let id = *id;
        system.socket_close(id);
        context.memory.unread.remove(&id);
        context.assign(0, Value::Socket(None))?;
    }
    done()
}

/// The values of SOCKET_CREATED, SOCKET_CONNECTED and SOCKET_CLOSED.
fn status(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let state = match context.required(0)? {
        Value::Socket(Some(id)) => system.socket_state(*id),
        _ => SocketState::Closed,
    };
    Ok(Outcome::Done(Value::Num(match state {
        SocketState::Created => 1.0,
        SocketState::Connected => 2.0,
        SocketState::Bound => 3.0,
        SocketState::Listening => 4.0,
        SocketState::Closed => 5.0,
    })))
}

/// Strings are ISO-8859-1 on the wire; what does not fit there is sent as a question mark.
fn text_bytes(text: &str) -> Vec<u8> {
    text.chars()
        .map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?'))
        .collect()
}

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}
