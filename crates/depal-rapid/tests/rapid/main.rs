//! RAPID programs against a fake cabinet.

mod diagnostics;
mod effects;
mod fake_system;
mod interrupts;
mod language;
mod mistakes;
mod orientation;
mod robustness;
mod rules;
mod syntax;
