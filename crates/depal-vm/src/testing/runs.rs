use std::sync::Arc;

use depal_time::{SimDuration, SimTime, TICK};

use crate::execution::{RobotTask, Step};
use crate::system::System;
use crate::{Loaded, Program, SourceFile};

/// Time of a statement.
const STATEMENT: SimDuration = SimDuration::from_micros(20);

/// A run that takes longer hangs: 1000 simulated seconds.
const LONGEST: SimTime = SimTime::from_nanos(1_000_000_000_000);

/// A cabinet whose time a test sets.
pub trait Timed: System {
    /// It is so late now; what is due happens.
    fn set_time(&mut self, now: SimTime);
}

/// Runs a task to its end: 20 us a statement, a tick of 4 ms where it waits.
///
/// # Panics
/// If it takes more than 1000 simulated seconds.
pub fn run(task: &mut dyn RobotTask, cabinet: &mut impl Timed) -> Step {
    loop {
        let now = cabinet.now();
        let later = match task.step(cabinet) {
            Step::Ran => now + STATEMENT,
            Step::Blocked => {
                let ticks = now.as_nanos() / TICK.as_nanos() + 1;
                SimTime::from_nanos(ticks * TICK.as_nanos())
            }
            end => return end,
        };
        cabinet.set_time(later);
        assert!(later < LONGEST, "hangs at {:?}", task.location());
    }
}

/// The program that was loaded.
///
/// # Panics
/// With all messages, if there is none.
#[track_caller]
pub fn program(loaded: Loaded, sources: &[SourceFile]) -> Arc<Program> {
    loaded.program.unwrap_or_else(|| {
        let shown = loaded.diagnostics.iter().map(|d| d.plain(sources));
        panic!("{}", shown.collect::<Vec<_>>().join("\n"))
    })
}
