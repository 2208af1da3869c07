use depal_time::SimTime;

use crate::{ConnectionId, PortId};

/// Which way a message went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// From the robot.
    Received,
    /// To the robot.
    Sent,
}

/// One decoded message, for the event log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LogEntry {
    /// When.
    pub at: SimTime,
    /// The port.
    pub port: PortId,
    /// The connection.
    pub connection: ConnectionId,
    /// Which way.
    pub direction: Direction,
    /// Command number; 0 if it was unreadable.
    pub command: i32,
    /// Status code of a reply.
    pub status: Option<i32>,
    /// The scripted faults that hit a reply, as the user wrote them.
    pub faults: Vec<String>,
    /// The message as comma-separated text with a few words, shortened to about 200 characters.
    pub text: String,
}
