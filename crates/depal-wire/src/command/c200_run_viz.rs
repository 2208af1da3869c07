//! 200: starts the Viz project, chooses a branch and answers with the path, in one exchange.
//!
//! - Wire: `200, step, port, type, joints, flange`; step 0 for no branch; type as in 205;
//!   both poses are always sent, zeros mean "not sent".
//! - Reply: headed 200, of the form of 205. Further parts are fetched by 205.
//! - Codes: those of 201, 203 and 205.
//! - Golden file: `200_run_viz.txt`.

use crate::Status;
use crate::cells::{CellReader, CellWriter, FieldError};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 200.
#[derive(Debug, Clone, PartialEq)]
pub struct RunViz {
    /// Id of the branch step, 0 for none.
    pub step: i32,
    /// Exit port, counted from 1; not used without a step.
    pub port: i32,
    /// 1 joints, 2 tool pose; others are answered with 2012.
    pub pose_type: i32,
    /// Joints, degrees.
    pub joints_deg: [f64; 6],
    /// Flange pose in the robot base, mm and degrees in the brand's order.
    pub flange: [f64; 6],
}

impl RequestBody for RunViz {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        let bad_pose = |e: FieldError| BodyError::with_non_finite(e, Status::InvalidVizPose);
        Ok(Self {
            step: cells.int()?,
            port: cells.int()?,
            pose_type: cells.int()?,
            joints_deg: cells.reals().map_err(bad_pose)?,
            flange: cells.reals().map_err(bad_pose)?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.step);
        cells.int(self.port);
        cells.int(self.pose_type);
        cells.reals(&self.joints_deg);
        cells.reals(&self.flange);
    }
}
