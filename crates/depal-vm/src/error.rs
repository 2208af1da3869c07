use crate::system::Fault;

/// An error on its way to a handler, as the program sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct RaisedError {
    /// What the program compares with.
    pub number: i64,
    /// Name in the program's language; empty for a number of the user's own.
    pub name: String,
    /// What happened, with numbers and units.
    pub message: String,
}

/// What can go wrong in the machine itself; [`LanguageRules`](crate::LanguageRules) give it a name and a number.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MachineFault {
    /// The cabinet refused or reported something.
    #[error("{}", fault_text(.0))]
    System(Fault),
    /// An array index out of range.
    #[error("array index {index} is outside 1..{size} (dimension {dimension})")]
    IndexOutOfRange {
        /// As computed, from 1.
        index: f64,
        /// Number of elements.
        size: usize,
        /// Which dimension, from 1.
        dimension: usize,
    },
    /// A variable was read that was never given a value.
    #[error("{name} has no value yet")]
    NotInitialized {
        /// The variable as the program spells it.
        name: String,
    },
    /// An integer result that the language's integers cannot hold.
    #[error("the integer result {value} is outside {lowest}..{highest}")]
    IntegerOverflow {
        /// As computed.
        value: i64,
        /// Least integer of the language.
        lowest: i64,
        /// Greatest integer of the language.
        highest: i64,
    },
    /// Division by zero, or its remainder.
    #[error("division by zero")]
    DivisionByZero,
    /// An optional parameter was used although the caller did not give it.
    #[error(
        "an optional parameter is used that the caller did not give; test it with Present first"
    )]
    NotPresent,
    /// A string became too long.
    #[error("the string would have {length} characters, at most {limit} fit")]
    StringTooLong {
        /// As computed.
        length: usize,
        /// Most characters.
        limit: usize,
    },
    /// Too many routines inside each other.
    #[error("more than {limit} routine calls inside each other")]
    RecursionLimit {
        /// The limit.
        limit: usize,
    },
    /// One statement was retried too often.
    #[error("the statement was retried {limit} times without success")]
    RetryLimit {
        /// The limit.
        limit: u32,
    },
    /// A number that does not fit where it is needed.
    #[error("{message}")]
    Argument {
        /// What was expected and found.
        message: String,
    },
    /// A loop whose step is zero.
    #[error("the step of a FOR loop is 0")]
    ZeroStep,
    /// A call by name found no such procedure.
    #[error("there is no procedure named {name} to call")]
    UnknownRoutine {
        /// As computed by the program.
        name: String,
    },
    /// A call by name does not fit the procedure's parameters.
    #[error("{name} cannot be called with these arguments: {message}")]
    WrongCall {
        /// The procedure.
        name: String,
        /// What was expected and found.
        message: String,
    },
    /// A function ended without a value.
    #[error("function {name} ended without RETURN and a value")]
    NoReturnValue {
        /// The function.
        name: String,
    },
}

fn fault_text(fault: &Fault) -> String {
    match fault {
        Fault::UnknownSignal(name) => format!("there is no signal {name}"),
        Fault::SignalValue { signal, message } => format!("signal {signal}: {message}"),
        Fault::OutOfReach { message } => format!("out of reach: {message}"),
        Fault::Configuration { message } => format!("arm configuration: {message}"),
        Fault::MotionSupervision { message } => format!("motion supervision: {message}"),
        Fault::SocketClosed => {
            "the socket is closed, or the other side refused or closed it".into()
        }
        Fault::SocketState { message } => format!("socket: {message}"),
        Fault::AddressInUse { address } => format!("the address {address} is in use"),
        Fault::File { message } => format!("file {message}"),
        Fault::NotThere { message } => format!("this cabinet does not have {message}"),
    }
}
