//! The state machine between block and session.

use std::collections::VecDeque;

use depal_time::{SimDuration, SimTime};
use depal_wire::s7::{BLOCK_BYTES, COMMAND_BYTES, DataBlock, Field, POINT_ROWS};
use depal_wire::{Encoding, Profile, Reply, Request, Status};

use super::command::request_of;
use super::result::{Image, Outcome};
use super::running::Running;

/// Longest single write, bytes: one telegram of the usual length, so that the heartbeat comes between two.
const LONGEST_WRITE: usize = 448;
/// A heartbeat that is late by more does not catch up.
const LATE_BEAT: SimDuration = SimDuration::from_millis(300);
/// Trigger left at 1 for so long after Acknowledge is a mistake in the controller's program.
const STUCK_TRIGGER: SimDuration = SimDuration::from_millis(10_000);
/// The greeting reads from Acknowledge to Status of Pose Sent.
const FLAGS_BYTES: usize = 10;

/// What a [`Handshake`] is set up with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HandshakeSettings {
    /// How often Trigger is looked at. Default 20 ms.
    pub poll_period: SimDuration,
    /// Between two changes of Heartbeat. Default 1 s.
    pub heartbeat: SimDuration,
    /// The profile of the session, see [`super::plc_port`].
    pub profile: Profile,
}

impl Default for HandshakeSettings {
    fn default() -> Self {
        Self {
            poll_period: SimDuration::from_millis(20),
            heartbeat: SimDuration::from_millis(1_000),
            profile: Profile::v1_8(),
        }
    }
}

/// What is to be done with the block next.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Transfer {
    /// Read bytes, then call [`Handshake::handle_read`].
    Read {
        /// First byte.
        first: usize,
        /// How many.
        len: usize,
    },
    /// Write bytes, then call [`Handshake::handle_written`].
    Write {
        /// First byte.
        first: usize,
        /// What.
        bytes: Vec<u8>,
    },
}

/// Watches a block and answers through it. One transfer is under way at a time.
///
/// After every call that takes something in, poll [`poll_transfer`](Self::poll_transfer),
/// [`poll_request`](Self::poll_request) and [`poll_notice`](Self::poll_notice) until `None`.
/// With no transfer under way, poll again at [`poll_timeout`](Self::poll_timeout).
#[derive(Debug, Clone)]
pub struct Handshake {
    settings: HandshakeSettings,
    link: Link,
    under_way: Option<UnderWay>,
    writes: VecDeque<Write>,
    command: Command,
    image: Image,
    /// Acknowledge in the block, as last read or written.
    is_acknowledged: bool,
    acknowledged_at: SimTime,
    told_stuck: bool,
    heartbeat: bool,
    beat_due: SimTime,
    poll_due: SimTime,
    requests: VecDeque<Vec<u8>>,
    notices: VecDeque<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Link {
    Down,
    /// The flags are to be read, as the block may have changed meanwhile.
    Greeting,
    /// The last bytes are to be read, to see that the block is long enough.
    Measuring,
    Up,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum UnderWay {
    Flags,
    LastBytes,
    Trigger,
    Parameters,
    Beat,
    Front,
}

#[derive(Debug, Clone)]
struct Write {
    first: usize,
    bytes: Vec<u8>,
    then: Then,
}

/// What a write that has arrived means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Then {
    Nothing,
    Raised,
    Lowered,
    Delivered,
}

#[derive(Debug, Clone)]
enum Command {
    Idle,
    /// An edge was seen.
    Reading,
    /// Acknowledge is being raised; execution begins when that has arrived.
    Acknowledging(Box<Result<Request, Status>>, bool),
    Running(Box<Running>),
    /// Kept until its last write has arrived.
    Delivering(Box<Outcome>),
}

impl Handshake {
    /// Without a connection to the block.
    pub fn new(settings: HandshakeSettings) -> Self {
        Self {
            settings,
            link: Link::Down,
            under_way: None,
            writes: VecDeque::new(),
            command: Command::Idle,
            image: Image::new(),
            is_acknowledged: false,
            acknowledged_at: SimTime::ZERO,
            told_stuck: false,
            heartbeat: false,
            beat_due: SimTime::ZERO,
            poll_due: SimTime::ZERO,
            requests: VecDeque::new(),
            notices: VecDeque::new(),
        }
    }

    /// The block can be reached, for the first time or again.
    pub fn handle_connect(&mut self) {
        self.handle_disconnect();
        self.link = Link::Greeting;
    }

    /// The block can no longer be reached. What was under way may have happened or not.
    pub fn handle_disconnect(&mut self) {
        self.link = Link::Down;
        self.under_way = None;
        self.writes.clear();
    }

    /// Somebody else wrote to the block: look at Trigger at once.
    pub fn handle_change(&mut self, now: SimTime) {
        self.poll_due = self.poll_due.min(now);
    }

    /// Whether the block is reached and long enough.
    pub fn is_up(&self) -> bool {
        self.link == Link::Up
    }

    /// The next transfer, unless one is under way or nothing is due.
    pub fn poll_transfer(&mut self, now: SimTime) -> Option<Transfer> {
        if self.under_way.is_some() {
            return None;
        }
        let read = |first, len| Transfer::Read { first, len };
        let (under_way, transfer) = match self.link {
            Link::Down => return None,
            Link::Greeting => (
                UnderWay::Flags,
                read(Field::Acknowledge.offset(), FLAGS_BYTES),
            ),
            Link::Measuring => (UnderWay::LastBytes, read(BLOCK_BYTES - 2, 2)),
            Link::Up if self.beat_due <= now => (
                UnderWay::Beat,
                Transfer::Write {
                    first: Field::Heartbeat.offset(),
                    bytes: vec![u8::from(!self.heartbeat)],
                },
            ),
            Link::Up => {
                if let Some(write) = self.writes.front() {
                    let transfer = Transfer::Write {
                        first: write.first,
                        bytes: write.bytes.clone(),
                    };
                    (UnderWay::Front, transfer)
                } else if matches!(self.command, Command::Reading) {
                    (UnderWay::Parameters, read(0, COMMAND_BYTES))
                } else if self.poll_due <= now {
                    self.poll_due = now + self.settings.poll_period;
                    (UnderWay::Trigger, read(Field::Trigger.offset(), 2))
                } else {
                    return None;
                }
            }
        };
        self.under_way = Some(under_way);
        Some(transfer)
    }

    /// The bytes of the read that was under way. A wrong number of them is our own transport's bug.
    pub fn handle_read(&mut self, now: SimTime, bytes: &[u8]) {
        let bit = |place: usize| bytes.get(place).is_some_and(|byte| byte & 1 != 0);
        let place = |field: Field| field.offset() - Field::Acknowledge.offset();
        match self.under_way.take() {
            Some(UnderWay::Flags) => {
                self.is_acknowledged = bit(0);
                self.acknowledged_at = now;
                self.heartbeat = bit(place(Field::Heartbeat));
                self.link = Link::Measuring;
            }
            Some(UnderWay::LastBytes) => self.begin(now),
            Some(UnderWay::Trigger) => self.look_at(now, bit(0)),
            Some(UnderWay::Parameters) => {
                let mut block = DataBlock::new();
                block.write(0, bytes);
                self.take_command(&block);
            }
            Some(UnderWay::Beat | UnderWay::Front) | None => {}
        }
    }

    /// The write that was under way has arrived.
    pub fn handle_written(&mut self, now: SimTime) {
        match self.under_way.take() {
            Some(UnderWay::Beat) => {
                self.heartbeat = !self.heartbeat;
                let from = if self.beat_due + LATE_BEAT < now {
                    now
                } else {
                    self.beat_due
                };
                self.beat_due = from + self.settings.heartbeat;
            }
            Some(UnderWay::Front) => match self.writes.pop_front().map(|write| write.then) {
                Some(Then::Raised) => self.execute(now),
                Some(Then::Lowered) => self.is_acknowledged = false,
                Some(Then::Delivered) => self.command = Command::Idle,
                Some(Then::Nothing) | None => {}
            },
            _ => {}
        }
    }

    /// The next request for the session, in the form of [`super::plc_port`].
    pub fn poll_request(&mut self) -> Option<Vec<u8>> {
        self.requests.pop_front()
    }

    /// One whole reply of the session.
    pub fn handle_reply(&mut self, bytes: &[u8]) {
        let Command::Running(running) = &mut self.command else {
            return;
        };
        let encoding = Encoding::HexLittleEndian;
        let profile = &self.settings.profile;
        let reply = Reply::decode_as(encoding, profile, &running.request, bytes);
        // The session answers in the form that it was asked in; anything else is our own bug, and told.
        let reply = reply.unwrap_or(Reply::status(
            running.request.code(),
            Status::CommunicationUnknown,
        ));
        let cap = profile.pose_cap.min(POINT_ROWS);
        if let Some(outcome) = running.take(reply, cap) {
            self.deliver(outcome);
        } else {
            let request = running.request.encode(encoding, profile);
            self.requests.push_back(request);
        }
    }

    /// What people should know, in words.
    pub fn poll_notice(&mut self) -> Option<String> {
        self.notices.pop_front()
    }

    /// When [`poll_transfer`](Self::poll_transfer) has something again. `None` while a transfer is under way
    /// or the block cannot be reached.
    pub fn poll_timeout(&self) -> Option<SimTime> {
        if self.under_way.is_some() {
            return None;
        }
        match self.link {
            Link::Down => None,
            Link::Greeting | Link::Measuring => Some(SimTime::ZERO),
            Link::Up if !self.writes.is_empty() || matches!(self.command, Command::Reading) => {
                Some(SimTime::ZERO)
            }
            Link::Up => Some(self.poll_due.min(self.beat_due)),
        }
    }

    /// The block is there, and its flags are known: go on with what was not finished.
    fn begin(&mut self, now: SimTime) {
        self.link = Link::Up;
        self.beat_due = now;
        self.poll_due = now;
        self.told_stuck = false;
        self.image = Image::new();
        match std::mem::replace(&mut self.command, Command::Idle) {
            // Before the write that was lost Acknowledge was 0: if it is 1 now, that write had arrived.
            Command::Acknowledging(request, has_plan) if self.is_acknowledged => {
                self.command = Command::Acknowledging(request, has_plan);
                self.execute(now);
            }
            // The edge is still there, or the controller has taken it back.
            Command::Idle | Command::Reading | Command::Acknowledging(..) => {}
            Command::Running(running) => self.command = Command::Running(running),
            Command::Delivering(outcome) => self.deliver(*outcome),
        }
    }

    fn look_at(&mut self, now: SimTime, is_triggered: bool) {
        match (is_triggered, self.is_acknowledged) {
            (true, false) if matches!(self.command, Command::Idle) => {
                self.command = Command::Reading;
            }
            (false, true) => {
                self.told_stuck = false;
                self.write(Field::Acknowledge.offset(), vec![0], Then::Lowered);
            }
            (true, true) if !self.told_stuck && self.acknowledged_at + STUCK_TRIGGER <= now => {
                self.told_stuck = true;
                self.notices.push_back(
                    "Command Trigger is still 1, 10 s after Trigger Acknowledge: \
                     no further command is taken until it falls"
                        .to_owned(),
                );
            }
            _ => {}
        }
    }

    fn take_command(&mut self, block: &DataBlock) {
        if !block.bool(Field::Trigger) {
            self.command = Command::Idle;
            return;
        }
        let request = request_of(block);
        let has_plan = match request {
            Ok(Request::GetPlanData(_)) => block.int(Field::PoseType, 0) >= 3,
            _ => true,
        };
        self.command = Command::Acknowledging(Box::new(request), has_plan);
        // Status and Status of Pose Sent.
        self.write(Field::Status.offset(), vec![0; 3], Then::Nothing);
        self.write(Field::Acknowledge.offset(), vec![1], Then::Raised);
    }

    /// Acknowledge has arrived.
    fn execute(&mut self, now: SimTime) {
        self.is_acknowledged = true;
        self.acknowledged_at = now;
        let Command::Acknowledging(request, has_plan) =
            std::mem::replace(&mut self.command, Command::Idle)
        else {
            return;
        };
        match *request {
            Err(status) => self.deliver(Outcome::of_status(status)),
            Ok(request) => {
                let profile = &self.settings.profile;
                let bytes = request.encode(Encoding::HexLittleEndian, profile);
                self.requests.push_back(bytes);
                self.command = Command::Running(Box::new(Running::new(request, has_plan)));
            }
        }
    }

    /// Payload, then Status, then the flag. Without a connection this waits for the next one.
    fn deliver(&mut self, outcome: Outcome) {
        let (writes, outcome) = match self.image.payload(&outcome.data) {
            Ok(writes) => (writes, outcome),
            Err(status) => (Vec::new(), Outcome::of_status(status)),
        };
        if self.link == Link::Up {
            for (first, bytes) in writes {
                for (place, chunk) in bytes.chunks(LONGEST_WRITE).enumerate() {
                    let first = first + place * LONGEST_WRITE;
                    self.write(first, chunk.to_vec(), Then::Nothing);
                }
            }
            if let Some(status) = outcome.status {
                let code = status.code() as i16;
                let bytes = code.to_be_bytes().to_vec();
                self.write(Field::Status.offset(), bytes, Then::Nothing);
            }
            if outcome.is_new_data() {
                self.write(Field::PoseSent.offset(), vec![1], Then::Nothing);
            }
            if let Some(last) = self.writes.back_mut() {
                last.then = Then::Delivered;
            }
        }
        self.command = Command::Delivering(Box::new(outcome));
    }

    fn write(&mut self, first: usize, bytes: Vec<u8>, then: Then) {
        self.writes.push_back(Write { first, bytes, then });
    }
}
