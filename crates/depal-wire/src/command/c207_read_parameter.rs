//! 207: reads the step parameter behind a configuration id.
//!
//! - Wire: `207, id`.
//! - Reply: `207, 2109, value`; single precision in HEX.
//! - Codes: 2041 step or key missing, 3008 id.
//! - Golden file: `207_read_parameter.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 207.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadParameter {
    /// Id of a `read` line of the property configuration.
    pub id: i32,
}

impl RequestBody for ReadParameter {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self { id: cells.int()? })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.id);
    }
}
