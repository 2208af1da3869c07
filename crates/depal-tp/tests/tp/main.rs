//! Programs, diagnostics and the vision calls, against a cabinet that writes down what is asked of it.

mod arm;
mod cabinet;
mod control;
mod diagnostics;
mod fake_system;
mod motion;
mod robustness;
mod values;
mod vision;
mod vision_calls;
