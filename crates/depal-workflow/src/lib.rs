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
//!     Step::new(1, StepKind::VisualRecognition { project: 1, reuses_result: false }),
//!     Step::new(2, StepKind::VisionMove { uses_sections: true, plans_all: false, max_group: 1, velocity_percent: 80.0 }),
//!     Step::new(3, StepKind::PalletPattern { place: Place::Conveyor }),
//! ]);
//! let mut engine: Engine<&str> = Engine::new(project, &[1]).unwrap();
//! assert!(matches!(engine.start(), Ask::Recognise { project: 1, .. }));
//! assert!(matches!(engine.recognised(Ok(())), Ask::PlanPick { place: Some(Place::Conveyor), .. }));
//! assert!(matches!(engine.planned(Ok("the path")), Ask::Done(_)));
//! ```
//!
//! Joints in radians, lengths in metres, velocities in percent; [`Engine::parameter`] speaks the wire's millimetres.
//! Poses of moves are tool poses in the robot base; a pattern's places are those of a carton's bottom face.
//!
//! Steps with an index (lists, grids, patterns) take their places one after another from 0 in every run;
//! [`Engine::set_index`] takes the number of command 204, which is one more than the index.
//!
//! Limitations: a conveyor place follows its pick without moves between, because the planner finds that whole way;
//! a step's index and parameters are numbers only.

mod ask;
mod check;
mod engine;
mod parameter;
mod pattern;
mod project;
mod text;

pub use ask::{Ask, Failure, IndexError, Move, PickRequest, Piece, Target};
pub use check::WorkflowError;
pub use engine::Engine;
pub use parameter::{Parameter, ParameterError, Writable};
pub use pattern::{CartonPattern, Grid, Layers};
pub use project::{
    MoveMotion, Next, OffsetFrame, Place, Project, Reference, Step, StepKind, Travel,
};

#[cfg(test)]
mod tests;
