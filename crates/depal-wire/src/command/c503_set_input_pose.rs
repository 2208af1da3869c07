//! 503: hands a pose to a named step of a vision project.
//!
//! - Wire: `503, job, step name, pose`, before 101. Text only: no packed form is documented.
//! - Reply: `503, 1110`.
//! - Codes: 1007 running, 1011 job, 1051 unknown step or impossible pose.
//! - Golden file: `503_set_input_pose.txt`.

use crate::Status;
use crate::cells::{CellReader, CellWriter};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 503.
#[derive(Debug, Clone, PartialEq)]
pub struct SetInputPose {
    /// Number of the vision project.
    pub job: i32,
    /// Name of the step.
    pub step: String,
    /// Pose, mm and degrees in the brand's order.
    pub pose: [f64; 6],
}

impl RequestBody for SetInputPose {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        let job = cells.int()?;
        let step = cells.text()?;
        let pose = cells.reals();
        Ok(Self {
            job,
            step,
            pose: pose.map_err(|e| BodyError::with_non_finite(e, Status::PoseNotSet))?,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.job);
        cells.text_field(&self.step);
        cells.reals(&self.pose);
    }
}
