use depal_time::{SimDuration, SimTime};

use crate::incoming::{Arrived, Framing};
use crate::memory::ElementMemory;
use crate::{
    ChannelConfig, EkiError, ElementValue, ReceiveFormat, SendFormat, SignalTarget, Status,
};

/// A record or document that began and got no more bytes for so long is given up, and the connection with it.
/// Our choice: nothing documents it.
pub const UNFINISHED_LIMIT: SimDuration = SimDuration::from_millis(10_000);

/// What the owner of a channel has to do or may tell.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// A flag or output gets a value: the connection came or went, or a record arrived.
    Signal {
        /// Which.
        target: SignalTarget,
        /// Its value.
        value: bool,
    },
    /// A record or document is in the memories.
    Arrived {
        /// How many there were on this channel, from 1.
        counter: u64,
    },
    /// A document could be read and does not fit the configuration: it was dropped, the connection stays.
    Refused(EkiError),
}

/// One connection as its program sees it: memories, flags, what is to be sent. Plain data.
#[derive(Debug, Clone)]
pub struct Channel {
    pub(crate) config: ChannelConfig,
    framing: Framing,
    /// One for each configured element of RECEIVE; none for those that only signal.
    pub(crate) memories: Vec<Option<ElementMemory>>,
    /// One for each configured element of SEND.
    pub(crate) values: Vec<Option<ElementValue>>,
    pub(crate) connected: bool,
    /// What ended the connection, until a call has told the program.
    pub(crate) trouble: Option<EkiError>,
    /// Bytes that wait for the end of a lock.
    held: Option<Vec<u8>>,
    counter: u64,
    last_byte_at: SimTime,
    pub(crate) outgoing: Vec<u8>,
    events: Vec<Event>,
}

impl Channel {
    /// An unconnected channel with empty memories.
    pub fn new(config: ChannelConfig) -> Self {
        let limit = config.buffering.limit;
        let memories = match &config.receive {
            ReceiveFormat::Nothing => Vec::new(),
            ReceiveFormat::Raw(raw) => vec![Some(ElementMemory::new(&raw.tag, raw.mode, limit))],
            ReceiveFormat::Xml(elements) => elements
                .iter()
                .map(|e| e.kind.map(|_| ElementMemory::new(&e.tag, e.mode, limit)))
                .collect(),
        };
        let values = match &config.send {
            SendFormat::Xml(elements) => vec![None; elements.len()],
            SendFormat::Nothing | SendFormat::Raw(_) => Vec::new(),
        };
        Self {
            framing: Framing::new(&config),
            config,
            memories,
            values,
            connected: false,
            trouble: None,
            held: None,
            counter: 0,
            last_byte_at: SimTime::ZERO,
            outgoing: Vec::new(),
            events: Vec::new(),
        }
    }

    /// The configuration.
    pub fn config(&self) -> &ChannelConfig {
        &self.config
    }

    /// Whether there is a connection.
    pub fn is_connected(&self) -> bool {
        self.connected
    }

    /// The socket is connected. An unfinished record of an earlier connection is forgotten, whole ones stay.
    pub fn connect(&mut self, now: SimTime) {
        self.framing = Framing::new(&self.config);
        self.outgoing.clear();
        self.last_byte_at = now;
        self.set_connected(true);
    }

    /// The peer or the network closed the connection. The next call that asks for it tells the program, once.
    pub fn lose_connection(&mut self) {
        if self.connected {
            self.end(Some(EkiError::ConnectionLost));
        }
    }

    /// The program closed the connection.
    pub fn close(&mut self) {
        self.end(None);
        self.trouble = None;
    }

    /// Forgets all values, received or to be sent, and what went wrong. Closes.
    pub fn clear(&mut self) {
        self.close();
        for memory in self.memories.iter_mut().flatten() {
            memory.clear();
        }
        self.values.fill(None);
        self.held = None;
        self.counter = 0;
    }

    fn end(&mut self, trouble: Option<EkiError>) {
        self.framing = Framing::new(&self.config);
        self.outgoing.clear();
        if let Some(held) = &mut self.held {
            held.clear();
        }
        if trouble.is_some() {
            self.trouble = trouble;
        }
        self.set_connected(false);
    }

    fn set_connected(&mut self, connected: bool) {
        if self.connected == connected {
            return;
        }
        self.connected = connected;
        for target in &self.config.alive.signals {
            self.events.push(Event::Signal {
                target: *target,
                value: connected,
            });
        }
    }

    /// Takes what arrived, in pieces of any size.
    ///
    /// # Errors
    /// What ends the connection: the owner closes the socket. Whatever was whole before it is in the memories.
    pub fn receive(&mut self, bytes: &[u8], now: SimTime) -> Result<(), EkiError> {
        if !self.connected {
            return Err(EkiError::NotConnected);
        }
        if !bytes.is_empty() {
            self.last_byte_at = now;
        }
        if let Some(held) = &mut self.held {
            held.extend_from_slice(bytes);
            let limit = self.config.buffer_bytes;
            if held.len() > limit {
                return self.give_up(EkiError::TooManyBytes { limit });
            }
            return Ok(());
        }
        self.interpret(bytes, now)
    }

    /// Gives up a record that does not go on. To be called now and then.
    ///
    /// # Errors
    /// As [`receive`](Self::receive).
    pub fn poll(&mut self, now: SimTime) -> Result<(), EkiError> {
        let bytes = self.framing.pending();
        let silence = now.saturating_since(self.last_byte_at);
        if !self.connected || bytes == 0 || silence < UNFINISHED_LIMIT {
            return Ok(());
        }
        self.give_up(EkiError::Unfinished {
            bytes,
            silence_ms: silence.as_nanos() / 1_000_000,
        })
    }

    fn give_up(&mut self, error: EkiError) -> Result<(), EkiError> {
        self.end(Some(error.clone()));
        Err(error)
    }

    fn interpret(&mut self, bytes: &[u8], now: SimTime) -> Result<(), EkiError> {
        for byte in bytes {
            match self.framing.push(*byte) {
                Ok(None) => {}
                Ok(Some(Ok(arrived))) => self.store(arrived, now)?,
                Ok(Some(Err(refused))) => self.events.push(Event::Refused(refused)),
                Err(error) => return self.give_up(error),
            }
        }
        Ok(())
    }

    /// Puts a record into the memories, whole or not at all.
    fn store(&mut self, arrived: Arrived, now: SimTime) -> Result<(), EkiError> {
        for (index, memory) in self.memories.iter().enumerate() {
            let more = arrived.values.iter().filter(|(i, _)| *i == index).count();
            if let Some(Err(full)) = memory.as_ref().map(|memory| memory.has_room(more)) {
                return self.give_up(full);
            }
        }
        self.counter += 1;
        for (index, value) in arrived.values {
            if let Some(memory) = &mut self.memories[index] {
                memory.push(value, self.counter, now);
            }
        }
        for index in arrived.present {
            let signals = match &self.config.receive {
                ReceiveFormat::Nothing => continue,
                ReceiveFormat::Raw(raw) => &raw.signals,
                ReceiveFormat::Xml(elements) => &elements[index].signals,
            };
            for target in signals {
                self.events.push(Event::Signal {
                    target: *target,
                    value: true,
                });
            }
        }
        self.events.push(Event::Arrived {
            counter: self.counter,
        });
        Ok(())
    }

    /// Whether a value of the record of this number (that of [`Event::Arrived`]) has not been read yet.
    pub fn has_unread(&self, counter: u64) -> bool {
        let mut memories = self.memories.iter().flatten();
        memories.any(|memory| memory.holds(counter))
    }

    /// What has happened since the last call, in order.
    pub fn take_events(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.events)
    }

    /// Bytes for the socket.
    pub fn take_outgoing(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.outgoing)
    }

    /// From now on what arrives is kept as bytes, at most `BUFFSIZE` of them (`EKI_Lock`).
    pub fn lock(&mut self) -> Status {
        self.held.get_or_insert_default();
        self.done(0, 0)
    }

    /// What was kept is interpreted (`EKI_Unlock`).
    ///
    /// # Errors
    /// As [`receive`](Self::receive).
    pub fn unlock(&mut self, now: SimTime) -> Result<(), EkiError> {
        let held = self.held.take().unwrap_or_default();
        self.interpret(&held, now)
    }
}
