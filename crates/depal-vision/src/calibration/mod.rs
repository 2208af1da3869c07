//! Hand-eye calibration: where the camera is, from pictures of a board of discs and the arm's own poses.
//!
//! A [`Session`] takes one picture after another, each with the flange pose that the robot reports,
//! and ends in a [`Calibration`]: the camera's pose in the robot base (camera fixed, board on the
//! flange) or in the flange (camera on the flange, board fixed), with its residuals.
//!
//! It must never know where camera and board really are, nor anything of the scene.
//!
//! ```
//! use depal_frames::{DepthFrame, Intrinsics, Pose};
//! use depal_vision::calibration::{CaptureProblem, CircleBoard, Mounting, Session};
//! let board = CircleBoard { columns: 9, rows: 7, pitch: 0.040, disc_diameter: 0.020 };
//! let mut session = Session::new(board, Mounting::EyeToHand, Vec::new()).unwrap();
//! let intrinsics = Intrinsics { width: 64, height: 48, fx: 80.0, fy: 80.0, cx: 31.5, cy: 23.5 };
//! let refused = session.capture(&DepthFrame::blank(intrinsics), &Pose::identity());
//! assert!(matches!(refused, Err(CaptureProblem::NoBoard { .. })));
//! assert!(session.finish().is_err()); // three captures are the least
//! ```
//!
//! # Method
//!
//! 1. `find_board`: dark blobs in the intensity image, the depth's plane through them, a circle
//!    fitted to each disc's outline on that plane (perspective does not shift its centre there),
//!    the grid's numbers, and from three larger discs its origin and direction.
//! 2. `closed_form`: rotations first (Park and Martin 1994), then positions, linear.
//! 3. `joint`: Levenberg-Marquardt over both unknown transforms on all disc centres at once.
//!    `weights`: what disturbs a whole picture (repeatability, plane fit) is not averaged over its discs.
//!    The spread of the board over the volume then fixes the camera's direction, which is far
//!    better known than the direction of a small board.
//! 4. `observability`: motions that leave something open are refused, and what is open is named.
//!
//! # Frames
//!
//! Metres and radians. Board frame: middle of the grid on the printed face, X along a row of discs,
//! Y along a column, Z out of the face.
//!
//! # Limitations
//!
//! The lens has no distortion, the arm's kinematics are taken as true, and one plane is fitted to
//! the board: a bent board shows in the residuals only.

mod blobs;
mod board;
mod closed_form;
mod discs;
mod find_board;
mod grid;
mod joint;
mod observability;
mod poses;
mod problem;
mod session;
mod solve;
mod weights;

pub use board::{CircleBoard, Mounting};
pub use find_board::{BoardView, find_board};
pub use poses::{PosePlan, plan_poses, sees_board};
pub use problem::{CalibrationProblem, CaptureProblem, PoseProblem};
pub use session::{CaptureReport, Session};
pub use solve::{Calibration, Capture, PoseResidual, TouchedPoint, calibrate};
