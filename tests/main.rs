//! One test binary: what only the whole house can show.

mod counterfactuals;
mod determinism;
mod runner;
mod scenes;
mod siemens;
mod tidy;
