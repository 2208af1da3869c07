//! Stopping on the path without losing it.

use crate::Trajectory;
use crate::cell::{Cell, CellLimits, Law};
use crate::segment::Speed;
use crate::timing::{brake, fastest};

/// The law of a cell that is not timed: it begins when the path is resumed.
const HELD: Law = Law {
    start: f64::INFINITY,
    duration: 0.0,
    rate: 0.0,
    acceleration: 0.0,
};

impl Trajectory {
    /// Stops on the path as soon as the full joint accelerations allow, and keeps the rest of it until
    /// [`resume`](Self::resume). Segments may be appended meanwhile; none of the rest is done before.
    pub fn hold(&mut self, now: f64) {
        let free = self.divide(now);
        let rest = self.cells.split_off(free);
        let moving = self
            .cells
            .last()
            .filter(|cell| cell.law.end() >= now && cell.law.end_rate() > 0.0);
        let (laws, stand) = match (moving, rest.first()) {
            (Some(cell), Some(first)) if first.law.start.is_finite() => {
                let rate = cell.law.end_rate() * first.link;
                let full = CellLimits::new(self.arm.limits(), &Speed::UNLIMITED).joint_acceleration;
                brake(&rest, &full, rate * rate, cell.law.end())
            }
            _ => (Vec::new(), 0.0),
        };
        let braking = laws.len();
        let mut laws = laws.into_iter();
        let mut first_held = true;
        for (index, cell) in rest.into_iter().enumerate() {
            let mut held = match laws.next() {
                None => cell,
                Some(law) if index + 1 < braking || cell.to - stand < 1e-9 => {
                    self.cells.push(Cell { law, ..cell });
                    continue;
                }
                Some(law) => {
                    let behind = cell.clone().begun_at(stand);
                    self.cells.push(Cell {
                        law,
                        ..cell.cut_at(stand)
                    });
                    behind
                }
            };
            held.law = HELD;
            if std::mem::take(&mut first_held) {
                // It starts from a stand, and may end in one: that takes two cells.
                held.link = 0.0;
                let middle = 0.5 * (held.from + held.to);
                let mut second = held.clone().begun_at(middle);
                second.link = 1.0;
                self.cells.push(held.cut_at(middle));
                held = second;
            }
            self.cells.push(held);
        }
    }

    /// Goes on along a path that was held, from the stand, not before `now`.
    pub fn resume(&mut self, now: f64) {
        let free = self.first_held();
        let Some(rest) = self.cells.get(free..).filter(|rest| !rest.is_empty()) else {
            return;
        };
        let stand = free
            .checked_sub(1)
            .map_or(now, |i| self.cells[i].law.end().max(now));
        let laws = fastest(rest, 0.0, stand).expect("from a stand every path can be followed");
        for (cell, law) in self.cells[free..].iter_mut().zip(laws) {
            cell.law = law;
        }
    }

    /// Whether a part of the path waits for [`resume`](Self::resume).
    pub fn is_held(&self) -> bool {
        self.first_held() < self.cells.len()
    }

    /// When the arm stands after [`hold`](Self::hold): the end of the part that is timed.
    pub fn stand_time(&self) -> f64 {
        self.first_held()
            .checked_sub(1)
            .map_or(0.0, |i| self.cells[i].law.end())
    }

    fn first_held(&self) -> usize {
        self.cells
            .partition_point(|cell| cell.law.start.is_finite())
    }

    /// An arm standing where this one stands at `now`, with an empty path; segments are counted on from here.
    #[must_use]
    pub fn beside(&self, now: f64) -> Self {
        let mut other = Self::new(std::sync::Arc::clone(&self.arm), self.sample(now));
        other.torque.clone_from(&self.torque);
        other.next = self.next;
        other.corner_failures.clone_from(&self.corner_failures);
        other
    }

    /// Takes over the counting of segments from a path that was driven meanwhile.
    pub fn count_on_from(&mut self, other: &Self) {
        self.next = other.next;
        self.corner_failures.clone_from(&other.corner_failures);
    }
}
