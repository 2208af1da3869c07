use crate::config_reader::{ConfigDiagnostic, ConfigError};
use crate::{ElementType, Limits};

/// Who connects to whom (`EXTERNAL/TYPE`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Peer {
    /// The peer is the server: the robot connects to `EXTERNAL` `IP` and `PORT`.
    #[default]
    Server,
    /// The peer is the client: the robot listens on `INTERNAL` `IP` and `PORT`, and takes one connection.
    Client,
}

/// What deletes the connection (`INTERNAL/ENVIRONMENT`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Environment {
    /// The end or reset of the program.
    #[default]
    Program,
    /// The end of the submit interpreter.
    Submit,
    /// A restart of the controller.
    System,
}

/// Which value of a memory is read next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BufferMode {
    /// The oldest.
    #[default]
    Fifo,
    /// The newest.
    Lifo,
}

/// Memories of the elements (`INTERNAL/BUFFERING`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Buffering {
    /// Which value is read next.
    pub mode: BufferMode,
    /// Most values of one memory, 1 to 512.
    pub limit: usize,
}

/// Flag or output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SignalKind {
    /// `$FLAG[n]`.
    Flag,
    /// `$OUT[n]`.
    Output,
}

/// A flag or output that the channel sets (`Set_Flag`, `Set_Out`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct SignalTarget {
    /// Which kind.
    pub kind: SignalKind,
    /// Its number, from 1.
    pub number: u32,
}

/// `INTERNAL/ALIVE`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Alive {
    /// True while there is a connection.
    pub signals: Vec<SignalTarget>,
    /// Interval of echo requests, s. They are not sent here.
    pub ping_s: Option<u32>,
}

/// The element of a RAW section.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RawElement {
    /// Its name.
    pub tag: String,
    /// Bytes of a record, if it has a fixed length.
    pub size: Option<usize>,
    /// Bytes that end a record, if it has a variable length.
    pub end: Vec<u8>,
    /// Set when a record has arrived.
    pub signals: Vec<SignalTarget>,
    /// Which record is read next.
    pub mode: BufferMode,
}

impl RawElement {
    /// BYTE for a fixed length, STREAM for a variable one.
    pub fn kind(&self) -> ElementType {
        if self.end.is_empty() {
            ElementType::Byte
        } else {
            ElementType::Stream
        }
    }
}

/// An element of a RECEIVE/XML section.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct XmlElement {
    /// Path from the root, `Root/Part/Name` or `Root/Part/@Attribute`.
    pub tag: String,
    /// Type of its values; without one it only signals.
    pub kind: Option<ElementType>,
    /// Set when a document with this element has arrived.
    pub signals: Vec<SignalTarget>,
    /// Which value is read next.
    pub mode: BufferMode,
}

/// What is received.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum ReceiveFormat {
    /// Nothing: what arrives is dropped.
    #[default]
    Nothing,
    /// Raw records.
    Raw(RawElement),
    /// XML documents.
    Xml(Vec<XmlElement>),
}

/// An element of a SEND/XML section.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SendElement {
    /// Path from the root, `Root/Part/Name` or `Root/Part/@Attribute`.
    pub tag: String,
}

/// What is sent.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum SendFormat {
    /// Nothing.
    #[default]
    Nothing,
    /// Raw records.
    Raw(RawElement),
    /// XML documents.
    Xml(Vec<SendElement>),
}

/// A configuration file: one connection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelConfig {
    /// Who connects to whom.
    pub peer: Peer,
    /// Address of the server that the robot connects to; empty if the robot is the server.
    pub external_ip: String,
    /// Its port; 0 if the robot is the server.
    pub external_port: u16,
    /// Address that the robot listens on; empty for any.
    pub internal_ip: String,
    /// Port that the robot listens on; 0 if it is the client.
    pub internal_port: u16,
    /// What deletes the connection.
    pub environment: Environment,
    /// Memories of the elements.
    pub buffering: Buffering,
    /// Most bytes that are received and not interpreted, 1 to 65534.
    pub buffer_bytes: usize,
    /// Longest wait for a connection, ms.
    pub connect_timeout_ms: u32,
    /// Connection signals.
    pub alive: Alive,
    /// Whether errors are shown to the operator (`MESSAGES Display`).
    pub show_errors: bool,
    /// What is received.
    pub receive: ReceiveFormat,
    /// What is sent.
    pub send: SendFormat,
}

/// What was read, with what a person should hear about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadConfig {
    /// The configuration.
    pub config: ChannelConfig,
    /// Warnings, in the order of the file.
    pub warnings: Vec<ConfigDiagnostic>,
}

impl ChannelConfig {
    /// Reads the text of a configuration file.
    ///
    /// # Errors
    /// All errors and warnings of the file, in its order, each with line and key.
    pub fn read(text: &str) -> Result<ReadConfig, ConfigError> {
        crate::config_reader::read(text)
    }

    /// Limits of a document that is received.
    pub fn limits(&self) -> Limits {
        Limits {
            bytes: self.buffer_bytes,
            ..Limits::default()
        }
    }
}

impl Default for ChannelConfig {
    /// The values of an empty file.
    fn default() -> Self {
        Self {
            peer: Peer::Server,
            external_ip: String::new(),
            external_port: 0,
            internal_ip: String::new(),
            internal_port: 0,
            environment: Environment::Program,
            buffering: Buffering {
                mode: BufferMode::Fifo,
                limit: 16,
            },
            buffer_bytes: 16_384,
            connect_timeout_ms: 2000,
            alive: Alive::default(),
            show_errors: true,
            receive: ReceiveFormat::Nothing,
            send: SendFormat::Nothing,
        }
    }
}
