//! RAPID programs against a fake cabinet.

mod diagnostics;
mod effects;
mod failures;
mod fake_system;
mod generate;
mod interrupts;
mod language;
mod mistakes;
mod modules;
mod orientation;
mod robustness;
mod rules;
mod syntax;
mod thrown;
