//! The interface as controllers use it that speak no commands but share a data block with vision.
//!
//! [`Handshake`] watches the command half of the block, turns each rising edge of Command Trigger into the
//! requests of an ordinary [`crate::Session`], and writes the answers into the other half.
//! It knows neither sockets nor clocks: it says which bytes it wants to read or write, and is told when
//! that is done. The block may be memory of this process or a controller far away that comes and goes.
//!
//! One execution for each rising edge of Trigger seen while Acknowledge is 0:
//!
//! 1. Status and Status of Pose Sent become 0, then Acknowledge 1.
//! 2. Acknowledge stays 1 until Trigger falls, even before the result is there.
//! 3. The result goes out in this order: arrays, counts, Status, then Status of Pose Sent if there is new data.
//!
//! A further edge waits until the result of the one before is written.
//! After a lost connection the block decides: Trigger with Acknowledge 1 is an old edge, with 0 a new one.
//! A result that was not written to its end is written again from its beginning; no command runs twice.
//!
//! Functions: 101, 102, 103, 105, 110, 201 to 206, 210, 501, 502, 601, 901; others are answered with 3001.
//! 206 and 210 take vision's path if a project is named. 110 and 210 put one point a row, all in one call,
//! up to the port's cap. Labels beyond 16 bits are answered with 1017; other numbers beyond them are cut.

mod client;
mod command;
mod handshake;
mod result;
mod running;

use depal_wire::{Encoding, HexPlanCells, HexReplyLength, PointCell8, StateReply};

pub use client::PlcClient;
pub use handshake::{Handshake, HandshakeSettings, Transfer};

use crate::settings::PortSettings;

/// The session behind a data block: as `own`, with the forms that fit the block's registers.
/// Numbers travel in single precision, as in the block, and records end with the tool id.
pub fn plc_port(own: &PortSettings) -> PortSettings {
    let mut port = own.clone();
    port.encoding = Encoding::HexLittleEndian;
    port.detects_encoding = false;
    port.profile.hex_request_len = 64;
    port.profile.hex_reply = HexReplyLength::Exact;
    port.profile.hex_plan_cells = HexPlanCells::SinglePrecision;
    port.profile.point_cell8 = PointCell8::ToolId;
    port.profile.state_reply = StateReply::Ready;
    port.profile.has_vision_plan_velocity = true;
    port.profile.pads_plan_points = false;
    port
}

#[cfg(test)]
mod tests;
