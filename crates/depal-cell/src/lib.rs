//! One deterministic step loop that owns the clock, the events, the score and the truth.
//!
//! A [`cell::Cell`] is built from a [`spec::CellSpec`] and a robot task, and runs to its end tick by tick,
//! in the fixed order that `crates/README.md` lists.
//! It carries bytes between robot and vision server, shapes to the camera, frames to vision, poses to the
//! planner, joint positions and valve commands to the physics; it alone compares vision with the truth.
//! [`observer::Observer`]s see what happens and change nothing.
//!
//! Units: SI, radians and simulated time; the event log has mm and degrees in its keys.
//!
//! A [`station::Station`] is the vision side alone: the same cell at rest, for robots that come over a
//! network; one session a port, and no robot program.
//!
//! Limitations: one arm, one camera; a cell with a robot program has one port, in process. A camera on the
//! flange has no housing of its own, a picture is of one instant without blur, and all pictures of one run
//! (101, 201) go through the one pose that the robot told at its start.

mod at_rest;
pub mod calibration;
mod calibration_desk;
pub mod cell;
mod computing;
mod digest;
pub mod error;
pub mod event;
mod gripper_io;
mod link;
mod mounting;
pub mod observer;
mod outcome;
mod picks;
mod picture;
mod planning;
mod plc_link;
pub mod score;
pub mod skin;
pub mod spec;
mod standing;
pub mod station;
mod surroundings;
pub mod truth;
mod vision_side;
mod waypoints;
