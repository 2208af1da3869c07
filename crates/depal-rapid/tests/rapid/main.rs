//! RAPID programs against a fake cabinet.

mod diagnostics;
mod effects;
mod fake_system;
mod interrupts;
mod language;
mod modules;
mod robustness;
