//! RAPID programs against a fake cabinet.

mod by_name;
mod diagnostics;
mod effects;
mod event_log;
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
