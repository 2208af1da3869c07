//! A client of a controller's data block without sockets: bytes in, bytes out.

use depal_time::SimTime;
use depal_wire::s7::{BlockClient, BlockClientError, BlockDone};

use super::{Handshake, HandshakeSettings, Transfer};

/// [`Handshake`] and telegrams in one: what stands between a connection to a controller and a session.
///
/// After every call that takes something in, poll [`poll_output`](Self::poll_output) and
/// [`poll_request`](Self::poll_request) until `None`, and call [`handle_timeout`](Self::handle_timeout) when
/// [`poll_timeout`](Self::poll_timeout) is due. After an error, close and [connect](Self::handle_connect) again.
#[derive(Debug, Clone)]
pub struct PlcClient {
    handshake: Handshake,
    client: BlockClient,
}

impl PlcClient {
    /// For data block `db` of the processor in `rack` and `slot`; not connected.
    pub fn new(settings: HandshakeSettings, db: u16, rack: u8, slot: u8) -> Self {
        Self {
            handshake: Handshake::new(settings),
            client: BlockClient::new(db, rack, slot),
        }
    }

    /// A connection is there.
    pub fn handle_connect(&mut self) {
        self.handle_disconnect();
        self.client.connect();
    }

    /// The connection is gone.
    pub fn handle_disconnect(&mut self) {
        self.handshake.handle_disconnect();
        self.client.disconnect();
    }

    /// Bytes came.
    pub fn handle_input(&mut self, now: SimTime, bytes: &[u8]) -> Result<(), BlockClientError> {
        self.client.push(bytes);
        while let Some(done) = self.client.poll()? {
            match done {
                BlockDone::Connected => self.handshake.handle_connect(),
                BlockDone::Read(bytes) => self.handshake.handle_read(now, &bytes),
                BlockDone::Written => self.handshake.handle_written(now),
            }
        }
        self.handle_timeout(now);
        Ok(())
    }

    /// One whole reply of the session.
    pub fn handle_reply(&mut self, now: SimTime, bytes: &[u8]) {
        self.handshake.handle_reply(bytes);
        self.handle_timeout(now);
    }

    /// Time passed.
    pub fn handle_timeout(&mut self, now: SimTime) {
        if !self.client.is_idle() {
            return;
        }
        match self.handshake.poll_transfer(now) {
            Some(Transfer::Read { first, len }) => self.client.read(first, len),
            Some(Transfer::Write { first, bytes }) => self.client.write(first, bytes),
            None => {}
        }
    }

    /// Bytes to send.
    pub fn poll_output(&mut self) -> Option<Vec<u8>> {
        self.client.poll_output()
    }

    /// The next request for the session.
    pub fn poll_request(&mut self) -> Option<Vec<u8>> {
        self.handshake.poll_request()
    }

    /// What people should know.
    pub fn poll_notice(&mut self) -> Option<String> {
        self.handshake.poll_notice()
    }

    /// When [`handle_timeout`](Self::handle_timeout) has something to do.
    pub fn poll_timeout(&self) -> Option<SimTime> {
        let due = self.handshake.poll_timeout();
        due.filter(|_| self.client.is_idle())
    }
}
