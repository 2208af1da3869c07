//! A calibration in progress.

use depal_frames::{DepthFrame, Pose};

use super::board::{CircleBoard, Mounting};
use super::find_board::{BoardView, find_board};
use super::problem::{CalibrationProblem, CaptureProblem};
use super::solve::{Calibration, Capture, TouchedPoint, calibrate};

/// What one picture gave.
#[derive(Debug, Clone, PartialEq)]
pub struct CaptureReport {
    /// Usable captures so far, this one included.
    pub usable: usize,
    /// Poses that are still to come, see [`Session::next_pose`].
    pub poses_left: usize,
    /// The board as it was seen.
    pub view: BoardView,
}

/// A calibration in progress: pictures go in, each with the flange pose that the robot reports.
///
/// A picture that is refused costs nothing but itself: the session goes on with the next pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Session {
    board: CircleBoard,
    mounting: Mounting,
    poses: Vec<Pose>,
    tried: usize,
    captures: Vec<Capture>,
    touched: Vec<TouchedPoint>,
}

impl Session {
    /// An empty session. `poses` (`base_from_flange`) are those that [`Session::next_pose`] hands out;
    /// they may be none when somebody else leads the robot.
    ///
    /// # Errors
    /// [`CalibrationProblem::Board`].
    pub fn new(
        board: CircleBoard,
        mounting: Mounting,
        poses: Vec<Pose>,
    ) -> Result<Self, CalibrationProblem> {
        board.validate()?;
        Ok(Self {
            board,
            mounting,
            poses,
            tried: 0,
            captures: Vec::new(),
            touched: Vec::new(),
        })
    }

    /// Where the robot should go next; none when all poses have had their picture.
    pub fn next_pose(&self) -> Option<&Pose> {
        self.poses.get(self.tried)
    }

    /// Takes a picture that was taken with the flange at `base_from_flange`.
    ///
    /// # Errors
    /// Why the picture is of no use; the session then stands at the next pose all the same.
    pub fn capture(
        &mut self,
        frame: &DepthFrame,
        base_from_flange: &Pose,
    ) -> Result<CaptureReport, CaptureProblem> {
        self.tried += 1;
        if !base_from_flange
            .to_homogeneous()
            .iter()
            .all(|x| x.is_finite())
        {
            return Err(CaptureProblem::BadPose);
        }
        let view = find_board(frame, &self.board)?;
        self.captures.push(Capture {
            base_from_flange: *base_from_flange,
            centres_in_camera: view.centres.clone(),
        });
        Ok(CaptureReport {
            usable: self.captures.len(),
            poses_left: self.poses.len().saturating_sub(self.tried),
            view,
        })
    }

    /// Skips the next pose: the robot did not reach it.
    pub fn skip(&mut self) {
        self.tried += 1;
    }

    /// Adds a point that the robot touched and the camera saw: arms with parallel axes need one.
    pub fn touch(&mut self, point: TouchedPoint) {
        self.touched.push(point);
    }

    /// Usable captures so far.
    pub fn captures(&self) -> &[Capture] {
        &self.captures
    }

    /// Estimates the camera's pose from all usable captures.
    ///
    /// # Errors
    /// See [`CalibrationProblem`].
    pub fn finish(&self) -> Result<Calibration, CalibrationProblem> {
        calibrate(&self.board, self.mounting, &self.captures, &self.touched)
    }
}
