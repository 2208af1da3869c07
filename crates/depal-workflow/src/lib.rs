//! The planning project ("Viz project"): steps and branches, run by a small engine.
//!
//! A [`Project`] is what a user of the vision system has set up: recognise, pick, place, move, branch.
//! [`Engine`] walks through it and says what it needs next as an [`Ask`]; whoever drives it answers.
//!
//! This crate must never know vision, planner, wire or time: a recognition is a verdict, a planned pick is
//! a value of the driver's own type `P`, a failure is the status code that the driver gives.
//!
//! ```
//! use depal_workflow::{Ask, Engine, Place, Project, Step, StepKind};
//! let project = Project::new(vec![
//!     Step::new(1, StepKind::VisualRecognition { project: 1 }),
//!     Step::new(2, StepKind::VisionMove { uses_sections: true }),
//!     Step::new(3, StepKind::PalletPattern { place: Place::Conveyor }),
//! ]);
//! let mut engine: Engine<&str> = Engine::new(project, &[1]).unwrap();
//! assert!(matches!(engine.start(), Ask::Recognise { project: 1, .. }));
//! assert!(matches!(engine.recognised(Ok(())), Ask::PlanPick { place: Some(Place::Conveyor), .. }));
//! assert!(matches!(engine.planned(Ok("the path")), Ask::Done(_)));
//! ```
//!
//! Joints in radians, velocities in percent.
//!
//! Not yet here: index-type steps, relative moves, external moves, notify, reuse of a vision result.

mod check;
mod engine;
mod project;

pub use check::WorkflowError;
pub use engine::{Ask, Engine, Failure, PickRequest, Piece};
pub use project::{FixedPoint, MoveMotion, Next, Place, Project, Step, StepKind};

#[cfg(test)]
mod tests;
