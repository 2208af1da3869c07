use thiserror::Error;

/// Why a cabinet cannot be built from its description.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ControllerError {
    /// Two signals of one name (upper and lower case are the same).
    #[error("signal {name} is defined twice")]
    DuplicateSignal {
        /// The name, as spelled the second time.
        name: String,
    },
    /// A group of no bits or of too many.
    #[error("group signal {name} has {bits} bits, expected 1 to 32")]
    GroupWidth {
        /// The signal.
        name: String,
        /// As given.
        bits: u8,
    },
    /// A value that the signal cannot have at the start.
    #[error("initial value of signal {name}: {message}")]
    InitialValue {
        /// The signal.
        name: String,
        /// What is wrong.
        message: String,
    },
    /// A cross connection names a signal that is not there.
    #[error("the cross connection to {result} names the signal {name}, which is not defined")]
    CrossConnection {
        /// The signal that would follow.
        result: String,
        /// The name that is missing.
        name: String,
    },
    /// The arm would start outside its limits.
    #[error("start joints {start_deg:?} deg do not fit the limits of arm {arm}")]
    StartJoints {
        /// Name of the arm.
        arm: String,
        /// As given, degrees.
        start_deg: Vec<f64>,
    },
    /// Statements that cost no time could run for ever within one cycle.
    #[error("the cost of a statement is 0, expected more")]
    StatementCost,
}
