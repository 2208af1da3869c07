//! Replies on their way out, with what scripted faults make of them.

use depal_time::{SimTime, TICK};
use depal_wire::{Reply, Status};

use crate::faults::ReplyFate;
use crate::log::Direction;
use crate::session::{ConnectionId, LOG_TEXT_LEN, Session};
use crate::settings::PortId;

/// Bytes to send, in one write.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outgoing {
    /// The port.
    pub port: PortId,
    /// The connection.
    pub connection: ConnectionId,
    /// One whole reply.
    pub bytes: Vec<u8>,
    /// The command answered; 0 if it was unreadable.
    pub command: i32,
    /// The status code; 601 has none, nor has a reply that a scripted fault withholds.
    pub status: Option<Status>,
    /// The connection is to be closed after this.
    pub closes: bool,
}

/// A reply, or a piece of it, until its time comes.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    pub(crate) due: SimTime,
    pub(crate) outgoing: Outgoing,
    /// What the log says when it leaves; only the first piece of a reply is told of.
    text: Option<String>,
    /// The scripted faults that hit it.
    faults: Vec<String>,
}

impl Session {
    pub(crate) fn send(
        &mut self,
        now: SimTime,
        connection: ConnectionId,
        reply: &Reply,
        closes: bool,
    ) {
        self.send_because(now, connection, reply, closes, Vec::new());
    }

    /// Sends a reply that has `causes` among the scripted faults; more of them may hit it now.
    pub(crate) fn send_because(
        &mut self,
        now: SimTime,
        connection: ConnectionId,
        reply: &Reply,
        closes: bool,
        mut causes: Vec<String>,
    ) {
        // A connection that is cut anyway is no occasion for a fault.
        let fate = if closes {
            ReplyFate::default()
        } else {
            self.faults.on_reply(reply.command())
        };
        causes.extend(fate.causes);
        let status = reply.verdict();
        let meaning = status.map_or("message", Status::meaning);
        let mut text = format!("{} ({meaning})", reply.text_head(LOG_TEXT_LEN + 1));
        if !causes.is_empty() {
            text = format!("[fault {}] {text}", causes.join("; "));
        }
        let whole = Outgoing {
            port: self.port,
            connection,
            bytes: reply.encode(self.encoding_of(connection), &self.settings.profile),
            command: reply.command(),
            status,
            closes,
        };
        if fate.drops {
            self.connections.remove(&connection);
            let nothing = Outgoing {
                bytes: Vec::new(),
                status: None,
                closes: true,
                ..whole
            };
            self.hold(now + fate.delay, nothing, Some(text), causes);
        } else if fate.splits {
            let mut due = now + fate.delay;
            let mut text = Some(text);
            for bytes in pieces(&whole.bytes) {
                let piece = Outgoing {
                    bytes: bytes.to_vec(),
                    ..whole.clone()
                };
                self.hold(due, piece, text.take(), std::mem::take(&mut causes));
                due += TICK;
            }
        } else {
            self.hold(now + fate.delay, whole, Some(text), causes);
        }
        self.release(now);
    }

    fn hold(
        &mut self,
        due: SimTime,
        outgoing: Outgoing,
        text: Option<String>,
        faults: Vec<String>,
    ) {
        self.held.push(Held {
            due,
            outgoing,
            text,
            faults,
        });
    }

    /// Lets go what is due, in the order in which it was answered.
    pub(crate) fn release(&mut self, now: SimTime) {
        while let Some(place) = self.held.iter().position(|h| h.due <= now) {
            let Held {
                outgoing,
                text,
                faults,
                ..
            } = self.held.remove(place);
            if let Some(text) = text {
                let status = outgoing.status.map(Status::code);
                self.record(
                    now,
                    outgoing.connection,
                    Direction::Sent,
                    outgoing.command,
                    status,
                    text,
                );
                if let Some(entry) = self.log.back_mut() {
                    entry.faults = faults;
                }
            }
            self.replies.push_back(outgoing);
        }
    }
}

/// One byte, half of the rest, and the rest: a client that reads once gets the least it can.
fn pieces(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let (first, rest) = bytes.split_at(bytes.len().min(1));
    let (second, third) = rest.split_at(rest.len() / 2);
    [first, second, third]
        .into_iter()
        .filter(|piece| !piece.is_empty())
}
