//! 601: fetches the message of a notify step.
//!
//! - Wire: `601`.
//! - Reply: `601, message`, without a status code; 0 if none came in time.
//! - Golden file: `601_get_notify.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 601.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GetNotify;

impl RequestBody for GetNotify {
    fn decode(_cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self)
    }

    fn encode(&self, _cells: &mut CellWriter) {}
}
