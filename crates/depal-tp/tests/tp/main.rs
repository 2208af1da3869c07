//! Programs, diagnostics and the vision calls, against a cabinet that writes down what is asked of it.

mod control;
mod fake_system;
mod motion;
mod values;
mod vision;
mod vision_calls;
