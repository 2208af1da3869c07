//! One test binary: what only the whole house can show.

mod ahead;
mod brands;
mod calibration;
mod counterfactuals;
mod determinism;
mod eye_in_hand;
mod faults;
mod interface;
mod meshes;
mod modules;
mod moves;
mod runner;
mod scenes;
mod siemens;
mod talk;
mod tidy;
