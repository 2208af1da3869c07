//! 502: hands a tool pose to the "external move" steps of the Viz project.
//!
//! - Wire: `502, pose`, before 201.
//! - Reply: `502, 2107`.
//! - Codes: 2013 pose.
//! - Golden file: `502_set_outer_pose.txt`.

use crate::Status;
use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 502.
#[derive(Debug, Clone, PartialEq)]
pub struct SetOuterPose {
    /// Tool pose in the robot base, mm and degrees in the brand's order.
    pub pose: [f64; 6],
}

impl RequestBody for SetOuterPose {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        let pose = cells.reals();
        Ok(Self {
            pose: pose.map_err(|e| BodyError::with_non_finite(e, Status::InvalidVizPose))?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.reals(&self.pose);
    }
}
