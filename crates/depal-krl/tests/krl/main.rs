//! KRL programs against a fake cabinet.

mod cabinet;
mod diagnostics;
mod failures;
mod fake_system;
mod interrupts;
mod language;
mod modules;
mod motion;
mod pick;
mod robustness;
mod signals;
mod text;
