//! 102: fetches vision points.
//!
//! - Wire: `102, job`.
//! - Reply: `102, 1100, last, n, 0, n x (pose, label, velocity)`; ask again while `last` is 0.
//! - Codes: 1002 nothing found or all fetched, 1003 nothing in the region, 1011 job, 1016 path project,
//!   1019 timeout, 1020 not started.
//! - Golden file: `102_get_vision_points.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 102.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GetVisionPoints {
    /// Number of the vision project.
    pub job: i32,
}

impl RequestBody for GetVisionPoints {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self { job: cells.int()? })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.job);
    }
}
