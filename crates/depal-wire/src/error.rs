use thiserror::Error;

use crate::Status;

/// A request that cannot be carried out because of its form; the robot hears `command, status`.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("command {command}: {reason} ({} {})", status.code(), status.meaning())]
pub struct RequestError {
    /// The command number as read, 0 when even that was unreadable.
    pub command: i32,
    /// What the robot has to hear.
    pub status: Status,
    /// What was expected and found, for the log.
    pub reason: String,
}

/// A reply that a client cannot read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ReplyError {
    /// The reply is headed by another command: wrong port, wrong byte order, or out of step.
    #[error("reply to command {found}, expected {expected}")]
    OtherCommand {
        /// The command that was sent.
        expected: i32,
        /// The first cell of the reply.
        found: i32,
    },
    /// A field is missing or is no number.
    #[error("reply to command {command}: {reason}")]
    Malformed {
        /// The command that was sent.
        command: i32,
        /// What was expected and found.
        reason: String,
    },
    /// The status code is not in the table.
    #[error("reply to command {command}: status {code} is unknown")]
    UnknownStatus {
        /// The command that was sent.
        command: i32,
        /// The second cell of the reply.
        code: i32,
    },
}
