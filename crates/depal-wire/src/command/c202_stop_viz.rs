//! 202: stops the Viz project.
//!
//! - Wire: `202`.
//! - Reply: `202, 2104`, also when none runs.
//! - Codes: none.
//! - Golden file: `202_stop_viz.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 202.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StopViz;

impl RequestBody for StopViz {
    fn decode(_cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self)
    }

    fn encode(&self, _cells: &mut CellWriter) {}
}
