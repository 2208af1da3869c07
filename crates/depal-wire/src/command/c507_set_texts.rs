//! 507: sets a global variable that is a list of texts.
//!
//! - Wire: `507, name, text, ...`. Text only. The fields are not documented; this form is our choice.
//! - Reply: `507, 1111`.
//! - Codes: 1052 unknown variable, or one of another kind.
//! - Golden file: `507_set_texts.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 507.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SetTexts {
    /// Name of the variable.
    pub name: String,
    /// Its values, at least one; they hold no comma.
    pub values: Vec<String>,
}

impl RequestBody for SetTexts {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        let name = cells.text()?;
        let mut values = Vec::new();
        loop {
            values.push(cells.text()?);
            if cells.remaining() == Some(0) {
                return Ok(Self { name, values });
            }
        }
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.text_field(&self.name);
        for value in &self.values {
            cells.text_field(value);
        }
    }
}
