use std::collections::VecDeque;

use depal_cell::station::{Station, StationReply};
use depal_interface::{ConnectionId, PortId};

use crate::journal::{Entry, What, from_hex};

/// What answering a journal again came to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Replayed {
    /// Replies that were compared, up to the first that differs.
    pub replies: usize,
    /// The first difference.
    pub difference: Option<Difference>,
}

/// The first reply that is not the recorded one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// Place in the list of entries, from 0; the number of entries if the station says more in the end.
    pub entry: usize,
    /// The recorded reply, if there was one.
    pub recorded: Option<StationReply>,
    /// The reply given now, if there is one.
    pub given: Option<StationReply>,
}

/// Gives the station what was received, at the same ticks, and compares what it answers.
/// Ticks count, too: a reply that comes later than recorded differs.
pub fn replay(station: &mut Station, entries: &[Entry]) -> Replayed {
    let mut given = VecDeque::new();
    let mut replies = 0;
    for (place, entry) in entries.iter().enumerate() {
        let (port, client) = (PortId(entry.port), ConnectionId(entry.client));
        station.advance_waiting(entry.tick);
        match &entry.what {
            What::Connected { .. } => station.connect(port, client),
            What::Received { hex, .. } => {
                let bytes = from_hex(hex).unwrap_or_default();
                station.receive(port, client, &bytes);
            }
            What::Disconnected {} => station.disconnect(port, client),
            What::Sent { .. } | What::Ended {} => {}
        }
        while let Some(reply) = station.poll_reply() {
            given.push_back(reply);
        }
        while station.poll_log().is_some() || station.poll_event().is_some() {}
        if let What::Sent { hex, .. } = &entry.what {
            let now: Option<StationReply> = given.pop_front();
            let recorded = StationReply {
                tick: entry.tick,
                port,
                connection: client,
                bytes: from_hex(hex).unwrap_or_default(),
                // Not recorded: whatever it is now.
                closes: now.as_ref().is_some_and(|reply| reply.closes),
            };
            if now.as_ref() != Some(&recorded) {
                let difference = Difference {
                    entry: place,
                    recorded: Some(recorded),
                    given: now,
                };
                return Replayed {
                    replies,
                    difference: Some(difference),
                };
            }
            replies += 1;
        }
    }
    let difference = given.pop_front().map(|reply| Difference {
        entry: entries.len(),
        recorded: None,
        given: Some(reply),
    });
    Replayed {
        replies,
        difference,
    }
}
