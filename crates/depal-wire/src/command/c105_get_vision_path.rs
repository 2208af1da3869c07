//! 105: fetches the path planned by a vision project.
//!
//! - Wire: `105, job, type`; 1 joints, 2 tool pose.
//! - Reply: `105, 1103, last, n, vis, n x (6 values, label, velocity or tool)`; ask again while `last` is 0.
//!   `vis` is the place of the next Vision Move waypoint, from 1, seen from this part's first point; 0 if none follows.
//! - Codes: 1002 nothing found or all fetched, 1011 job, 1016 no path project or fetched by 111, 1019 timeout,
//!   1020 not started, 1026 type, and others of the run.
//! - Golden file: `105_get_vision_path.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 105.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GetVisionPath {
    /// Number of the vision project.
    pub job: i32,
    /// 1 joints, 2 tool pose; others are answered with 1026.
    pub pose_type: i32,
}

impl RequestBody for GetVisionPath {
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
