//! 201: starts the Viz project.
//!
//! - Wire: `201, type, pose`. Pose by type: 0 six zeros; 1 joints, then flange; 2 joints of a taught start.
//! - Reply: `201, 2103`.
//! - Codes: 2002 running, 2006 type, 2013 pose, 2014 no project.
//! - Golden file: `201_start_viz.txt`.

use crate::Status;
use crate::cells::{CellReader, CellWriter, FieldError};
use crate::command::RequestBody;
use crate::command::robot_pose::{joints_and_flange, skip_rest, skip_zero_pose};
use crate::request::BodyError;

/// Command 201.
#[derive(Debug, Clone, PartialEq)]
pub struct StartViz {
    /// Where the planned path starts.
    pub start: VizStartPayload,
}

/// The pose field of command 201. Joints in degrees, flange in mm and degrees, brand order.
#[derive(Debug, Clone, PartialEq)]
pub enum VizStartPayload {
    /// Type 0: the planner's own home.
    NotSent,
    /// Type 1: where the robot is.
    JointsAndFlange {
        /// Joints, degrees.
        joints_deg: [f64; 6],
        /// Flange pose in the robot base; absent when not sent or all zeros.
        flange: Option<[f64; 6]>,
    },
    /// Type 2: joints where the robot will be when it starts to move.
    StartJoints([f64; 6]),
    /// Another type; answered with 2006.
    UnknownType(i32),
}

impl RequestBody for StartViz {
    fn decode(cells: &mut CellReader<'_>) -> Result<Self, BodyError> {
        let pose_type = cells.int()?;
        let bad_pose = |e: FieldError| BodyError::with_non_finite(e, Status::InvalidVizPose);
        let start = match pose_type {
            0 => {
                skip_zero_pose(cells).map_err(bad_pose)?;
                VizStartPayload::NotSent
            }
            1 => {
                let (joints_deg, flange) = joints_and_flange(cells).map_err(bad_pose)?;
                VizStartPayload::JointsAndFlange { joints_deg, flange }
            }
            2 => VizStartPayload::StartJoints(cells.reals().map_err(bad_pose)?),
            other => {
                skip_rest(cells).map_err(bad_pose)?;
                VizStartPayload::UnknownType(other)
            }
        };
        Ok(Self { start })
    }

    fn encode(&self, cells: &mut CellWriter) {
        match &self.start {
            VizStartPayload::NotSent => {
                cells.int(0);
                cells.reals(&[0.0; 6]);
            }
            VizStartPayload::JointsAndFlange { joints_deg, flange } => {
                cells.int(1);
                cells.reals(joints_deg);
                cells.reals(&flange.unwrap_or([0.0; 6]));
            }
            VizStartPayload::StartJoints(joints_deg) => {
                cells.int(2);
                cells.reals(joints_deg);
            }
            VizStartPayload::UnknownType(other) => cells.int(*other),
        }
    }
}
