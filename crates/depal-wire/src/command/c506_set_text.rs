//! 506: sets a global variable that is a text.
//!
//! - Wire: `506, name, text`. Text only. The fields are not documented; this form is our choice.
//! - Reply: `506, 1111`.
//! - Codes: 1052 unknown variable, or one of another kind.
//! - Golden file: `506_set_text.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 506.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SetText {
    /// Name of the variable.
    pub name: String,
    /// Its value; it holds no comma.
    pub value: String,
}

impl RequestBody for SetText {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        let name = cells.text()?;
        Ok(Self {
            name,
            value: cells.text()?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.text_field(&self.name);
        cells.text_field(&self.value);
    }
}
