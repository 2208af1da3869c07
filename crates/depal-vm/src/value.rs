use std::sync::Arc;

use depal_time::{SimDuration, SimTime};

use crate::HostState;
use crate::system::SocketId;

/// Most bytes that a [`RawBytes`] holds.
pub const RAW_BYTES_LIMIT: usize = 1024;

/// A byte container of at most [`RAW_BYTES_LIMIT`] bytes, as programs pack messages in.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RawBytes {
    bytes: Vec<u8>,
}

impl RawBytes {
    /// From bytes; `None` if there are too many.
    pub fn from_bytes(bytes: Vec<u8>) -> Option<Self> {
        (bytes.len() <= RAW_BYTES_LIMIT).then_some(Self { bytes })
    }

    /// The bytes in use.
    pub fn as_slice(&self) -> &[u8] {
        &self.bytes
    }

    /// Overwrites from `offset` (from 0), growing as needed, zeros in a gap; `false` if it would not fit.
    pub fn write(&mut self, offset: usize, data: &[u8]) -> bool {
        let end = offset.saturating_add(data.len());
        if end > RAW_BYTES_LIMIT {
            return false;
        }
        if self.bytes.len() < end {
            self.bytes.resize(end, 0);
        }
        self.bytes[offset..end].copy_from_slice(data);
        true
    }

    /// Keeps the first `length` bytes.
    pub fn truncate(&mut self, length: usize) {
        self.bytes.truncate(length);
    }
}

/// A stop watch of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ClockState {
    /// Simulated time of the last start while it runs.
    pub running_since: Option<SimTime>,
    /// Time of earlier runs.
    pub accumulated: SimDuration,
}

impl ClockState {
    /// What the clock shows at `now`.
    pub fn elapsed(&self, now: SimTime) -> SimDuration {
        match self.running_since {
            Some(start) => self.accumulated + now.saturating_since(start),
            None => self.accumulated,
        }
    }
}

/// Where a reference begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Root {
    /// A global slot.
    Global(u32),
    /// A local slot of the frame at this height of the call stack. The frame outlives the reference,
    /// because references go only from callers to callees.
    Local {
        /// Index of the frame, 0 is the outermost.
        frame: u32,
        /// Slot in it.
        slot: u32,
    },
}

/// A variable, or a part of one, given to a routine. Plain indexes, so that machines can be cloned.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reference {
    /// The variable.
    pub root: Root,
    /// Field and element indexes from there, from 0.
    pub path: Vec<u32>,
}

/// A value of a robot program.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Value {
    /// An optional argument that was not given; also what a procedure returns.
    #[default]
    Absent,
    /// A variable that was never given a value, in languages where that is no value.
    Unset,
    /// A 32-bit number.
    Num(f32),
    /// A 64-bit number.
    Dnum(f64),
    /// An integer of a language that has them.
    Int(i64),
    /// A truth value.
    Bool(bool),
    /// A string.
    Str(String),
    /// Fields by position.
    Record(Vec<Value>),
    /// Elements; more dimensions are arrays of arrays.
    Array(Vec<Value>),
    /// A byte container.
    Raw(Box<RawBytes>),
    /// A socket variable; `None` before it was created.
    Socket(Option<SocketId>),
    /// A stop watch.
    Clock(ClockState),
    /// A signal of the cabinet, by name.
    Signal(Arc<str>),
    /// What built-ins remember; no program can name it.
    Host(HostState),
    /// A variable given by reference.
    Reference(Reference),
}

impl Value {
    /// A few words for messages.
    pub fn kind_name(&self) -> &'static str {
        match self {
            Self::Absent => "nothing",
            Self::Unset => "a variable without a value",
            Self::Num(_) => "a 32-bit number",
            Self::Dnum(_) => "a 64-bit number",
            Self::Int(_) => "an integer",
            Self::Bool(_) => "a truth value",
            Self::Str(_) => "a string",
            Self::Record(_) => "a record",
            Self::Array(_) => "an array",
            Self::Raw(_) => "a byte container",
            Self::Socket(_) => "a socket",
            Self::Clock(_) => "a clock",
            Self::Signal(_) => "a signal",
            Self::Host(_) => "hidden state",
            Self::Reference(_) => "a reference",
        }
    }

    /// The number, if it is one.
    pub fn as_number(&self) -> Option<f64> {
        match self {
            Self::Num(v) => Some(f64::from(*v)),
            Self::Dnum(v) => Some(*v),
            Self::Int(v) => Some(*v as f64),
            _ => None,
        }
    }

    /// Whether there is no value in it: a variable without one, or a record or an array of such.
    pub fn is_unset(&self) -> bool {
        match self {
            Self::Unset => true,
            Self::Record(parts) | Self::Array(parts) => {
                !parts.is_empty() && parts.iter().all(Self::is_unset)
            }
            _ => false,
        }
    }

    /// Whether an optional argument was given.
    pub fn is_present(&self) -> bool {
        !matches!(self, Self::Absent)
    }
}
