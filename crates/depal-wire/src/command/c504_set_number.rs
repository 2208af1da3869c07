//! 504: sets a numeric global variable.
//!
//! - Wire: `504, name, value`. Text only. The fields are not documented; this form is our choice.
//! - Reply: `504, 1111`.
//! - Codes: 1052 unknown variable, or one of another kind.
//! - Golden file: `504_set_number.txt`.

use crate::Status;
use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 504.
#[derive(Debug, Clone, PartialEq)]
pub struct SetNumber {
    /// Name of the variable.
    pub name: String,
    /// Its value.
    pub value: f64,
}

impl RequestBody for SetNumber {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        let name = cells.text()?;
        let value = cells.real();
        Ok(Self {
            name,
            value: value.map_err(|e| BodyError::with_non_finite(e, Status::VariableNotSet))?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.text_field(&self.name);
        cells.real(self.value);
    }
}
