//! 208: writes the step parameters behind a configuration id, all lines of that id in order.
//!
//! - Wire: `208, id`.
//! - Reply: `208, 2108`.
//! - Codes: 2016 step or key missing, or no number; 3008 id.
//! - Golden file: `208_write_parameter.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 208.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WriteParameter {
    /// Id of the `write` lines of the property configuration.
    pub id: i32,
}

impl RequestBody for WriteParameter {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self { id: cells.int()? })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.id);
    }
}
