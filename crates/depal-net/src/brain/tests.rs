use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use depal_cell::event::Event;
use depal_cell::station::StationReply;
use depal_interface::{ConnectionId, Encoding, LogEntry, PortId};

use super::{Brain, BrainLink, Letter, ToBrain};
use crate::SessionHost;

/// Writes down when it is told what.
struct Diary {
    tick: u64,
    /// Ticks and bytes.
    received: Arc<Mutex<Vec<(u64, Vec<u8>)>>>,
}

impl SessionHost for Diary {
    fn encodings(&self) -> Vec<Encoding> {
        vec![Encoding::Ascii]
    }
    fn tick(&self) -> u64 {
        self.tick
    }
    fn connect(&mut self, _: PortId, _: ConnectionId) {}
    fn receive(&mut self, _: PortId, _: ConnectionId, bytes: &[u8]) {
        let mut received = self.received.lock().expect("no panic");
        received.push((self.tick, bytes.to_vec()));
    }
    fn disconnect(&mut self, _: PortId, _: ConnectionId) {}
    fn is_waiting(&self, _: PortId, _: ConnectionId) -> bool {
        false
    }
    fn awaits_run(&self, _: PortId, _: ConnectionId) -> bool {
        false
    }
    fn next_due(&self) -> Option<u64> {
        None
    }
    fn advance(&mut self, target: u64) -> u64 {
        self.tick = self.tick.max(target);
        self.tick
    }
    fn poll_reply(&mut self) -> Option<StationReply> {
        None
    }
    fn poll_log(&mut self) -> Option<LogEntry> {
        None
    }
    fn poll_event(&mut self) -> Option<(PortId, Event)> {
        None
    }
}

/// What waits in the queue while the brain is kept from running is told at the times at which it was sent.
#[test]
fn letters_are_dealt_with_as_of_when_they_were_sent() {
    let (link, letters) = BrainLink::new();
    let received = Arc::default();
    let diary = Diary {
        tick: 0,
        received: Arc::clone(&received),
    };
    let client = (PortId(0), ConnectionId(1));
    let (sender, _turns) = tokio::sync::mpsc::unbounded_channel();
    let peer = "127.0.0.1:1".parse().expect("an address");
    link.send(ToBrain::Connected(client, peer, sender));
    // Later than the brain begins, however slow the computer is; 40 ms apart.
    let first = Instant::now() + Duration::from_hours(1);
    for (after_ms, byte) in [(0, b'1'), (40, b'2'), (30, b'3'), (80, b'4')] {
        let sent = first + Duration::from_millis(after_ms);
        let message = ToBrain::Bytes(client, vec![byte]);
        assert!(link.0.send(Letter { sent, message }).is_ok());
    }
    link.send(ToBrain::Stop);
    Brain::new(diary, None, Arc::new(|_| {}), letters)
        .run()
        .expect("no journal that could fail");
    let received = received.lock().expect("no panic");
    let from = received[0].0;
    let after: Vec<_> = received.iter().map(|(t, b)| (t - from, b[0])).collect();
    // Time never goes back.
    assert_eq!(after, [(0, b'1'), (10, b'2'), (10, b'3'), (20, b'4')]);
}
