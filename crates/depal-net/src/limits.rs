use std::time::Duration;

/// What one client may take. Times are wall time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Limits {
    /// Clients of one port at a time; further ones are closed at once.
    /// Default 128: robots are few, and what is more is a mistake or an attack.
    pub clients_per_port: usize,
    /// A client that is silent for so long, with nothing to wait for, is closed.
    /// Default one hour: programs keep their socket open over a break; dead peers are found by keep-alive.
    pub idle: Duration,
    /// A reply that cannot be written for so long ends its connection.
    /// Default 10 s: a robot that does not read for longer has stopped.
    pub write: Duration,
    /// Silence before the system asks a peer whether it still lives. Default 5 s.
    pub keepalive_after: Duration,
    /// Between two such questions. Default 2 s.
    pub keepalive_interval: Duration,
    /// Unanswered questions that end the connection. Default 5: 15 s in all.
    pub keepalive_retries: u32,
    /// For finishing replies once told to stop. Default 1 s.
    pub shutdown: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            clients_per_port: 128,
            idle: Duration::from_hours(1),
            write: Duration::from_secs(10),
            keepalive_after: Duration::from_secs(5),
            keepalive_interval: Duration::from_secs(2),
            keepalive_retries: 5,
            shutdown: Duration::from_secs(1),
        }
    }
}
