//! The program of a Siemens controller that empties a pallet: it owns the data block, and the arm obeys it.
//!
//! [`PlcTask`] is a robot task like any other: the cabinet runs it, and what it needs it asks of
//! [`depal_vm::system::System`]. It listens on the ISO-on-TCP port and answers vision's reads and writes of the
//! block with real telegrams; between them runs the sequence of an integrator's program:
//! 901, 501, 201 (or 101), 203, 210 (or 205, 105), 206, then the waypoints one after another with the vacuum
//! sections at the Vision Move, and the next run as soon as the carton is released.
//!
//! It must never know how vision works, what an arm is, or what hangs on the gripper but for the vacuum switch.
//!
//! ```
//! use depal_plc::{PlcSettings, PlcTask};
//! use depal_vm::execution::RobotTask;
//! let task = PlcTask::new(PlcSettings::default());
//! assert_eq!(task.location().task, "PLC");
//! ```
//!
//! Millimetres and degrees in the block; SI and radians inside.
//!
//! Limitations: one arm, one connection at a time, and programs are settings of this sequence, not SCL or STL.

mod call;
mod path;
mod sequence;
mod settings;
mod task;

pub use settings::{Fetch, PlcSettings, Source};
pub use task::PlcTask;

#[cfg(test)]
mod tests;
