use std::time::{Duration, Instant};

use depal_time::TICK;

/// Ticks against the wall clock, one for one.
#[derive(Debug)]
pub(crate) struct PacedClock {
    origin: Instant,
    origin_tick: u64,
}

impl PacedClock {
    pub(crate) fn new(tick: u64) -> Self {
        Self {
            origin: Instant::now(),
            origin_tick: tick,
        }
    }

    /// The tick that the wall clock had reached at `at`; the one of the origin for what was before it.
    pub(crate) fn tick_at(&self, at: Instant) -> u64 {
        let elapsed = at.saturating_duration_since(self.origin).as_nanos() as u64;
        self.origin_tick + elapsed / TICK.as_nanos()
    }

    /// Time stood still at `tick`: it goes on from there.
    pub(crate) fn go_on_from(&mut self, tick: u64) {
        *self = Self::new(tick);
    }

    /// Until the wall clock reaches `tick`.
    pub(crate) fn until(&self, tick: u64) -> Duration {
        let due = Duration::from_nanos((tick - self.origin_tick.min(tick)) * TICK.as_nanos());
        due.saturating_sub(self.origin.elapsed())
    }
}
