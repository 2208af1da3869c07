use std::collections::VecDeque;

use depal_time::SimTime;

use crate::{BufferMode, EkiError, ElementValue};

/// A value with the record that it came in.
#[derive(Debug, Clone, PartialEq)]
struct Entry {
    value: ElementValue,
    counter: u64,
    at: SimTime,
}

/// Values that were taken out of a memory.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Taken {
    pub(crate) values: Vec<ElementValue>,
    pub(crate) counter: u64,
    pub(crate) at: SimTime,
}

/// The memory of one element: a queue with a limit.
#[derive(Debug, Clone)]
pub(crate) struct ElementMemory {
    pub(crate) tag: String,
    mode: BufferMode,
    limit: usize,
    entries: VecDeque<Entry>,
}

impl ElementMemory {
    pub(crate) fn new(tag: &str, mode: BufferMode, limit: usize) -> Self {
        Self {
            tag: tag.to_owned(),
            mode,
            limit,
            entries: VecDeque::new(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    pub(crate) fn clear(&mut self) {
        self.entries.clear();
    }

    /// Whether a value of this record is still here.
    pub(crate) fn holds(&self, counter: u64) -> bool {
        self.entries.iter().any(|entry| entry.counter == counter)
    }

    /// Whether so many more fit.
    pub(crate) fn has_room(&self, more: usize) -> Result<(), EkiError> {
        if self.entries.len() + more <= self.limit {
            return Ok(());
        }
        Err(EkiError::MemoryFull {
            tag: self.tag.clone(),
            limit: self.limit,
        })
    }

    /// Adds a value; the caller has asked for room.
    pub(crate) fn push(&mut self, value: ElementValue, counter: u64, at: SimTime) {
        self.entries.push_back(Entry { value, counter, at });
    }

    /// Takes at most so many values.
    pub(crate) fn take(&mut self, most: usize) -> Result<Taken, EkiError> {
        let mut taken = Taken::default();
        while taken.values.len() < most {
            let next = match self.mode {
                BufferMode::Fifo => self.entries.pop_front(),
                BufferMode::Lifo => self.entries.pop_back(),
            };
            let Some(entry) = next else { break };
            taken.values.push(entry.value);
            taken.counter = entry.counter;
            taken.at = entry.at;
        }
        if taken.values.is_empty() {
            return Err(EkiError::Empty {
                tag: self.tag.clone(),
            });
        }
        Ok(taken)
    }
}
