use std::io;

use depal_wire::s7::BlockClientError;

/// Why a controller cannot be worked with. After any of these the connection is of no more use.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum S7LinkError {
    /// No connection.
    #[error("cannot connect: {0}")]
    Connect(#[source] io::Error),
    /// The connection broke.
    #[error("connection lost: {0}")]
    Lost(#[source] io::Error),
    /// Nothing, or the beginning of a telegram, and no more.
    #[error("no complete answer to {what} within {seconds} s")]
    Silent {
        /// What was asked.
        what: &'static str,
        /// How long we waited.
        seconds: f64,
    },
    /// What the controller answers, or that it closed.
    #[error(transparent)]
    Block(#[from] BlockClientError),
}
