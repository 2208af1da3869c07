use std::io;

use depal_wire::s7::{BLOCK_BYTES, MIN_PDU, ReturnCode, S7Error};

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
    /// The other end closed it.
    #[error("connection closed by the PLC")]
    Closed,
    /// Nothing, or the beginning of a telegram, and no more.
    #[error("no complete answer to {what} within {seconds} s")]
    Silent {
        /// What was asked.
        what: &'static str,
        /// How long we waited.
        seconds: f64,
    },
    /// Whoever answers there does not know the processor.
    #[error(
        "rack {rack}, slot {slot} refused (reason {reason}); is the processor there? \
         Series 300 has slot 2, 1200 and 1500 slot 0 or 1"
    )]
    Place {
        /// Rack asked for.
        rack: u8,
        /// Slot asked for.
        slot: u8,
        /// The number given.
        reason: u8,
    },
    /// Telegrams would be too short to work with.
    #[error("the PLC grants telegrams of {found} bytes, at least {MIN_PDU} are needed")]
    Pdu {
        /// Bytes granted.
        found: u16,
    },
    /// An item was not read or written.
    #[error(
        "DB {db}, bytes {first} to {last}: {code}; the block needs {BLOCK_BYTES} bytes, \
         standard (not optimised) access and permitted PUT/GET"
    )]
    Item {
        /// Number of the block.
        db: u16,
        /// First byte.
        first: usize,
        /// Last byte.
        last: usize,
        /// What the controller says.
        code: ReturnCode,
    },
    /// A whole request was refused.
    #[error(
        "{what} refused with error {class:#04x} {code:#04x} (DB {db}, rack {rack}, slot {slot})"
    )]
    Refused {
        /// What was asked.
        what: &'static str,
        /// Kind of error.
        class: u8,
        /// The error.
        code: u8,
        /// Number of the block.
        db: u16,
        /// Rack of the processor.
        rack: u8,
        /// Its slot.
        slot: u8,
    },
    /// An answer that does not fit the question.
    #[error("answer to {what} has {found}, expected {expected}")]
    Answer {
        /// What was asked.
        what: &'static str,
        /// In words.
        expected: String,
        /// In words.
        found: String,
    },
    /// Bytes that are no telegram.
    #[error("unreadable answer: {0}")]
    Wire(#[from] S7Error),
}
