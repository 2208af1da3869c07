//! 100: runs a vision project and answers with its result, in one exchange.
//!
//! - Wire: `100, job, recipe, format, joints, flange`; both poses are always sent, zeros mean "not sent";
//!   recipe 0 keeps the one chosen before. Format 1 points as 102, 2 one point with custom data as 110,
//!   3 path of joints as 105, 4 path of tool poses as 105.
//! - Reply: headed 100, of the form of the command it stands for. What does not fit is fetched by that command.
//! - Codes: those of 101, 103 and the command it stands for; 1026 format.
//! - Golden file: `100_run_vision.txt`.

use crate::Status;
use crate::cells::{CellReader, CellWriter, FieldError};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 100.
#[derive(Debug, Clone, PartialEq)]
pub struct RunVision {
    /// Number of the vision project.
    pub job: i32,
    /// Recipe to switch to, 0 for none.
    pub recipe: i32,
    /// 1 to 4; others are answered with 1026.
    pub format: i32,
    /// Joints, degrees.
    pub joints_deg: [f64; 6],
    /// Flange pose in the robot base, mm and degrees in the brand's order.
    pub flange: [f64; 6],
}

impl RequestBody for RunVision {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        let bad_pose = |e: FieldError| BodyError::with_non_finite(e, Status::InvalidVisionPose);
        Ok(Self {
            job: cells.int()?,
            recipe: cells.int()?,
            format: cells.int()?,
            joints_deg: cells.reals().map_err(bad_pose)?,
            flange: cells.reals().map_err(bad_pose)?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.job);
        cells.int(self.recipe);
        cells.int(self.format);
        cells.reals(&self.joints_deg);
        cells.reals(&self.flange);
    }
}
