//! The border between whatever runs as a robot task (the virtual machine, a PLC sequence) and the cabinet.

use std::fmt::Write;

use depal_time::SimTime;

use crate::system::{ProgramLocation, System};
use crate::{SharedDatum, Value};

/// What one step of a task did.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// One statement ran; it costs simulated time.
    Ran,
    /// The task waits; ask again in the next tick. Costs nothing more in this one.
    Blocked,
    /// The entry routine returned.
    Finished,
    /// The program asked to stop (Stop, EXIT), with its reason in words.
    Stopped(String),
    /// An error that no handler took.
    Failed(RuntimeError),
}

/// An unhandled run-time error, as the operator reads it.
#[derive(Debug, Clone, PartialEq)]
pub struct RuntimeError {
    /// Name of the error in the program's language, `ERR_SOCK_TIMEOUT`.
    pub name: String,
    /// What happened, with numbers and units, and what to do.
    pub message: String,
    /// Innermost place first, then its callers.
    pub call_stack: Vec<ProgramLocation>,
}

impl RuntimeError {
    /// The lines that an operator reads: `MODULE/ROUTINE:LINE: NAME: message`, then where that was called from,
    /// innermost first, then the task and the simulated time `at` which it happened.
    pub fn report(&self, at: SimTime) -> String {
        let inner = self.call_stack.first().cloned().unwrap_or_default();
        let message = match self.name.as_str() {
            "" => self.message.clone(),
            name => format!("{name}: {}", self.message),
        };
        let mut text = format!(
            "{}/{}:{}: {}",
            inner.module,
            inner.routine,
            inner.line,
            message.replace(['\n', '\r'], " ")
        );
        let callers = self.call_stack.get(1..).unwrap_or_default();
        for same in callers.chunk_by(|a, b| a == b) {
            let caller = &same[0];
            let times = match same.len() {
                1 => String::new(),
                times => format!(", {times} times"),
            };
            let _ = write!(
                text,
                "\n  called from {}/{}:{}{times}",
                caller.module, caller.routine, caller.line
            );
        }
        let _ = write!(
            text,
            "\n  task {} at {:.3} s of simulated time",
            inner.task,
            at.as_secs_f64()
        );
        text
    }
}

/// A task that the controller drives: a statement at a time, never blocking.
pub trait RobotTask {
    /// Runs at most one statement, or, if they ask nothing of the cabinet, as many more as it
    /// [has time for](System::spare_statements).
    fn step(&mut self, system: &mut dyn System) -> Step;
    /// Where the program pointer stands.
    fn location(&self) -> ProgramLocation;

    /// Computes initial values, if that has not been done, so that shared data can be compared before any
    /// task begins. [`step`](Self::step) does it otherwise.
    fn initialize(&mut self, system: &mut dyn System) {
        let _ = system;
    }
    /// Goes on behind the statement with which the task stopped itself. Whether it can.
    fn restart(&mut self) -> bool {
        false
    }
    /// The data that this task shares by name with others of its cabinet.
    fn shared_data(&self) -> &[SharedDatum] {
        &[]
    }
    /// Value of one of them, by its place in the list.
    fn shared_value(&self, index: usize) -> Option<&Value> {
        let _ = index;
        None
    }
    /// Another task changed one of them.
    fn set_shared(&mut self, index: usize, value: Value) {
        let _ = (index, value);
    }
}
