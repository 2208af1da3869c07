//! The vision server's brain: sessions, order rules, jobs and status codes.
//!
//! Bytes and times go in, bytes, jobs and times come out. The cell carries the bytes (from a socket or
//! from a robot program in the same process), does the jobs (camera, vision, planning) and reports
//! their results back.
//!
//! This crate must never know sockets, threads, a wall clock, the world, or how a job is done.
//!
//! A [`Session`] belongs to a port and outlives its connections: results of a run wait for the next
//! client. Every call that takes something in may produce replies, jobs, log entries and a new
//! time-out; poll all of them until empty after each.
//!
//! ```
//! use depal_interface::{ConnectionId, PortId, Server, ServerSettings};
//! use depal_time::SimTime;
//! let mut server = Server::new(ServerSettings::default()).unwrap();
//! let client = ConnectionId(1);
//! server.handle_connect(SimTime::ZERO, PortId(0), client);
//! server.handle_input(SimTime::ZERO, PortId(0), client, b"901\r");
//! assert_eq!(server.poll_reply().unwrap().bytes, b"901,1101\r");
//! ```
//!
//! [`FaultScript`] makes things go wrong on demand, so that a robot program's error handling can be tried.
//!
//! Inside SI and radians; millimetres, degrees and the brand's angle order exist only in the bytes.
//!
//! All commands of the interface. What a step kind does with an index, a parameter, an external pose, an input
//! pose or a variable is the cell's business: it gets a [`Job`] for each.
//! Calibration is a dialogue with poses of the settings; its geometry is not here.
//! Controllers that share a data block instead of sending commands are served through a [`Handshake`].

mod calibration;
mod dispatch;
mod fault_script;
mod faults;
mod job;
mod log;
mod notify;
mod outbox;
mod path_fetch;
mod plc;
mod project_values;
mod property_config;
mod server;
mod session;
mod settings;
mod vision_fetch;
mod vision_run;
mod viz_run;
mod wire_values;

pub use depal_wire::{
    AsciiTerminator, Encoding, HexPlanCells, HexReplyLength, PointCell8, Profile, StateReply,
    Status,
};
pub use fault_script::{FaultError, FaultScript};
pub use faults::FrameFaults;
pub use job::{
    CustomPort, Job, JobId, Motion, PathPoint, PlannedPath, RobotPose, VariableValue,
    VisionMoveData, VisionOutcome, VisionPoint, VisionResult, VizOutcome, VizPath,
};
pub use log::{Direction, LogEntry};
pub use outbox::Outgoing;
pub use plc::{Handshake, HandshakeSettings, PlcClient, Transfer, plc_port};
pub use property_config::{
    PropertyConfig, PropertyConfigError, PropertyValue, ReadLine, WriteLine,
};
pub use server::Server;
pub use session::{ConnectionId, Session};
pub use settings::{
    BranchStep, CalibrationPose, IndexStep, InterfaceError, OutputPort, ParameterRange, PortId,
    PortSettings, ServerSettings, StepParameter, Variable, VariableKind, VisionProject, VizProject,
};

#[cfg(test)]
mod tests;
