//! 103: switches the parameter recipe of a vision project.
//!
//! - Wire: `103, job, recipe`, recipe 1 to 99, before 101.
//! - Reply: `103, 1107`.
//! - Codes: 1007 running, 1011 job, 1012 recipe, 1013 project without recipes.
//! - Golden file: `103_switch_recipe.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 103.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SwitchRecipe {
    /// Number of the vision project.
    pub job: i32,
    /// Number of the recipe.
    pub recipe: i32,
}

impl RequestBody for SwitchRecipe {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self {
            job: cells.int()?,
            recipe: cells.int()?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.job);
        cells.int(self.recipe);
    }
}
