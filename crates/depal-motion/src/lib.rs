//! The one time law of the arm: joint and linear moves, stop points and fly-by corners, under joint,
//! tool-centre and reorientation limits. The planner predicts with it and the cabinet moves with it.
//!
//! A [`Trajectory`] is a growing path in joint space and the fastest law along it.
//! Geometry: a joint move is a straight line in joint space; a linear move is a straight line of the tool centre
//! point (TCP), or an arc of it, with an even turn, brought to joints by inverse kinematics on a fine grid; a fly-by corner is a
//! parabola in joint space (a cubic with the same hull where a neighbour is a linear move), tangent to both moves.
//! Law: the path is cut into cells with constant path acceleration; a backward pass finds the highest speed from
//! which the arm can still obey everything ahead, a forward pass takes the highest acceleration
//! (Pham and Pham, "A new approach to time-optimal path parameterization based on reachability analysis",
//! IEEE T-RO 34(3), 2018, doi 10.1109/TRO.2018.2819195, with collocation at three places of each cell).
//!
//! What it must never know: programs, signals, cartons, collisions.
//!
//! ```no_run
//! # use std::sync::Arc;
//! # use depal_frames::{JointPositions, Pose};
//! use depal_motion::{Interpolation, Segment, SegmentTarget, Speed, Trajectory, Zone};
//! # fn example(arm: Arc<depal_arm::Arm>, home: JointPositions, above: JointPositions) -> Result<(), depal_motion::MotionError> {
//! let mut trajectory = Trajectory::new(arm, home);
//! trajectory.append(0.0, &Segment {
//!     interpolation: Interpolation::Joint,
//!     target: SegmentTarget::Joints(above),
//!     flange_from_tcp: Pose::identity(),
//!     speed: Speed { tcp: 2.0, orientation: 8.0, joint_fraction: 1.0, acceleration_fraction: 1.0 },
//!     zone: Zone::Fine,
//!     quarters: None,
//! })?;
//! let halfway = trajectory.sample(trajectory.duration() / 2.0);
//! # let _ = halfway; Ok(()) }
//! ```
//!
//! Units and frames: SI, radians; joint order of the arm; TCP poses are `base_from_tcp`; times are seconds since
//! the trajectory's own zero.
//!
//! A [`BlendedPath`] is a chain of joint moves whose corners are parabolas of a given size; its time is worked out without
//! a trajectory, for a planner that compares many. [`Zone::Blend`] has a trajectory fly the very same curve, and both go
//! through the same passes, so that a time that is said is the time it takes.
//! [`Trapezoid`] is the law of one straight move from stand to stand.
//!
//! Torques: where the arm's file has them (`effort` and masses), no axis is asked for more than its torque, with the
//! load named to [`Trajectory::set_tool_and_load`] and with the tool alone. A torque is linear in the path's acceleration
//! and squared speed, as the accelerations of the joints are, so the same passes find the fastest law under it.
//! An arm without torque limits moves as if none of this existed. Torques do not count in [`BlendedPath::time`],
//! [`BlendedPath::rough_time`], [`Trapezoid`] and [`slowest_joint_time`]; they do in [`BlendedPath::loaded_time`].
//!
//! Limitations: acceleration may step (no jerk limit); no friction or rotor inertia in torques; no servo lag;
//! speed of the TCP is not limited in acceleration other than through the joints;
//! the TCP may leave the plane of two linear moves a little in their corner, which is blended in joint space.

mod blended;
mod blended_law;
mod cell;
mod circle;
mod curve;
mod error;
mod hold;
mod mark;
mod passes;
mod segment;
mod shape;
mod timing;
mod torque;
mod trajectory;
mod trapezoid;

pub use blended::{BlendedPath, Piece, Samples};
pub use circle::Circle;
pub use error::MotionError;
pub use mark::{Along, Mark, MarkTime};
pub use segment::{Interpolation, Segment, SegmentId, SegmentTarget, Speed, Zone};
pub use trajectory::Trajectory;
pub use trapezoid::{Trapezoid, point_to_point_time, slowest_joint_time};

#[cfg(test)]
mod tests;
