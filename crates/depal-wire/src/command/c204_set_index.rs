//! 204: sets the current index of a step that counts: move by list, by grid, pallet patterns.
//!
//! - Wire: `204, step, index`; N sets the current index to N-1, and the step raises it to N.
//! - Reply: `204, 2106`.
//! - Codes: 2022 nothing runs, 2026 step, 2027 index, 2028 too late in this run (203 was sent, or the run is over).
//! - Golden file: `204_set_index.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 204.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SetIndex {
    /// Id of the step.
    pub step: i32,
    /// Index, counted from 1.
    pub index: i32,
}

impl RequestBody for SetIndex {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self {
            step: cells.int()?,
            index: cells.int()?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.step);
        cells.int(self.index);
    }
}
