//! 901: asks whether the vision side is ready.
//!
//! - Wire: `901`.
//! - Reply: `901, 1101`.
//! - Codes: 1001 no project registered.
//! - Golden file: `901_get_state.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 901.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GetState;

impl RequestBody for GetState {
    fn decode(_cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self)
    }

    fn encode(&self, _cells: &mut CellWriter) {}
}
