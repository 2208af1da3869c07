//! Vision's end of a connection to a controller: between the link's bytes and the session's requests.

use std::collections::VecDeque;

use depal_interface::{ConnectionId, HandshakeSettings, PlcClient, Profile};
use depal_time::{SimDuration, SimTime};

use crate::link::ToServer;
use crate::spec::PlcPort;

/// The session's client that stands for the controller. Robots that connect count from 1.
pub(crate) const PLC: ConnectionId = ConnectionId(0);

/// After a lost connection vision calls again this much later.
const PAUSE: SimDuration = SimDuration::from_millis(1_000);

/// Polls the data block of the robot task, which is a controller.
#[derive(Debug, Clone)]
pub(crate) struct PlcLink {
    /// Where the controller listens.
    pub(crate) port: u16,
    client: PlcClient,
    is_connected: bool,
    is_session_open: bool,
    call_at: SimTime,
    requests: VecDeque<Vec<u8>>,
    /// For the log.
    pub(crate) notices: Vec<String>,
}

impl PlcLink {
    pub(crate) fn new(plc: &PlcPort, profile: Profile) -> Self {
        let settings = HandshakeSettings {
            poll_period: plc.poll,
            profile,
            ..HandshakeSettings::default()
        };
        Self {
            port: plc.port,
            client: PlcClient::new(settings, plc.db, plc.rack, plc.slot),
            is_connected: false,
            is_session_open: false,
            call_at: SimTime::ZERO,
            requests: VecDeque::new(),
            notices: Vec::new(),
        }
    }

    /// Whether vision wants to call now.
    pub(crate) fn wants_to_call(&self, now: SimTime) -> bool {
        !self.is_connected && self.call_at <= now
    }

    /// The controller was called.
    pub(crate) fn handle_connect(&mut self) {
        self.is_connected = true;
        self.client.handle_connect();
    }

    pub(crate) fn handle_disconnect(&mut self, now: SimTime) {
        self.is_connected = false;
        self.call_at = now + PAUSE;
        self.client.handle_disconnect();
    }

    /// Bytes of the controller; whether the connection is still of use.
    pub(crate) fn handle_input(&mut self, now: SimTime, bytes: &[u8]) -> bool {
        let result = self.client.handle_input(now, bytes);
        if let Err(error) = &result {
            self.notices
                .push(format!("data block of the controller: {error}"));
            self.handle_disconnect(now);
        }
        result.is_ok()
    }

    pub(crate) fn handle_reply(&mut self, now: SimTime, bytes: &[u8]) {
        self.client.handle_reply(now, bytes);
    }

    pub(crate) fn handle_timeout(&mut self, now: SimTime) {
        self.client.handle_timeout(now);
        self.requests
            .extend(std::iter::from_fn(|| self.client.poll_request()));
        self.notices
            .extend(std::iter::from_fn(|| self.client.poll_notice()));
    }

    pub(crate) fn poll_output(&mut self) -> Option<Vec<u8>> {
        self.client.poll_output()
    }

    /// The next message for the session, which is opened first.
    pub(crate) fn poll_message(&mut self) -> Option<ToServer> {
        if !self.is_session_open {
            self.is_session_open = true;
            return Some(ToServer::Connect);
        }
        self.requests.pop_front().map(ToServer::Bytes)
    }
}
