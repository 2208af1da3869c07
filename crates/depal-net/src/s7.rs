//! Siemens controllers over TCP: a client that works on a controller's data block, and a server that offers
//! the block itself.
//!
//! Both drive the same [`depal_interface::Handshake`]; behind it is an ordinary session of the station.
//! The session outlives the controller's connection: results wait for it.

mod address;
mod client;
mod error;
mod poller;
mod server;
mod session;

pub use address::PlcAddress;
pub use client::S7Client;
pub use error::S7LinkError;

pub(crate) use poller::poll_plc;
pub(crate) use server::serve_block;
pub(crate) use session::SessionLink;

use std::time::Instant;

use depal_interface::PortId;
use depal_time::SimTime;

use crate::Notice;
use crate::brain::Notices;

/// Tells people about a port.
#[derive(Clone)]
pub(crate) struct Teller {
    pub(crate) port: PortId,
    pub(crate) notices: Notices,
}

impl Teller {
    fn tell(&self, text: String) {
        let port = self.port;
        (self.notices)(Notice::Plc { port, text });
    }
}

/// The wall clock as the handshake wants it, from 0.
#[derive(Debug, Clone, Copy)]
struct WallClock(Instant);

impl WallClock {
    fn start() -> Self {
        Self(Instant::now())
    }

    fn now(self) -> SimTime {
        SimTime::from_nanos(self.0.elapsed().as_nanos() as u64)
    }

    fn instant(self, time: SimTime) -> tokio::time::Instant {
        let since = std::time::Duration::from_nanos(time.as_nanos());
        tokio::time::Instant::from_std(self.0 + since)
    }
}

#[cfg(test)]
mod tests;
