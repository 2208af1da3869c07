//! Ethernet KRL channels as KUKA controllers have them: a configuration file in XML describes one connection, its
//! framing, and the memories that a program reads and writes by the path of an element.
//!
//! [`ChannelConfig`] is the file, [`Channel`] is the state of one connection: bytes in, values out, and back.
//! Records are fixed-length bytes, a stream with an end string, or XML documents with neither prefix nor terminator.
//!
//! This crate must never know sockets, clocks or the language: whoever owns the socket hands over the bytes and the
//! time, and sets the flags and outputs that [`Event`] names.
//! No input makes it panic: what cannot be read is an [`EkiError`] with the number that the program sees.
//! The outer shape of an XML document is found byte by byte, with limits, before a parser sees any of it.
//!
//! ```
//! use depal_eki::{Channel, ChannelConfig, ElementType, ElementValue};
//! use depal_time::SimTime;
//! let file = r#"<ETHERNETKRL>
//!   <CONFIGURATION><EXTERNAL><IP>10.0.0.2</IP><PORT>50000</PORT></EXTERNAL></CONFIGURATION>
//!   <RECEIVE><XML><ELEMENT Tag="Plc/Speed" Type="REAL"/><ELEMENT Tag="Plc" Set_Flag="7"/></XML></RECEIVE>
//!   <SEND><XML><ELEMENT Tag="Robot/Ready"/></XML></SEND>
//! </ETHERNETKRL>"#;
//! let mut channel = Channel::new(ChannelConfig::read(file).unwrap().config);
//! channel.connect(SimTime::ZERO);
//! channel.receive(b"<Plc><Speed>0.25</Speed></Plc>", SimTime::ZERO).unwrap();
//! let (value, status) = channel.get("Plc/Speed", ElementType::Real);
//! assert_eq!((value, status.read), (Some(ElementValue::Real(0.25)), 1));
//! channel.set("Robot/Ready", ElementValue::Bool(true));
//! channel.send("Robot");
//! assert_eq!(channel.take_outgoing(), b"<Robot><Ready>1</Ready></Robot>");
//! ```
//!
//! Units and frames: values pass as they are; a FRAME is X, Y, Z, A, B, C in the peer's units.
//!
//! Limitations:
//! * TCP only; a file that asks for UDP is refused.
//! * `ALIVE Ping` is accepted and does nothing: there is no echo to send here.
//! * A document without some of the configured elements is accepted; each element has its own memory, as on the
//!   controller, so that the memories may then hold different numbers of values.
//! * Values stay in the send memories after sending, until they are written again or cleared.
//! * What a controller does with an unfinished record is not documented; here it waits [`UNFINISHED_LIMIT`].

mod calls;
mod channel;
mod config;
mod config_raw;
mod config_reader;
mod config_words;
mod document;
mod error;
mod incoming;
mod limits;
mod memory;
mod outgoing;
mod splitter;
mod status;
mod value;

pub use channel::{Channel, Event, UNFINISHED_LIMIT};
pub use config::{
    Alive, BufferMode, Buffering, ChannelConfig, Environment, Peer, RawElement, ReadConfig,
    ReceiveFormat, SendElement, SendFormat, SignalKind, SignalTarget, XmlElement,
};
pub use config_reader::{ConfigDiagnostic, ConfigError, ConfigSeverity};
pub use document::{Document, Node};
pub use error::EkiError;
pub use limits::Limits;
pub use splitter::DocumentSplitter;
pub use status::Status;
pub use value::{ElementType, ElementValue};

#[cfg(test)]
mod tests;
