//! 901: asks whether the vision side is ready.
//!
//! - Wire: `901`.
//! - Reply: `901, 1101`; from version 2.2 `901, 9100, vision, viz, camera`, each 0 or 1.
//! - Codes: 1001 no project registered.
//! - Golden file: `901_get_state.txt`.

use crate::cells::{CellReader, CellWriter, FieldError};
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

/// What is ready: the reply to 901 from version 2.2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StateFields {
    /// A vision project is registered.
    pub has_vision: bool,
    /// A Viz project is registered.
    pub has_viz: bool,
    /// The camera is connected.
    pub has_camera: bool,
}

impl StateFields {
    pub(crate) fn encode(self, cells: &mut CellWriter) {
        for field in [self.has_vision, self.has_viz, self.has_camera] {
            cells.int(i32::from(field));
        }
    }

    pub(crate) fn decode(cells: &mut CellReader<'_>) -> Result<Self, FieldError> {
        Ok(Self {
            has_vision: cells.int()? != 0,
            has_viz: cells.int()? != 0,
            has_camera: cells.int()? != 0,
        })
    }
}
