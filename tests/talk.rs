//! A client without a robot, by ASCII commands in simulated time: it is where it says it is.

use std::sync::Arc;

use depal_cell::spec::CellSpec;
use depal_cell::station::{Errand, Station};
use depal_interface::{ConnectionId, PortId};

const PORT: PortId = PortId(0);
const CLIENT: ConnectionId = ConnectionId(1);

pub struct Talk(pub Station);

impl Talk {
    pub fn new(spec: CellSpec) -> Self {
        let at_once = Arc::new(|errand: Errand| errand());
        let mut station = Station::new(spec, || 0.0, at_once).unwrap();
        station.connect(PORT, CLIENT);
        Self(station)
    }

    /// The reply's numbers behind the command; the wait is at most 20 s of simulated time.
    pub fn ask(&mut self, request: &str) -> Vec<f64> {
        let station = &mut self.0;
        station.receive(PORT, CLIENT, format!("{request}\r").as_bytes());
        let end = station.tick() + 5_000;
        let reply = loop {
            if let Some(reply) = station.poll_reply() {
                break reply;
            }
            assert!(station.tick() < end, "no answer to {request}");
            station.advance_waiting(station.tick() + 1);
        };
        let text = String::from_utf8(reply.bytes).unwrap();
        let mut cells = text.trim().split(',').map(|cell| cell.parse().unwrap());
        let command: f64 = cells.next().unwrap();
        assert!(
            request.starts_with(&command.to_string()),
            "{request}: {text}"
        );
        cells.collect()
    }

    pub fn says(&mut self, request: &str, status: i32) {
        let found = self.ask(request);
        assert_eq!(found[0], f64::from(status), "{request}");
    }
}
