//! 505: sets a global variable that is a list of numbers.
//!
//! - Wire: `505, name, value, ...`. Text only. The fields are not documented; this form is our choice.
//! - Reply: `505, 1111`.
//! - Codes: 1052 unknown variable, or one of another kind.
//! - Golden file: `505_set_numbers.txt`.

use crate::Status;
use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 505.
#[derive(Debug, Clone, PartialEq)]
pub struct SetNumbers {
    /// Name of the variable.
    pub name: String,
    /// Its values, at least one.
    pub values: Vec<f64>,
}

impl RequestBody for SetNumbers {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        let name = cells.text()?;
        let mut values = Vec::new();
        loop {
            let value = cells.real();
            values.push(value.map_err(|e| BodyError::with_non_finite(e, Status::VariableNotSet))?);
            if cells.remaining() == Some(0) {
                return Ok(Self { name, values });
            }
        }
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.text_field(&self.name);
        cells.reals(&self.values);
    }
}
