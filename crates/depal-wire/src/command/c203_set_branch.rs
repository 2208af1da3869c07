//! 203: chooses the exit of a "branch by message" step.
//!
//! - Wire: `203, step, port`; port N takes exit N-1, so it is at least 1.
//! - Reply: `203, 2105`. The choice is kept until the step is reached in this run.
//! - Codes: 2018 port, 2022 nothing runs, 2024 step.
//! - Golden file: `203_set_branch.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 203.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SetBranch {
    /// Id of the step.
    pub step: i32,
    /// Exit port, counted from 1.
    pub port: i32,
}

impl RequestBody for SetBranch {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self {
            step: cells.int()?,
            port: cells.int()?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.step);
        cells.int(self.port);
    }
}
