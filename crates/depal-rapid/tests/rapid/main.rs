//! RAPID programs against a fake cabinet.

mod diagnostics;
mod effects;
mod fake_system;
mod language;
mod robustness;
