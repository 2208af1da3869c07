//! The vision calls.

use crate::builtins::Entry;

/// A call: its name and the names of its arguments.
pub(crate) struct VisionCall {
    pub name: &'static str,
    pub parameters: &'static [&'static str],
}

pub(crate) const CALLS: &[VisionCall] = &[];
pub(crate) const ENTRIES: [Entry; 0] = [];
