use std::collections::{BTreeMap, VecDeque};

use depal_time::{SimDuration, SimTime};

use crate::system::{MoveId, SocketId};
use crate::{MachineFault, RaisedError, Reference, Report, ReportFilter, Root, Value};

/// A built-in that has been called and has not answered yet.
#[derive(Debug, Clone)]
pub(crate) struct PendingCall {
    pub(crate) arguments: Vec<Value>,
    pub(crate) started: SimTime,
    pub(crate) notes: Vec<Value>,
}

/// The error a frame is handling.
#[derive(Debug, Clone)]
pub(crate) struct Handling {
    pub(crate) error: RaisedError,
    pub(crate) retry: u32,
    pub(crate) next: u32,
}

/// Where a signal lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Level {
    /// Above this.
    Above(f64),
    /// Below this.
    Below(f64),
    /// Not below the first, not above the second.
    Between(f64, f64),
    /// Below the first or above the second.
    Outside(f64, f64),
    /// Anywhere.
    Anywhere,
}

impl Level {
    /// Whether a value lies there.
    pub fn holds(self, value: f64) -> bool {
        match self {
            Self::Above(limit) => value > limit,
            Self::Below(limit) => value < limit,
            Self::Between(low, high) => (low..=high).contains(&value),
            Self::Outside(low, high) => !(low..=high).contains(&value),
            Self::Anywhere => true,
        }
    }
}

/// What orders an interrupt.
#[derive(Debug, Clone, Default)]
pub enum Trigger {
    /// Nothing yet: connected to its routine only.
    #[default]
    None,
    /// A condition comes true.
    Condition {
        /// Index of the routine without parameters that gives its truth value.
        routine: u32,
        /// What it was when it was last looked at; `None` before.
        last: Option<bool>,
    },
    /// The arm begins with a move, or ends it.
    Move {
        /// The move.
        id: MoveId,
        /// Its end instead of its start.
        ends: bool,
        /// How long after that.
        delay: SimDuration,
        /// When it happened.
        reached: Option<SimTime>,
    },
    /// A signal changes.
    Signal {
        /// The signal.
        name: String,
        /// To this value; `None` for any change.
        wanted: Option<f64>,
        /// Its value when it was last looked at.
        last: f64,
    },
    /// A signal has moved by more than a step since the last time, and lies where it is asked for.
    Level {
        /// The signal.
        name: String,
        /// Where.
        wanted: Level,
        /// It must have moved by more than this.
        step: f64,
        /// Only upwards (above 0), only downwards (below 0), either way (0).
        direction: i8,
        /// Its value when the interrupt was ordered or last came.
        last: f64,
    },
    /// A move gives a notice at a place on its way.
    Notice {
        /// Its name.
        name: String,
        /// How many there were when it was last looked.
        last: u64,
    },
    /// The program puts a message into the event log.
    Report(ReportFilter),
    /// Time passes.
    Timer {
        /// From one to the next.
        period: SimDuration,
        /// The next.
        due: SimTime,
    },
    /// A variable changes.
    Change {
        /// The variable.
        variable: Reference,
        /// Its value when it was last looked at.
        last: Value,
    },
}

/// An interrupt that a program has connected with a routine.
#[derive(Debug, Clone, Default)]
pub struct Interrupt {
    /// Its number, from 1.
    pub number: u32,
    /// Index of the routine that runs.
    pub routine: u32,
    /// What orders it.
    pub trigger: Trigger,
    /// Only the first time.
    pub once: bool,
    /// Put to sleep: what happens meanwhile is lost.
    pub asleep: bool,
    /// Held back: it is queued.
    pub held: bool,
    /// Its routine may begin while that of an interrupt with a greater number here runs.
    /// `None`: it waits until no other runs.
    pub priority: Option<u32>,
    /// Height of the call stack below which it is forgotten; 0 for never.
    pub level: u32,
}

/// The interrupts of a task. Their routines run between statements and inside waits, one after the other.
#[derive(Debug, Clone, Default)]
pub struct Interrupts {
    /// All that are connected, in the order of their numbers.
    pub connected: Vec<Interrupt>,
    /// Numbers of those whose routine has not run yet.
    pub queued: VecDeque<u32>,
    /// Held back: they are queued.
    pub disabled: bool,
    /// Messages whose interrupts are queued, by the number of the interrupt.
    pub(crate) reported: VecDeque<(u32, Report)>,
    /// How many were ever connected.
    pub(crate) given: u32,
}

impl Interrupts {
    /// The interrupt of this number.
    pub fn find(&mut self, number: u32) -> Option<&mut Interrupt> {
        self.connected.iter_mut().find(|i| i.number == number)
    }
}

/// A routine being run.
#[derive(Debug, Clone, Default)]
pub struct Frame {
    /// Index of the routine.
    pub routine: u32,
    /// The operation to run next.
    pub pc: u32,
    /// Parameters first, then the routine's own data.
    pub locals: Vec<Value>,
    /// Line of the statement being run, from 1.
    pub line: u32,
    pub(crate) operands: Vec<Value>,
    pub(crate) statement: u32,
    pub(crate) next: u32,
    pub(crate) pending: Option<Box<PendingCall>>,
    pub(crate) wait_started: Option<SimTime>,
    pub(crate) handling: Option<Box<Handling>>,
    pub(crate) retries: u32,
    pub(crate) retried_statement: Option<u32>,
    /// Number of the interrupt whose routine this is.
    pub(crate) interrupt: Option<u32>,
    /// The message that ordered it.
    pub(crate) report: Option<Box<Report>>,
    /// Whether its UNDO clause runs.
    pub(crate) undoing: bool,
    /// Whether it is a routine of an event: its errors do not reach the routines below.
    pub(crate) is_event: bool,
}

impl Frame {
    /// Number of the interrupt whose routine this is.
    pub fn serves(&self) -> Option<u32> {
        self.interrupt
    }
}

/// All data of a running program.
#[derive(Debug, Clone, Default)]
pub struct Memory {
    /// Module data.
    pub globals: Vec<Value>,
    /// The call stack, outermost first.
    pub frames: Vec<Frame>,
    /// Modal settings of the language by name (speed override, acceleration).
    pub modal: BTreeMap<&'static str, f64>,
    /// Bytes taken from a socket and put back, to be read first.
    pub unread: BTreeMap<SocketId, Vec<u8>>,
    /// Interrupts.
    pub interrupts: Interrupts,
    /// Tasks that this one moves in step with, itself among them; empty while it moves alone.
    pub partners: Vec<String>,
    /// Data found by a search by name that have not been handed out yet, by their place among the globals.
    pub found: VecDeque<u32>,
}

impl Memory {
    /// What a reference refers to. An absent optional parameter is a fault.
    pub fn read(&self, reference: &Reference) -> Result<&Value, MachineFault> {
        Self::find(&self.globals, &self.frames, reference).ok_or(MachineFault::NotPresent)
    }

    /// As [`read`](Self::read), from the parts of a memory.
    pub(crate) fn find<'a>(
        globals: &'a [Value],
        frames: &'a [Frame],
        reference: &Reference,
    ) -> Option<&'a Value> {
        let mut value = match reference.root {
            Root::Global(slot) => globals.get(slot as usize),
            Root::Local { frame, slot } => frames
                .get(frame as usize)
                .and_then(|f| f.locals.get(slot as usize)),
        };
        for index in &reference.path {
            value = match value {
                Some(Value::Record(items) | Value::Array(items)) => items.get(*index as usize),
                _ => None,
            };
        }
        value.filter(|value| value.is_present())
    }

    /// The variable that a reference refers to.
    pub fn read_mut(&mut self, reference: &Reference) -> Result<&mut Value, MachineFault> {
        let mut value = match reference.root {
            Root::Global(slot) => self.globals.get_mut(slot as usize),
            Root::Local { frame, slot } => self
                .frames
                .get_mut(frame as usize)
                .and_then(|f| f.locals.get_mut(slot as usize)),
        };
        for index in &reference.path {
            value = match value {
                Some(Value::Record(items) | Value::Array(items)) => items.get_mut(*index as usize),
                _ => None,
            };
        }
        value.ok_or(MachineFault::NotPresent)
    }

    /// Assigns to what a reference refers to.
    pub fn write(&mut self, reference: &Reference, value: Value) -> Result<(), MachineFault> {
        *self.read_mut(reference)? = value;
        Ok(())
    }

    /// Extends a reference by indexes from 1, checking the bounds.
    pub(crate) fn index(
        &self,
        mut reference: Reference,
        indexes: &[Value],
    ) -> Result<Reference, MachineFault> {
        let mut value = self.read(&reference)?;
        for (dimension, index) in indexes.iter().enumerate() {
            let (position, element) = element(value, index, dimension)?;
            reference.path.push(position);
            value = element;
        }
        Ok(reference)
    }
}

/// Position from 0 and the element of an array at an index from 1. Fractions are rounded, as on a
/// controller that takes a number as index.
pub(crate) fn element<'a>(
    array: &'a Value,
    index: &Value,
    dimension: usize,
) -> Result<(u32, &'a Value), MachineFault> {
    let index = index.as_number().unwrap_or(f64::NAN);
    let Value::Array(items) = array else {
        return Err(MachineFault::Argument {
            message: format!("{} has no elements", array.kind_name()),
        });
    };
    let position = index.round() - 1.0;
    let fault = MachineFault::IndexOutOfRange {
        index,
        size: items.len(),
        dimension: dimension + 1,
    };
    if position.is_nan() || position < 0.0 {
        return Err(fault);
    }
    let found = items.get(position as usize).ok_or(fault)?;
    Ok((position as u32, found))
}
