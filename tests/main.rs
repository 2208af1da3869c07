//! One test binary: what only the whole house can show.

mod brands;
mod calibration;
mod counterfactuals;
mod determinism;
mod faults;
mod interface;
mod modules;
mod moves;
mod runner;
mod scenes;
mod siemens;
mod tidy;
