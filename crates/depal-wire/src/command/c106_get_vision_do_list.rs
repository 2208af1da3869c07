//! 106: fetches which digital outputs of the gripper to switch on for the path of a vision project.
//!
//! - Wire: `106, job`, from version 2.1 with the number of gripper sections, 1 to 64; in HEX 0 stands for absent.
//! - Reply: `106, 1106, d1 .. d64`, -1 in unused places.
//! - Codes: 1008 no gripper plan, 1011 job, 1020 not started, 3002 sections out of range.
//! - Golden file: `106_get_vision_do_list.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::command::c206_get_do_list::read_sections;
use crate::request::BodyError;

/// Command 106.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GetVisionDoList {
    /// Number of the vision project.
    pub job: i32,
    /// Sections of the gripper, if sent.
    pub sections: Option<i32>,
}

impl RequestBody for GetVisionDoList {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self {
            job: cells.int()?,
            sections: read_sections(cells)?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.job);
        if let Some(sections) = self.sections {
            cells.int(sections);
        }
    }
}
