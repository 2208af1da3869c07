use std::collections::{BTreeMap, VecDeque};
use std::task::Poll;

use depal_time::SimTime;
use depal_vm::system::{Fault, Received, SocketId};

use super::{Exchange, Transcript};
use crate::Network;

/// A network that plays the other side of a transcript. Connections are taken in their order; what the program
/// receives comes as long after its own last act (connecting or sending) as it did then.
///
/// A program that sends something else than it did then finds the connection closed, and
/// [`difference`](Self::difference) tells what.
#[derive(Debug, Clone)]
pub struct ReplayNetwork {
    script: BTreeMap<u32, VecDeque<(SimTime, Exchange)>>,
    sockets: BTreeMap<SocketId, Replayed>,
    count: u32,
    difference: Option<String>,
}

/// A connection being replayed.
#[derive(Debug, Clone)]
struct Replayed {
    rest: VecDeque<(SimTime, Exchange)>,
    connection: u32,
    /// Sent by the program and not yet found in the transcript, or the other way about.
    ahead: VecDeque<u8>,
    /// When the program last acted: then, and now.
    acted: (SimTime, SimTime),
}

impl ReplayNetwork {
    /// The other side of a transcript.
    pub fn new(transcript: &Transcript) -> Self {
        let mut script: BTreeMap<u32, VecDeque<(SimTime, Exchange)>> = BTreeMap::new();
        for line in &transcript.lines {
            let lines = script.entry(line.connection).or_default();
            lines.push_back((line.at, line.exchange.clone()));
        }
        Self {
            script,
            sockets: BTreeMap::new(),
            count: 0,
            difference: None,
        }
    }

    /// What the program did otherwise than then, if anything: the first difference.
    pub fn difference(&self) -> Option<&str> {
        self.difference.as_deref()
    }

    fn differ(&mut self, now: SimTime, connection: u32, what: &str) {
        self.difference.get_or_insert_with(|| {
            format!(
                "{:.3} s, connection {connection}: {what}",
                now.as_secs_f64()
            )
        });
    }
}

impl Network for ReplayNetwork {
    fn connect(
        &mut self,
        now: SimTime,
        _: &str,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Poll<Result<(), Fault>> {
        self.count += 1;
        let connection = self.count;
        let refused = Poll::Ready(Err(Fault::SocketClosed));
        let Some(mut rest) = self.script.remove(&connection) else {
            self.differ(now, connection, "the transcript has no such connection");
            return refused;
        };
        let (at, known) = match rest.pop_front() {
            Some((at, Exchange::Connected(host, known))) => (at, (host, known)),
            Some((_, Exchange::Refused(..))) => return refused,
            _ => {
                self.differ(
                    now,
                    connection,
                    "the transcript does not begin with a connection",
                );
                return refused;
            }
        };
        if known != (address.to_owned(), port) {
            let (host, known) = known;
            self.differ(
                now,
                connection,
                &format!("connects to {address}:{port}, then to {host}:{known}"),
            );
        }
        let replayed = Replayed {
            rest,
            connection,
            ahead: VecDeque::new(),
            acted: (at, now),
        };
        self.sockets.insert(socket, replayed);
        Poll::Ready(Ok(()))
    }

    fn send(&mut self, now: SimTime, _: &str, socket: SocketId, bytes: &[u8]) -> Result<(), Fault> {
        let Some(replayed) = self.sockets.get_mut(&socket) else {
            return Err(Fault::SocketClosed);
        };
        // A message may be sent in other pieces than then.
        for byte in bytes {
            if replayed.ahead.is_empty()
                && let Some((at, Exchange::Sent(expected))) = replayed.rest.front()
            {
                replayed.acted = (*at, now);
                replayed.ahead.extend(expected);
                replayed.rest.pop_front();
            }
            let expected = replayed.ahead.pop_front();
            if expected != Some(*byte) {
                let connection = replayed.connection;
                let then = expected.map_or("nothing".to_owned(), |b| format!("{b:02x}"));
                self.sockets.remove(&socket);
                self.differ(now, connection, &format!("sends {byte:02x}, then {then}"));
                return Err(Fault::SocketClosed);
            }
        }
        Ok(())
    }

    fn receive(&mut self, now: SimTime, _: &str, socket: SocketId, limit: usize) -> Poll<Received> {
        let Some(replayed) = self.sockets.get_mut(&socket) else {
            return Poll::Ready(Received::Closed);
        };
        let (then, since) = replayed.acted;
        let due = |at: SimTime| now.saturating_since(since) >= at.saturating_since(then);
        match replayed.rest.front_mut() {
            Some((at, Exchange::Received(bytes))) if due(*at) => {
                let count = limit.min(bytes.len());
                let given = bytes.drain(..count).collect();
                if bytes.is_empty() {
                    replayed.rest.pop_front();
                }
                Poll::Ready(Received::Data(given))
            }
            Some((at, Exchange::PeerClosed)) if due(*at) => Poll::Ready(Received::Closed),
            // Nothing came any more: then the program waited, too.
            _ => Poll::Pending,
        }
    }

    fn close(&mut self, _: SimTime, _: &str, socket: SocketId) {
        self.sockets.remove(&socket);
    }
}
