//! 701: the dialogue of a hand-eye calibration: the robot asks where to go, goes, and tells.
//!
//! - Wire: `701, state, flange, joints`; state 0 begin, 1 reached the point, 2 could not reach it.
//!   Note the order: 101 sends joints first.
//! - Reply: `701, 7101, done, flange, joints` of the next point. `done` = 1 comes with the pose of the start,
//!   because the robot moves there before it ends.
//! - Codes: 7001 state, or nothing began; 7002 flange all zeros; 7003 joints not sent; 7004 after state 2.
//! - Golden file: `701_calibrate.txt`.

use crate::Status;
use crate::cells::{CellReader, CellWriter, FieldError};
use crate::command::RequestBody;
use crate::request::BodyError;

/// Command 701.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibrate {
    /// 0 begin, 1 reached, 2 not reached; others are answered with 7001.
    pub state: i32,
    /// Flange pose in the robot base, mm and degrees in the brand's order.
    pub flange: [f64; 6],
    /// Joints, degrees; absent joints (possible in text only) are answered with 7003.
    pub joints_deg: Option<[f64; 6]>,
}

impl RequestBody for Calibrate {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        let bad = |e: FieldError| BodyError::with_non_finite(e, Status::CalibrationParameter);
        let state = cells.int()?;
        let flange = cells.reals().map_err(bad)?;
        let joints_deg = if cells.remaining() == Some(0) {
            None
        } else {
            Some(cells.reals().map_err(bad)?)
        };
        Ok(Self {
            state,
            flange,
            joints_deg,
        })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.state);
        cells.reals(&self.flange);
        if let Some(joints) = &self.joints_deg {
            cells.reals(joints);
        }
    }
}

/// The next point of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationPoint {
    /// This is the pose of the start, and the calibration is over.
    pub is_done: bool,
    /// Flange pose in the robot base, mm and degrees in the brand's order.
    pub flange: [f64; 6],
    /// Joints, degrees.
    pub joints_deg: [f64; 6],
}

impl CalibrationPoint {
    pub(crate) fn encode(&self, cells: &mut CellWriter) {
        cells.int(i32::from(self.is_done));
        cells.reals(&self.flange);
        cells.reals(&self.joints_deg);
    }

    pub(crate) fn decode(cells: &mut CellReader<'_>) -> Result<Self, FieldError> {
        Ok(Self {
            is_done: cells.int()? != 0,
            flange: cells.reals()?,
            joints_deg: cells.reals()?,
        })
    }
}
