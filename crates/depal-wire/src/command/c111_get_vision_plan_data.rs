//! 111: fetches one waypoint of a vision project's path with its motion and plan data.
//!
//! - Wire: `111, job, type`; 1 joints, 2 tool pose.
//! - Reply: `111, 1103, last, is_vision_move, 6 values, move, tool, [velocity]`, and for a Vision Move waypoint
//!   then `21 plan values, n, n custom values`. The velocity is missing from version 2.2.
//! - Codes: as 105; 1016 also if the path is being fetched by 105.
//! - Golden file: `111_get_vision_plan_data.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 111.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GetVisionPlanData {
    /// Number of the vision project.
    pub job: i32,
    /// 1 joints, 2 tool pose; others are answered with 1026.
    pub pose_type: i32,
}

impl RequestBody for GetVisionPlanData {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self {
            job: cells.int()?,
            pose_type: cells.int()?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.job);
        cells.int(self.pose_type);
    }
}
