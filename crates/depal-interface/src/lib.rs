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
//! Inside SI and radians; millimetres, degrees and the brand's angle order exist only in the bytes.
//!
//! Commands 101, 102, 103, 201, 202, 203, 205, 206, 210, 501 and 901; any other is answered with 3001.
//! Paths are planned by the Viz project only: a vision project has points, not paths.

mod dispatch;
mod job;
mod log;
mod server;
mod session;
mod settings;
mod vision_run;
mod viz_run;
mod wire_values;

pub use depal_wire::{Encoding, Profile, Status};
pub use job::{
    Job, JobId, Motion, PathPoint, RobotPose, VisionMoveData, VisionOutcome, VisionPoint,
    VizOutcome, VizPath,
};
pub use log::{Direction, LogEntry};
pub use server::Server;
pub use session::{ConnectionId, Outgoing, Session};
pub use settings::{
    BranchStep, InterfaceError, OutputPort, PortId, PortSettings, ServerSettings, VisionProject,
    VizProject,
};

#[cfg(test)]
mod tests;
