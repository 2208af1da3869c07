//! The thread that owns the station: it takes what clients send, tells the time, and gives replies out.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use depal_interface::{ConnectionId, PortId};
use depal_time::{SimTime, TICK};
use tokio::sync::mpsc::UnboundedSender;

use crate::NetError;
use crate::clock::PacedClock;
use crate::journal::{Entry, Journal, What};
use crate::notice::Notice;
use crate::session_host::SessionHost;

#[cfg(test)]
mod tests;

/// Messages taken in one go before replies leave: their journal lines share one write.
const BATCH: usize = 64;
/// While a result is awaited it is asked for this often.
const RESULT_POLL: Duration = Duration::from_millis(1);
/// With nothing due the thread sleeps until a message comes; this only bounds the arithmetic.
const LONGEST_SLEEP: Duration = Duration::from_mins(1);

/// A client, for the brain.
pub(crate) type Client = (PortId, ConnectionId);

/// Takes notices.
pub(crate) type Notices = Arc<dyn Fn(Notice) + Send + Sync>;

/// What tells the brain.
pub(crate) enum ToBrain {
    Connected(Client, SocketAddr, UnboundedSender<Turn>),
    /// A few commands; answered by a [`Turn`] that acknowledges them.
    Bytes(Client, Vec<u8>),
    /// The client has closed its sending side.
    HalfClosed(Client),
    Disconnected(Client, String),
    Stop,
}

/// A message to the brain, and when it was sent. What the brain finds in its queue after it was kept from running
/// is dealt with as of then: the computer's pauses are not taken for a client's silence.
pub(crate) struct Letter {
    pub(crate) sent: Instant,
    pub(crate) message: ToBrain,
}

/// The way to the brain.
#[derive(Clone)]
pub(crate) struct BrainLink(Sender<Letter>);

impl BrainLink {
    pub(crate) fn new() -> (Self, Receiver<Letter>) {
        let (sender, letters) = channel();
        (Self(sender), letters)
    }

    /// Whether the brain is still there to read it.
    pub(crate) fn send(&self, message: ToBrain) -> bool {
        let sent = Instant::now();
        self.0.send(Letter { sent, message }).is_ok()
    }
}

/// What the brain tells a client's task.
#[derive(Debug, Default)]
pub(crate) struct Turn {
    /// Each to be sent in one write.
    pub(crate) replies: Vec<Vec<u8>>,
    /// The bytes handed over have been taken.
    pub(crate) acknowledges: bool,
    /// A command waits for a run to end.
    pub(crate) is_waiting: bool,
    /// Close after the replies.
    pub(crate) closes: bool,
}

struct Peer {
    sender: UnboundedSender<Turn>,
    is_half_closed: bool,
    turn: Option<Turn>,
}

pub(crate) struct Brain<H> {
    pub(crate) station: H,
    pub(crate) journal: Option<Journal>,
    pub(crate) notices: Notices,
    pub(crate) letters: Receiver<Letter>,
    peers: BTreeMap<Client, Peer>,
}

impl<H: SessionHost> Brain<H> {
    pub(crate) fn new(
        station: H,
        journal: Option<Journal>,
        notices: Notices,
        letters: Receiver<Letter>,
    ) -> Self {
        Self {
            station,
            journal,
            notices,
            letters,
            peers: BTreeMap::new(),
        }
    }

    /// Runs until it is told to stop, or all who could tell are gone.
    pub(crate) fn run(mut self) -> Result<(), NetError> {
        let mut clock = PacedClock::new(self.station.tick());
        loop {
            let mut is_over = false;
            let mut next = match self.letters.recv_timeout(self.sleep(&clock)) {
                Ok(letter) => Some(letter),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => {
                    is_over = true;
                    None
                }
            };
            for _ in 0..BATCH {
                let looked = Instant::now();
                let Some(letter) = next.take().or_else(|| self.letters.try_recv().ok()) else {
                    self.tell_time(&mut clock, looked);
                    break;
                };
                self.tell_time(&mut clock, letter.sent);
                is_over |= self.take(letter.message);
            }
            if is_over {
                self.record(None, What::Ended {});
            }
            if let Some(journal) = &mut self.journal {
                journal.flush().map_err(NetError::Journal)?;
            }
            self.hand_out();
            if is_over {
                return Ok(());
            }
        }
    }

    /// Until something is due.
    fn sleep(&self, clock: &PacedClock) -> Duration {
        let Some(due) = self.station.next_due() else {
            return LONGEST_SLEEP;
        };
        let until = clock.until(due);
        if until.is_zero() {
            RESULT_POLL
        } else {
            until.min(LONGEST_SLEEP)
        }
    }

    /// It is `at`, or later if more has been told already.
    fn tell_time(&mut self, clock: &mut PacedClock, at: Instant) {
        let target = clock.tick_at(at);
        let reached = self.station.advance(target);
        self.collect();
        if reached < target {
            clock.go_on_from(reached);
        }
    }

    /// Whether this was the order to stop.
    fn take(&mut self, message: ToBrain) -> bool {
        match message {
            ToBrain::Connected(client, peer, sender) => {
                let what = What::Connected {
                    peer: peer.to_string(),
                };
                self.record(Some(client), what);
                let (port, id) = client;
                (self.notices)(Notice::Connected {
                    port,
                    client: id,
                    peer,
                });
                let peer = Peer {
                    sender,
                    is_half_closed: false,
                    turn: None,
                };
                self.peers.insert(client, peer);
                self.station.connect(port, id);
            }
            ToBrain::Bytes(client, _) if !self.peers.contains_key(&client) => {}
            ToBrain::Bytes(client, bytes) => {
                let (port, id) = client;
                self.record(Some(client), What::received(&bytes));
                self.station.receive(port, id, &bytes);
                (self.notices)(Notice::RawReceived {
                    at: self.now(),
                    port,
                    client: id,
                    bytes,
                });
                if let Some(turn) = self.turn(client) {
                    turn.acknowledges = true;
                }
                if self.station.awaits_run(port, id) {
                    self.dismiss_half_closed(client);
                }
            }
            ToBrain::HalfClosed(client) => {
                if let Some(peer) = self.peers.get_mut(&client) {
                    peer.is_half_closed = true;
                }
            }
            ToBrain::Disconnected(client, reason) => self.forget(client, reason),
            ToBrain::Stop => return true,
        }
        self.collect();
        false
    }

    /// A client waits for the result of a run. Others of its port that wait, too, but have closed their
    /// sending side, are most likely gone: the result goes to the one that is there.
    fn dismiss_half_closed(&mut self, newcomer: Client) {
        let gone: Vec<Client> = self
            .peers
            .iter()
            .filter(|(client, peer)| {
                **client != newcomer && client.0 == newcomer.0 && peer.is_half_closed
            })
            .map(|(client, _)| *client)
            .filter(|(port, id)| self.station.awaits_run(*port, *id))
            .collect();
        for client in gone {
            let turn = Turn {
                closes: true,
                ..Turn::default()
            };
            if let Some(peer) = self.peers.get(&client) {
                let _ = peer.sender.send(turn);
            }
            let reason = "closed its side, and another client waits for the result".to_owned();
            self.forget(client, reason);
        }
    }

    fn forget(&mut self, client: Client, reason: String) {
        if self.peers.remove(&client).is_some() {
            let (port, id) = client;
            self.record(Some(client), What::Disconnected {});
            self.station.disconnect(port, id);
            (self.notices)(Notice::Disconnected {
                port,
                client: id,
                reason,
            });
        }
    }

    /// What the station says: into the journal, to people, and ready for the clients.
    fn collect(&mut self) {
        while let Some(entry) = self.station.poll_log() {
            (self.notices)(Notice::Message(entry));
        }
        while let Some((port, event)) = self.station.poll_event() {
            (self.notices)(Notice::Happened(port, event));
        }
        while let Some(reply) = self.station.poll_reply() {
            let client = (reply.port, reply.connection);
            if let Some(journal) = &mut self.journal {
                let entry = Entry {
                    tick: reply.tick,
                    port: reply.port.0,
                    client: reply.connection.0,
                    what: What::sent(&reply.bytes),
                };
                // A failing write shows at the flush, before the reply leaves.
                let _ = journal.add(&entry);
            }
            (self.notices)(Notice::RawSent {
                at: self.now(),
                port: reply.port,
                client: reply.connection,
                bytes: reply.bytes.clone(),
            });
            if let Some(turn) = self.turn(client) {
                turn.replies.push(reply.bytes);
                turn.closes |= reply.closes;
            }
        }
    }

    /// What the client will be told next; `None` if it is gone.
    fn turn(&mut self, client: Client) -> Option<&mut Turn> {
        let peer = self.peers.get_mut(&client)?;
        Some(peer.turn.get_or_insert_default())
    }

    fn hand_out(&mut self) {
        for ((port, id), peer) in &mut self.peers {
            if let Some(mut turn) = peer.turn.take() {
                turn.is_waiting = self.station.is_waiting(*port, *id);
                // Fails if the task has just ended; it has told so, or will.
                let _ = peer.sender.send(turn);
            }
        }
    }

    fn record(&mut self, client: Option<Client>, what: What) {
        if let Some(journal) = &mut self.journal {
            let (port, id) = client.map_or((0, 0), |(port, id)| (port.0, id.0));
            let entry = Entry {
                tick: self.station.tick(),
                port,
                client: id,
                what,
            };
            let _ = journal.add(&entry);
        }
    }

    fn now(&self) -> SimTime {
        SimTime::from_nanos(self.station.tick() * TICK.as_nanos())
    }
}
