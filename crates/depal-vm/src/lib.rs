//! Spans, diagnostics, values and one stackless virtual machine for robot languages.

pub mod execution;
pub mod system;
