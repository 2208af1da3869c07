//! 104: switches the solution, the set of all projects.
//!
//! - Wire: `104, solution`.
//! - Reply: `104, 1104`.
//! - Codes: 1053 unknown solution, or a project runs.
//! - Golden file: `104_switch_solution.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 104.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SwitchSolution {
    /// Number of the solution.
    pub solution: i32,
}

impl RequestBody for SwitchSolution {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self {
            solution: cells.int()?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.solution);
    }
}
