use thiserror::Error;

use crate::ElementType;

/// What a call on a channel, or what arrived on it, ran into. [`number`](Self::number) is what the program sees as
/// `Msg_No`.
///
/// The numbers 6, 9, 15, 23 and 512 are those that public reports of users show; 3, 7, 768, 1024 and 1280 follow the
/// groups of the manual (512 connection, 768 ping, 1024 XML, 1280 memories). The others are our choice of free ones.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum EkiError {
    /// 3: no configuration file of this name.
    #[error("no configuration file {name}.xml; known: {known}")]
    NoFile {
        /// The name that the program gave.
        name: String,
        /// Names that are there.
        known: String,
    },
    /// 6: the configuration file cannot be interpreted.
    #[error("configuration {name}.xml: {message}")]
    Configuration {
        /// Channel name.
        name: String,
        /// What is wrong, with line and key.
        message: String,
    },
    /// 7: the value cannot be written for sending.
    #[error("element {tag}: {message}")]
    Write {
        /// Path of the element.
        tag: String,
        /// What is wrong.
        message: String,
    },
    /// 9: the channel was not initialised.
    #[error("channel {name} is not there: call EKI_Init first")]
    NotAvailable {
        /// The name that the program gave.
        name: String,
    },
    /// 10: there is no connection.
    #[error("no connection: call EKI_Open first")]
    NotConnected,
    /// 14: no such element in the configuration.
    #[error("no element {tag} in the {section} section of the configuration; it has {known}")]
    UnknownElement {
        /// Path that was asked for.
        tag: String,
        /// RECEIVE or SEND.
        section: &'static str,
        /// The elements that are there.
        known: String,
    },
    /// 15: the memory of the element is empty.
    #[error("the memory of element {tag} is empty")]
    Empty {
        /// Path of the element.
        tag: String,
    },
    /// 16: the element has another type.
    #[error("element {tag} is {found} in the configuration, {expected} was asked for")]
    WrongType {
        /// Path of the element.
        tag: String,
        /// The type that the call is for.
        expected: ElementType,
        /// The type of the configuration.
        found: ElementType,
    },
    /// 21: no connection came about in time.
    #[error("no connection to {address} port {port} within {limit_ms} ms: {reason}")]
    NoContact {
        /// Address of the peer, or our own as a server.
        address: String,
        /// Port.
        port: u16,
        /// `TIMEOUT Connect` of the configuration, ms.
        limit_ms: u32,
        /// Refused, or nobody there.
        reason: String,
    },
    /// 23: the channel is initialised already.
    #[error("channel {name} is initialised already: call EKI_Clear first")]
    AlreadyInitialised {
        /// Channel name.
        name: String,
    },
    /// 24: the channel is open already.
    #[error("the connection is open already")]
    AlreadyOpen,
    /// 512: the peer or the network broke the connection.
    #[error("the connection was lost")]
    ConnectionLost,
    /// 1024: what arrived is not a document that can be read. The connection must be closed: there is no way to
    /// find the next one.
    #[error("received XML, line {line}: {message}")]
    Malformed {
        /// Line in the document, from 1.
        line: u32,
        /// What is wrong.
        message: String,
    },
    /// 1025: a document that can be read and does not fit the configuration. It is dropped whole.
    #[error("received document: element {tag}: {message}")]
    Unfit {
        /// Path of the element.
        tag: String,
        /// What is wrong.
        message: String,
    },
    /// 1026: a record or document began and did not end.
    #[error("an unfinished record of {bytes} bytes and no more for {silence_ms} ms")]
    Unfinished {
        /// Bytes that came.
        bytes: usize,
        /// Time since the last of them, ms.
        silence_ms: u64,
    },
    /// 1280: the memory of an element is full. The connection is closed.
    #[error("the memory of element {tag} is full: {limit} values")]
    MemoryFull {
        /// Path of the element.
        tag: String,
        /// `BUFFERING Limit` of the configuration.
        limit: usize,
    },
    /// 1282: a text or record is longer than the variable for it. It is lost.
    #[error("element {tag}: {length} characters, the variable has room for {room}")]
    TooLong {
        /// Path of the element.
        tag: String,
        /// Characters or bytes received.
        length: usize,
        /// Size of the variable.
        room: usize,
    },
    /// 1281: more bytes arrived than are kept uninterpreted. The connection is closed.
    #[error("more than {limit} bytes received and not interpreted")]
    TooManyBytes {
        /// `BUFFSIZE Limit` of the configuration.
        limit: usize,
    },
}

impl EkiError {
    /// The number that a program finds in `Msg_No`.
    pub fn number(&self) -> i32 {
        match self {
            Self::NoFile { .. } => 3,
            Self::Configuration { .. } => 6,
            Self::Write { .. } => 7,
            Self::NotAvailable { .. } => 9,
            Self::NotConnected => 10,
            Self::UnknownElement { .. } => 14,
            Self::Empty { .. } => 15,
            Self::WrongType { .. } => 16,
            Self::NoContact { .. } => 21,
            Self::AlreadyInitialised { .. } => 23,
            Self::AlreadyOpen => 24,
            Self::ConnectionLost => 512,
            Self::Malformed { .. } => 1024,
            Self::Unfit { .. } => 1025,
            Self::Unfinished { .. } => 1026,
            Self::MemoryFull { .. } => 1280,
            Self::TooManyBytes { .. } => 1281,
            Self::TooLong { .. } => 1282,
        }
    }
}
