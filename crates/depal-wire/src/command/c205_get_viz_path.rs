//! 205: fetches the path of the Viz project.
//!
//! - Wire: `205, type`; 1 joints, 2 tool pose.
//! - Reply: `205, 2100, last, n, vis, n x (6 values, label, velocity)`; ask again while `last` is 0.
//!   `vis` is the place of the first Vision Move waypoint, from 1; in later parts it counts from that part's
//!   first point, 0 once it is past.
//! - Codes: 2012 type, 2022 not started or all fetched, 2025 timeout, 2037, 2038 and others of the run.
//! - Golden file: `205_get_viz_path.txt`.

use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 205.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GetVizPath {
    /// 1 joints, 2 tool pose; others are answered with 2012.
    pub pose_type: i32,
}

impl RequestBody for GetVizPath {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        Ok(Self {
            pose_type: cells.int()?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.pose_type);
    }
}
