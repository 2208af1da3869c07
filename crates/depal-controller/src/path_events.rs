//! Outputs that are set when the arm passes a place of its path.

use depal_motion::{Along, Mark, MarkTime, Trajectory};
use depal_time::{SimDuration, SimTime};
use depal_vm::system::{PathAction, PathEvent, PathPlace};

/// Something on the path whose time has come.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fired {
    pub at: SimTime,
    pub action: PathAction,
}

/// Outputs that wait for the arm.
#[derive(Debug, Clone, Default)]
pub(crate) struct PathEvents {
    waiting: Vec<(Mark, PathEvent)>,
}

impl PathEvents {
    /// Ties events to the segment that was appended last.
    pub fn add(&mut self, trajectory: &Trajectory, events: &[PathEvent]) {
        for event in events {
            let along = match event.place {
                PathPlace::BeforeEnd(metres) => Along::BeforeEnd(metres),
                PathPlace::AfterStart(metres) => Along::AfterStart(metres),
            };
            self.waiting
                .push((trajectory.mark_last(along), event.clone()));
        }
    }

    /// Takes out what is passed before `end`, by time; nothing is earlier than `begin`.
    pub fn due(&mut self, trajectory: &Trajectory, begin: SimTime, end: SimTime) -> Vec<Fired> {
        let mut due = Vec::new();
        self.waiting.retain(|(mark, event)| {
            let at = match trajectory.mark_time(mark) {
                MarkTime::Passed => begin,
                MarkTime::At(seconds) => {
                    let seconds = seconds - event.lead.as_secs_f64();
                    if seconds >= end.as_secs_f64() {
                        return true;
                    }
                    let at = SimTime::ZERO + SimDuration::from_secs_f64(seconds.max(0.0));
                    at.max(begin)
                }
            };
            due.push(fired(at, event));
            false
        });
        due.sort_by_key(|fired| fired.at);
        due
    }

    /// Forgets all: the path is dropped.
    pub fn clear(&mut self) {
        self.waiting.clear();
    }
}

/// What an event that was passed at a time does.
pub(crate) fn fired(at: SimTime, event: &PathEvent) -> Fired {
    Fired {
        at: at + event.delay,
        action: event.action.clone(),
    }
}
