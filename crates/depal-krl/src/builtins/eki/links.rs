//! The channels of a program and their sockets. Plain data: a socket is a number of the cabinet.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::task::Poll;

use depal_eki::{Channel, ChannelConfig, EkiError, Event, Peer, SignalKind, SignalTarget, Status};
use depal_time::{SimDuration, SimTime};
use depal_vm::system::System;

use super::link::Link;

/// A flag that is reset while an older record still waits to be read rises again after so long, one interpolation
/// cycle of the controller: whoever watches the flag sees each of its edges.
const RISES_AGAIN: SimDuration = SimDuration::from_millis(12);
/// Most records that one flag remembers.
const MOST_LATE: usize = 512;

/// A record that arrived: its channel, and its number there; none if it has no values that could be read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Record {
    channel: String,
    counter: Option<u64>,
}

/// What the program's flags, outputs and messages must hear.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Notice {
    /// A flag or output gets a value.
    Signal(SignalTarget, bool),
    /// A record arrived that this flag tells of.
    Arrival(u32, Record),
    /// A line for the operator.
    Message(String),
}

/// The configuration files that a program was loaded with, and the channels that it has initialised.
#[derive(Debug, Clone, Default)]
pub(crate) struct Links {
    files: BTreeMap<String, Arc<ChannelConfig>>,
    open: BTreeMap<String, Link>,
    notices: Vec<Notice>,
    /// Records that came while their flag was on, by the number of the flag.
    late: BTreeMap<u32, VecDeque<Record>>,
    /// Flags that were reset and rise again, and when.
    due: BTreeMap<u32, SimTime>,
}

impl Links {
    pub(crate) fn new(files: BTreeMap<String, Arc<ChannelConfig>>) -> Self {
        Self {
            files,
            ..Self::default()
        }
    }

    /// What has happened since the last call, in order.
    pub(super) fn take_notices(&mut self) -> Vec<Notice> {
        std::mem::take(&mut self.notices)
    }

    /// A record came while its flag was on: the flag rises again for it when it has been reset.
    pub(super) fn note_late(&mut self, flag: u32, record: Record) {
        let late = self.late.entry(flag).or_default();
        if late.len() < MOST_LATE {
            late.push_back(record);
        }
    }

    /// The program has reset a flag.
    pub(super) fn flag_was_reset(&mut self, flag: u32, system: &dyn System) {
        if self.late.contains_key(&flag) {
            self.due.insert(flag, system.now() + RISES_AGAIN);
        }
    }

    /// Raises flags again for records that nobody has read meanwhile.
    fn raise_again(&mut self, system: &dyn System) {
        if self.due.is_empty() {
            return;
        }
        let now = system.now();
        let due = self.due.iter().filter(|(_, at)| **at <= now);
        for flag in due.map(|(flag, _)| *flag).collect::<Vec<_>>() {
            self.due.remove(&flag);
            let mut late = self.late.remove(&flag).unwrap_or_default();
            while let Some(record) = late.pop_front() {
                if self.is_unread(&record) {
                    self.notices.push(Notice::Arrival(flag, record));
                    break;
                }
            }
            if !late.is_empty() {
                self.late.insert(flag, late);
            }
        }
    }

    fn is_unread(&self, record: &Record) -> bool {
        let link = self.open.get(&record.channel);
        link.is_some_and(|link| record.counter.is_none_or(|n| link.channel.has_unread(n)))
    }

    /// `EKI_Init`.
    pub(super) fn init(&mut self, name: &str) -> Status {
        let Some(config) = self.files.get(name) else {
            let known: Vec<_> = self.files.keys().map(String::as_str).collect();
            let known = if known.is_empty() {
                "none".to_owned()
            } else {
                known.join(", ")
            };
            return self.report(
                name,
                Status::failed(
                    EkiError::NoFile {
                        name: name.to_owned(),
                        known,
                    },
                    false,
                ),
            );
        };
        if let Some(link) = self.open.get(name) {
            let error = EkiError::AlreadyInitialised {
                name: name.to_owned(),
            };
            let status = Status::failed(error, link.channel.is_connected());
            return self.report(name, status);
        }
        let link = Link {
            channel: Channel::new(ChannelConfig::clone(config)),
            socket: None,
            listener: None,
        };
        self.open.insert(name.to_owned(), link);
        Status::default()
    }

    /// `EKI_Open`: connects, or begins to listen. Asked again until ready.
    pub(super) fn open(
        &mut self,
        name: &str,
        started: SimTime,
        system: &mut dyn System,
    ) -> Poll<Status> {
        let Some(link) = self.open.get_mut(name) else {
            return Poll::Ready(self.not_there(name));
        };
        let status = match link.channel.config().peer {
            _ if link.channel.is_connected() || link.listener.is_some() => {
                Err(EkiError::AlreadyOpen)
            }
            Peer::Server => match link.connect(started, system) {
                Poll::Pending => return Poll::Pending,
                Poll::Ready(done) => done,
            },
            Peer::Client => link.listen(system),
        };
        let connected = link.channel.is_connected();
        self.gather(name);
        Poll::Ready(match status {
            Ok(()) => Status {
                connected,
                ..Status::default()
            },
            Err(error) => self.report(name, Status::failed(error, connected)),
        })
    }

    /// `EKI_Close`.
    pub(super) fn close(&mut self, name: &str, system: &mut dyn System) -> Status {
        let Some(link) = self.open.get_mut(name) else {
            return unknown(name);
        };
        link.hang_up(system);
        link.channel.close();
        self.gather(name);
        Status::default()
    }

    /// `EKI_Clear`: as if it had never been initialised.
    pub(super) fn clear(&mut self, name: &str, system: &mut dyn System) -> Status {
        let status = self.close(name, system);
        self.open.remove(name);
        for late in self.late.values_mut() {
            late.retain(|record| record.channel != name);
        }
        status
    }

    /// A call on an initialised channel. What it sends goes out; what went wrong is told.
    pub(super) fn with(
        &mut self,
        name: &str,
        system: &mut dyn System,
        call: impl FnOnce(&mut Channel) -> Status,
    ) -> Status {
        self.pump(system);
        let Some(link) = self.open.get_mut(name) else {
            return self.not_there(name);
        };
        let mut status = call(&mut link.channel);
        if let Err(error) = link.flush(system) {
            status = Status::failed(error, false);
        }
        self.gather(name);
        self.report(name, status)
    }

    /// Takes what has arrived on all channels, and who has come.
    pub(super) fn pump(&mut self, system: &mut dyn System) {
        self.raise_again(system);
        let names: Vec<String> = self.open.keys().cloned().collect();
        for name in names {
            if let Some(link) = self.open.get_mut(&name) {
                if let Err(error) = link.pump(system) {
                    self.tell(&name, &error);
                }
                self.gather(&name);
            }
        }
    }

    /// Turns the events of a channel into notices.
    fn gather(&mut self, name: &str) {
        let Some(link) = self.open.get_mut(name) else {
            return;
        };
        let alive = link.channel.config().alive.signals.clone();
        // Signals of a record stand before it.
        let mut flags = Vec::new();
        for event in link.channel.take_events() {
            match event {
                Event::Signal {
                    target,
                    value: true,
                } if target.kind == SignalKind::Flag && !alive.contains(&target) => {
                    flags.push(target.number);
                }
                Event::Signal { target, value } => {
                    self.notices.push(Notice::Signal(target, value));
                }
                Event::Arrived { counter } => {
                    let record = Record {
                        channel: name.to_owned(),
                        counter: link.channel.has_unread(counter).then_some(counter),
                    };
                    let flags = flags.drain(..);
                    self.notices
                        .extend(flags.map(|flag| Notice::Arrival(flag, record.clone())));
                }
                Event::Refused(error) => self.notices.push(message(name, &error)),
            }
        }
    }

    fn not_there(&mut self, name: &str) -> Status {
        let status = unknown(name);
        self.report(name, status)
    }

    /// Tells the operator what a status says, unless the file says not to. An empty memory is no more than an answer.
    fn report(&mut self, name: &str, status: Status) -> Status {
        if let Some(error) = &status.error
            && !matches!(error, EkiError::Empty { .. })
        {
            let error = error.clone();
            self.tell(name, &error);
        }
        status
    }

    fn tell(&mut self, name: &str, error: &EkiError) {
        if self.files.get(name).is_none_or(|file| file.show_errors) {
            self.notices.push(message(name, error));
        }
    }
}

fn message(name: &str, error: &EkiError) -> Notice {
    Notice::Message(format!("EKI{:05} {name}: {error}", error.number()))
}

fn unknown(name: &str) -> Status {
    let error = EkiError::NotAvailable {
        name: name.to_owned(),
    };
    Status::failed(error, false)
}
