use depal_cell::event::Event;
use depal_cell::station::{Station, StationReply};
use depal_interface::{ConnectionId, Encoding, LogEntry, PortId, Profile};

/// What owns the sessions behind the ports: a [`Station`], or what a test or a bench puts in its place.
///
/// Time is told in ticks of 4 ms. Calls that name a port which does not exist are ignored.
pub trait SessionHost: Send {
    /// How each port speaks.
    fn encodings(&self) -> Vec<Encoding>;
    /// The output rules of each port; those of the default version unless told otherwise.
    fn profiles(&self) -> Vec<Profile> {
        vec![Profile::v1_8(); self.encodings().len()]
    }
    /// Ticks so far.
    fn tick(&self) -> u64;
    /// A client is there.
    fn connect(&mut self, port: PortId, connection: ConnectionId);
    /// Bytes came from a client.
    fn receive(&mut self, port: PortId, connection: ConnectionId, bytes: &[u8]);
    /// A client is gone.
    fn disconnect(&mut self, port: PortId, connection: ConnectionId);
    /// Whether a command of this client waits, and what it sends meanwhile with it.
    fn is_waiting(&self, port: PortId, connection: ConnectionId) -> bool;
    /// Whether a command of this client waits for a run to end.
    fn awaits_run(&self, port: PortId, connection: ConnectionId) -> bool;
    /// The next tick at which something is due, later than [`tick`](Self::tick).
    fn next_due(&self) -> Option<u64>;
    /// Lets time pass up to `target`; the tick reached, which is an earlier one while a result is missing.
    fn advance(&mut self, target: u64) -> u64;
    /// The next reply to send.
    fn poll_reply(&mut self) -> Option<StationReply>;
    /// The next decoded message.
    fn poll_log(&mut self) -> Option<LogEntry>;
    /// The next thing that happened, and to whose run.
    fn poll_event(&mut self) -> Option<(PortId, Event)>;
}

impl SessionHost for Station {
    fn encodings(&self) -> Vec<Encoding> {
        self.encodings()
    }

    fn profiles(&self) -> Vec<Profile> {
        self.profiles()
    }

    fn tick(&self) -> u64 {
        self.tick()
    }

    fn connect(&mut self, port: PortId, connection: ConnectionId) {
        self.connect(port, connection);
    }

    fn receive(&mut self, port: PortId, connection: ConnectionId, bytes: &[u8]) {
        self.receive(port, connection, bytes);
    }

    fn disconnect(&mut self, port: PortId, connection: ConnectionId) {
        self.disconnect(port, connection);
    }

    fn is_waiting(&self, port: PortId, connection: ConnectionId) -> bool {
        self.is_waiting(port, connection)
    }

    fn awaits_run(&self, port: PortId, connection: ConnectionId) -> bool {
        self.awaits_run(port, connection)
    }

    fn next_due(&self) -> Option<u64> {
        self.next_due()
    }

    fn advance(&mut self, target: u64) -> u64 {
        self.advance(target)
    }

    fn poll_reply(&mut self) -> Option<StationReply> {
        self.poll_reply()
    }

    fn poll_log(&mut self) -> Option<LogEntry> {
        self.poll_log()
    }

    fn poll_event(&mut self) -> Option<(PortId, Event)> {
        self.poll_event()
    }
}
