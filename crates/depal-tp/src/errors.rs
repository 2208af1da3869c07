//! Errors as a controller reports them.
//!
//! Names are those of the controller's alarm classes; a number stands there only where a source for it is at hand.

use depal_vm::system::Fault;
use depal_vm::{MachineFault, RaisedError};

/// An error of an alarm class.
pub(crate) fn error(name: &str, message: impl Into<String>) -> RaisedError {
    RaisedError {
        number: 0,
        name: name.to_owned(),
        message: message.into(),
    }
}

/// The interpreter's errors.
pub(crate) fn interpreter(message: impl Into<String>) -> RaisedError {
    error("INTP", message)
}

/// Something that was never given a value.
pub(crate) fn uninitialized(what: &str) -> RaisedError {
    interpreter(format!("Uninitialized data: {what} has no value"))
}

/// A value of the wrong kind.
pub(crate) fn mismatch(message: impl Into<String>) -> RaisedError {
    interpreter(format!("Type mismatch: {}", message.into()))
}

/// The error of a fault.
pub(crate) fn raise(fault: &MachineFault) -> RaisedError {
    match fault {
        MachineFault::System(Fault::OutOfReach { message }) => {
            error("MOTN", format!("Position not reachable: {message}"))
        }
        MachineFault::System(Fault::MotionSupervision { message }) => {
            error("SRVO", format!("Collision detected: {message}"))
        }
        MachineFault::System(Fault::UnknownSignal(_) | Fault::SignalValue { .. }) => {
            error("PRIO", fault.to_string())
        }
        MachineFault::System(
            Fault::SocketClosed | Fault::SocketState { .. } | Fault::AddressInUse { .. },
        ) => error("HOST", fault.to_string()),
        MachineFault::DivisionByZero => interpreter("Divide by zero"),
        MachineFault::NotPresent => interpreter("Uninitialized data is used"),
        MachineFault::RecursionLimit { limit } => error(
            "INTP",
            format!("Stack overflow: more than {limit} calls inside each other"),
        ),
        _ => interpreter(fault.to_string()),
    }
}
