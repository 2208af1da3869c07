//! Vacuum gripper: sections, cups, valves, zone pressure, seal and force limits as pure state.
//!
//! [`GripperSpec`] says how a gripper is built, [`GripperState`] how it stands at an instant.
//! Once per step the caller measures what lies in front of every cup ([`CupContact`]) and gets
//! the force of every cup on its carton ([`CupForce`]).
//! Whether a carton is lifted, slips or drops is nowhere decided by a rule:
//! it follows from those forces in the physics of the caller.
//!
//! This crate must never know a physics engine, a robot program or the truth about a carton
//! (its mass, its place): only gaps, tilts and covered lips.
//!
//! ```
//! use depal_gripper::{CupContact, GripperSpec, GripperState};
//! let spec = GripperSpec::four_sections();
//! let mut state = GripperState::new(&spec);
//! let on_a_carton = vec![CupContact::touching(7, -0.012); spec.cups.len()];
//! for _ in 0..100 {
//!     state.update(&spec, &[true; 4], &on_a_carton, 0.004);
//! }
//! assert!(state.vacuum_ok());
//! assert!(state.holding_force(7) > 2000.0); // 48 cups of 44 N
//! ```
//!
//! Units: SI; pressures are *below ambient* and positive. Frame: `tcp`, middle of the cup plane,
//! Z out of the gripper towards the carton, X along its long side.
//!
//! Limitations: air flow is a first-order lag per section towards the balance of its pump and its leaks
//! ([`FlowSpec`], or a fixed share for each open cup), not a flow network; one stiffness
//! serves all shear directions; a lip that reaches over an edge leaks fully, however little;
//! a cup does not pull before its lip touches; cartons are airtight where no porosity is given.

mod cup;
mod demo;
mod event;
mod flow;
mod spec;
mod state;
mod zone;

pub use cup::{CupContact, CupForce, axial_push};
pub use event::{GripEvent, LossReason};
pub use flow::FlowSpec;
pub use spec::{CupSpec, GripperSpec, SectionSpec, VacuumSpec};
pub use state::GripperState;

#[cfg(test)]
mod tests;
