//! One command, one file: what it is, its wire form, its reply and its status codes.
//!
//! To add one: write `cNNN_name.rs`, add it here, and add one line to the table in `request.rs`.

pub(crate) mod c100_run_vision;
pub(crate) mod c101_start_vision;
pub(crate) mod c102_get_vision_points;
pub(crate) mod c103_switch_recipe;
pub(crate) mod c104_switch_solution;
pub(crate) mod c105_get_vision_path;
pub(crate) mod c106_get_vision_do_list;
pub(crate) mod c110_get_custom_data;
pub(crate) mod c111_get_vision_plan_data;
pub(crate) mod c200_run_viz;
pub(crate) mod c201_start_viz;
pub(crate) mod c202_stop_viz;
pub(crate) mod c203_set_branch;
pub(crate) mod c204_set_index;
pub(crate) mod c205_get_viz_path;
pub(crate) mod c206_get_do_list;
pub(crate) mod c207_read_parameter;
pub(crate) mod c208_write_parameter;
pub(crate) mod c210_get_plan_data;
pub(crate) mod c501_set_box_size;
pub(crate) mod c502_set_outer_pose;
pub(crate) mod c503_set_input_pose;
pub(crate) mod c504_set_number;
pub(crate) mod c505_set_numbers;
pub(crate) mod c506_set_text;
pub(crate) mod c507_set_texts;
pub(crate) mod c601_get_notify;
pub(crate) mod c701_calibrate;
pub(crate) mod c901_get_state;
pub(crate) mod point_list;
mod robot_pose;

use crate::cells::{CellReader, CellWriter};
use crate::request::BodyError;

/// The fields after the command number.
pub(crate) trait RequestBody: Sized {
    /// Reads them; what is left over is refused by the caller.
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError>;
    /// Writes them.
    fn encode(&self, cells: &mut CellWriter);
}
