//! 501: sets the box size of a vision project.
//!
//! - Wire: `501, job, length, width, height`, mm, before 101.
//! - Reply: `501, 1108`.
//! - Codes: 1007 running, 1011 job, 1022 size.
//! - Golden file: `501_set_box_size.txt`.

use crate::Status;
use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 501.
#[derive(Debug, Clone, PartialEq)]
pub struct SetBoxSize {
    /// Number of the vision project.
    pub job: i32,
    /// Length, width and height, mm.
    pub size_mm: [f64; 3],
}

impl RequestBody for SetBoxSize {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        let job = cells.int()?;
        let size_mm = cells
            .reals()
            .map_err(|e| BodyError::with_non_finite(e, Status::InvalidBoxSize))?;
        Ok(Self { job, size_mm })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.job);
        cells.reals(&self.size_mm);
    }
}
