use thiserror::Error;

use super::{BLOCK_BYTES, MIN_PDU, ReturnCode};

/// What makes a stream or a telegram unreadable.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum S7Error {
    /// The stream is not ISO on TCP.
    #[error("expected ISO on TCP (version 3), found version {found}")]
    NotIso {
        /// The first byte of the frame.
        found: u8,
    },
    /// A frame of impossible length.
    #[error("frame of {found} bytes, expected {least} to {most}")]
    FrameLength {
        /// The length that the frame claims.
        found: usize,
        /// Header and the shortest packet.
        least: usize,
        /// What was agreed on.
        most: usize,
    },
    /// A COTP packet that class 0 does not have.
    #[error("COTP packet of kind {kind:#04x} is unknown")]
    PacketKind {
        /// Its second byte.
        kind: u8,
    },
    /// Something is shorter or longer than it says.
    #[error("{what}: expected {expected} bytes, found {found}")]
    Length {
        /// The part of the telegram.
        what: &'static str,
        /// By its own header.
        expected: usize,
        /// What is there.
        found: usize,
    },
    /// A byte that has one legal value.
    #[error("{what}: expected {expected:#04x}, found {found:#04x}")]
    Value {
        /// The part of the telegram.
        what: &'static str,
        /// The legal value.
        expected: u8,
        /// What is there.
        found: u8,
    },
    /// A request or an answer that is not for us, though well formed.
    #[error("telegram {reference}: kind {kind}, function {function:#04x} is not supported")]
    Unsupported {
        /// Its reference, for the answer.
        reference: u16,
        /// 1 request, 2 and 3 answers, 7 user data.
        kind: u8,
        /// The function; 0 if it has none.
        function: u8,
    },
    /// The other end ends the connection.
    #[error("the other end disconnects")]
    Disconnected,
    /// A packet that is not due: data before connecting, or an answer to nothing.
    #[error("a packet that is not due")]
    OutOfOrder,
}

/// Why a controller cannot be worked with. After any of these the connection is of no more use.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BlockClientError {
    /// The other end closed the connection.
    #[error("connection closed by the PLC")]
    Closed,
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
