//! 101: triggers a vision project.
//!
//! - Wire: `101, job, count, type, pose`. Pose by type: 0 six zeros; 1 joints, then flange; 2 flange; 3 joints.
//!   Accepted as well: type 1 with joints alone (up to version 1.5), type 0 without any pose.
//! - Reply: `101, 1102`, which means triggered, not finished.
//! - Codes: 1005 type, 1006 pose, 1007 running, 1011 job, 1018 count.
//! - Golden file: `101_start_vision.txt`.

use crate::Status;
use crate::cells::{CellReader, CellWriter, FieldError};
use crate::command::RequestBody;
use crate::command::robot_pose::{joints_and_flange, skip_rest, skip_zero_pose};
use crate::request::BodyError;

/// Command 101.
#[derive(Debug, Clone, PartialEq)]
pub struct StartVision {
    /// Number of the vision project.
    pub job: i32,
    /// Wanted points, 0 for all.
    pub count: i32,
    /// Where the robot is.
    pub pose: RobotPosePayload,
}

/// The pose field of command 101. Joints in degrees; flange x, y, z in mm and three angles in degrees,
/// in the brand's order.
#[derive(Debug, Clone, PartialEq)]
pub enum RobotPosePayload {
    /// Type 0: not sent.
    NotSent,
    /// Type 1: where the robot is. The flange is absent in old versions; all zeros mean "ignore".
    JointsAndFlange {
        /// Joints, degrees.
        joints_deg: [f64; 6],
        /// Flange pose in the robot base.
        flange: Option<[f64; 6]>,
    },
    /// Type 2: flange pose in the robot base (robots without six joints).
    Flange([f64; 6]),
    /// Type 3: joints from which a planned path shall start.
    StartJoints([f64; 6]),
    /// Another type; answered with 1005.
    UnknownType(i32),
}

impl RequestBody for StartVision {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        let job = cells.int()?;
        let count = cells.int()?;
        let pose_type = cells.int()?;
        let bad_pose = |e: FieldError| BodyError::with_non_finite(e, Status::InvalidVisionPose);
        let pose = match pose_type {
            0 => {
                skip_zero_pose(cells).map_err(bad_pose)?;
                RobotPosePayload::NotSent
            }
            1 => {
                let (joints_deg, flange) = joints_and_flange(cells).map_err(bad_pose)?;
                RobotPosePayload::JointsAndFlange { joints_deg, flange }
            }
            2 => RobotPosePayload::Flange(cells.reals().map_err(bad_pose)?),
            3 => RobotPosePayload::StartJoints(cells.reals().map_err(bad_pose)?),
            other => {
                skip_rest(cells).map_err(bad_pose)?;
                RobotPosePayload::UnknownType(other)
            }
        };
        Ok(Self { job, count, pose })
    }

    fn encode(&self, cells: &mut CellWriter) {
        cells.int(self.job);
        cells.int(self.count);
        match &self.pose {
            RobotPosePayload::NotSent => {
                cells.int(0);
                cells.reals(&[0.0; 6]);
            }
            RobotPosePayload::JointsAndFlange { joints_deg, flange } => {
                cells.int(1);
                cells.reals(joints_deg);
                cells.reals(&flange.unwrap_or([0.0; 6]));
            }
            RobotPosePayload::Flange(pose) => {
                cells.int(2);
                cells.reals(pose);
            }
            RobotPosePayload::StartJoints(joints_deg) => {
                cells.int(3);
                cells.reals(joints_deg);
            }
            RobotPosePayload::UnknownType(other) => cells.int(*other),
        }
    }
}
