use thiserror::Error;

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
