//! Vacuum gripper: sections, cups, valves, zone pressure, seal and force limits as pure state.

mod spec;

pub use spec::{CupSpec, GripperSpec, SectionSpec, VacuumSpec};
