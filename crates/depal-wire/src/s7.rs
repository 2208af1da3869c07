//! The wire of Siemens controllers, as far as the vision interface needs it, and the data block on it.
//!
//! From the outside in: a TPKT frame (RFC 1006) holds one COTP packet (ISO 8073 class 0), a COTP data packet
//! holds one S7 telegram: setup, read or write of variables, or the answer to one.
//! [`TelegramReader`] cuts a stream into packets, [`S7Message`] is one telegram, [`DataBlock`] the 9,696 bytes
//! that controller and vision share, with every register in one table ([`Field`]).
//!
//! All numbers are big-endian: INT is a 16-bit integer, REAL single precision, BOOL bit 0 of its byte.
//!
//! Not here: symbolic addresses, user data telegrams, fragments of optimised blocks.

mod block;
mod client;
mod codes;
mod cotp;
mod error;
mod items;
mod message;
mod reader;
mod server;

pub use block::{
    BLOCK_BYTES, COMMAND_BYTES, DataBlock, Field, FieldKind, FieldSpec, POINT_ROWS, Side,
};
pub use client::{BlockClient, BlockDone};
pub use codes::ReturnCode;
pub use cotp::{CotpConnect, CotpPacket, Tsap};
pub use error::{BlockClientError, S7Error};
pub use items::{AREA_DB, DataTransport, VarAddress, VarData};
pub use message::{
    MIN_PDU, PREFERRED_PDU, S7Body, S7Message, Setup, read_capacity, write_capacity,
};
pub use reader::TelegramReader;
pub use server::{BlockServer, Served, answer};

#[cfg(test)]
mod tests;
