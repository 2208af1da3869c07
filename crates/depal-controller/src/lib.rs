//! A virtual robot cabinet: tasks, the motion queue of one arm, signals, and sockets as a trait.
//!
//! [`Controller::tick`] is one interpolation cycle of 4 ms. First the tasks run, one after the other: each statement
//! costs a fixed simulated time, and a task that waits ends its part of the cycle. Then the motion moves on to the end of the cycle.
//! The program runs ahead of the arm: a fly-by move is taken while fewer than
//! [`queue_depth`](ControllerSpec::queue_depth) moves wait behind the one under way, so statements behind it run
//! before the arm arrives. A language waits for a fine move with
//! [`is_move_done`](depal_vm::system::System::is_move_done).
//!
//! What it must never know: any robot language, the physics, the vision system, real sockets or clocks.
//!
//! ```
//! # use std::sync::Arc;
//! use depal_controller::{Controller, ControllerSpec, NoNetwork, SignalKind, SignalSpec};
//! use depal_time::{SimTime, TICK};
//! # fn example(arm: Arc<depal_arm::Arm>) -> Result<(), depal_controller::ControllerError> {
//! let home = depal_frames::JointPositions::zeros(arm.joint_count());
//! let mut spec = ControllerSpec::new("rob1", arm, home);
//! spec.signals.push(SignalSpec::new("do_vacuum", SignalKind::DigitalOutput));
//! let mut controller = Controller::new(spec)?;
//! let mut now = SimTime::ZERO;
//! controller.tick(now, &mut NoNetwork);
//! now += TICK;
//! let joints = controller.commanded_joints(); // at `now`
//! while let Some(event) = controller.poll_event() { /* record it */ }
//! # let _ = joints; Ok(()) }
//! ```
//!
//! Units and frames: SI, radians, simulated time; poses in the robot base.
//!
//! Limitations: what a task changes in a cycle (signals, shared data) the tasks behind it see in the same cycle and
//! those before it in the next one; a task that ended is not started again; one that stopped
//! itself goes on at [`Controller::restart`], which no command of `depal` calls (an `exec` ends there): event routines of RESTART
//! run for those who embed a controller; no signal delay; a speed override holds for the moves that follow;
//! every stop on the path brakes as hard as the arm can;
//! the servo follows exactly; a wait inside a task ends with the cycle, so it is 4 ms coarse.

mod cabinet;
mod configuration;
mod configuration_data;
mod controller;
mod eio;
mod error;
mod event;
mod free_motion;
mod free_path;
mod mechanism;
mod meeting;
mod motion_queue;
mod network;
mod path_events;
mod shared;
mod signals;
mod sio;
mod sockets;
mod sys;
mod system;
mod task;
mod transcript;

pub use cabinet::{Cabinet, ControllerSpec, FreeSpec};
pub use configuration::{ConfigurationError, configuration_domain};
pub use configuration_data::ConfigurationData;
pub use controller::Controller;
pub use eio::EioConfiguration;
pub use error::ControllerError;
pub use event::{ControllerEvent, ControllerState};
pub use network::{Network, NoNetwork};
pub use signals::{CrossConnection, Signal, SignalFamily, SignalKind, SignalSpec};
pub use sio::SioConfiguration;
pub use sys::{EventRoutine, SysConfiguration, TaskModule, TaskSpec};
pub use task::TaskRole;
pub use transcript::{
    Exchange, RecordingNetwork, ReplayNetwork, Transcript, TranscriptError, TranscriptLine,
};

#[cfg(test)]
mod tests;
