//! 206: fetches which digital outputs of the gripper to switch on.
//!
//! - Wire: `206`, from version 2.1 with the number of gripper sections, 1 to 64; in HEX 0 stands for absent.
//! - Reply: `206, 2102, d1 .. d64`, -1 in unused places.
//! - Codes: 2011 nothing planned, 3002 sections out of range.
//! - Golden file: `206_get_do_list.txt`.

use crate::cells::{CellReader, CellWriter, FieldError};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Places in a DO list.
pub const DO_LIST_LEN: usize = 64;

/// Command 206.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GetDoList {
    /// Sections of the gripper, if sent.
    pub sections: Option<i32>,
}

impl RequestBody for GetDoList {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self {
            sections: read_sections(cells)?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        if let Some(sections) = self.sections {
            cells.int(sections);
        }
    }
}

/// Sections of the gripper: absent, or 1 to 64. HEX fills absent fields with zeros; in text a 0 is a wrong number.
pub(crate) fn read_sections(cells: &mut CellReader<'_>) -> Result<Option<i32>, BodyError> {
    if cells.remaining() == Some(0) {
        return Ok(None);
    }
    let is_hex = cells.remaining().is_none();
    match cells.int()? {
        0 if is_hex => Ok(None),
        n @ 1..=64 => Ok(Some(n)),
        n => Err(BodyError::wrong_format(format!(
            "gripper sections: expected 1 to 64, found {n}"
        ))),
    }
}

/// The reply's 64 places: numbers of outputs to switch on, -1 for none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DoList(pub [i32; DO_LIST_LEN]);

impl DoList {
    pub(crate) fn encode(&self, cells: &mut CellWriter) {
        for number in self.0 {
            cells.int(number);
        }
    }

    pub(crate) fn decode(cells: &mut CellReader<'_>) -> Result<Self, FieldError> {
        let mut list = [-1; DO_LIST_LEN];
        for number in &mut list {
            *number = cells.int()?;
        }
        Ok(Self(list))
    }
}
