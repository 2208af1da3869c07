use std::net::SocketAddr;

use depal_cell::event::Event;
use depal_interface::{ConnectionId, LogEntry, PortId};
use depal_time::SimTime;

/// What people may want to see. Given in order; whoever takes it must not block.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Notice {
    /// A client is there.
    Connected {
        /// Its port.
        port: PortId,
        /// Its number.
        client: ConnectionId,
        /// Where it comes from.
        peer: SocketAddr,
    },
    /// A client was sent away at once.
    Refused {
        /// The port.
        port: PortId,
        /// Where it comes from.
        peer: SocketAddr,
        /// Why.
        reason: String,
    },
    /// A client is gone.
    Disconnected {
        /// Its port.
        port: PortId,
        /// Its number.
        client: ConnectionId,
        /// Why.
        reason: String,
    },
    /// Bytes as they came, before they are understood.
    RawReceived {
        /// When.
        at: SimTime,
        /// The port.
        port: PortId,
        /// The client.
        client: ConnectionId,
        /// A piece of the stream.
        bytes: Vec<u8>,
    },
    /// One reply as it is sent.
    RawSent {
        /// When.
        at: SimTime,
        /// The port.
        port: PortId,
        /// The client.
        client: ConnectionId,
        /// The reply.
        bytes: Vec<u8>,
    },
    /// A message, decoded.
    Message(LogEntry),
    /// A controller came or went, or something is wrong with it or with its block.
    Plc {
        /// The port.
        port: PortId,
        /// In words, for people.
        text: String,
    },
    /// Something happened in the cell for a port.
    Happened(PortId, Event),
}
