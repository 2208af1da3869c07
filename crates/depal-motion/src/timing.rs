//! The law along the cells of a trajectory.
//!
//! With `x` the squared rate of the parameter at the beginning of a cell of width `w` and `a` the constant
//! acceleration of the parameter, a joint accelerates by `q' a + q'' x` at the beginning and by
//! `q' a + q'' (x + a w)` in the middle and by `q' a + q'' (x + 2 a w)` at the end: every limit is linear in `(a, x)`.
//! So is every torque, with what gravity takes as its constant part.

use depal_frames::JointPositions;

use crate::cell::{Cell, Law};
use crate::passes::{Bounds, Cells, Limit, run};

/// Relative excess of the given speed over the highest feasible one that still counts as feasible:
/// the limits are held at three places of a cell, and a cell that was divided has new ones.
const SLACK: f64 = 2e-4;
/// The same where torques limit: they bend along a cell. [`crate::torque`] leaves room for it.
const TORQUE_SLACK: f64 = 3e-3;

fn limits<'a>(
    cell: &'a Cell,
    acceleration: &'a JointPositions,
) -> impl Iterator<Item = Limit> + 'a {
    let width = cell.width();
    (0..acceleration.len())
        .flat_map(move |j| {
            [
                (&cell.at_from, 0.0),
                (&cell.at_middle, width),
                (&cell.at_to, 2.0 * width),
            ]
            .map(|(at, gain)| Limit {
                of_a: at.first[j] + gain * at.second[j],
                of_x: at.second[j],
                rest: 0.0,
                limit: acceleration[j],
            })
        })
        .chain(cell.torque.iter().copied())
}

impl Cell {
    /// Lowest and highest `a` at `x` under these accelerations and the torque limits.
    fn range(&self, acceleration: &JointPositions, x: f64) -> (f64, f64) {
        limits(self, acceleration)
            .filter_map(|limit| limit.band())
            .map(|band| (band.middle + band.slope * x, band.half))
            .fold(
                (f64::NEG_INFINITY, f64::INFINITY),
                |(low, high), (middle, half)| (low.max(middle - half), high.min(middle + half)),
            )
    }
}

impl Cells for [Cell] {
    fn count(&self) -> usize {
        self.len()
    }

    fn width(&self, cell: usize) -> f64 {
        self[cell].width()
    }

    fn speed_bounds(&self, cell: usize) -> (f64, f64) {
        self[cell].speed_bounds()
    }

    fn link(&self, cell: usize) -> f64 {
        self[cell].link
    }

    fn even(&self, cell: usize) -> Option<f64> {
        let cell = &self[cell];
        let is_even = cell.curve.is_straight() && cell.torque.is_empty();
        is_even.then(|| cell.range(&cell.limits.joint_acceleration, 0.0).1)
    }

    fn highest(&self, cell: usize) -> f64 {
        limits(&self[cell], &self[cell].limits.joint_acceleration)
            .map(|limit| limit.highest())
            .fold(f64::INFINITY, f64::min)
    }

    fn narrow(&self, cell: usize, bounds: &mut Bounds) {
        for limit in limits(&self[cell], &self[cell].limits.joint_acceleration) {
            if let Some(band) = limit.band() {
                bounds.narrow(&band);
            }
        }
    }
}

/// Fastest laws for `cells`, entered with the squared rate `entry` (in the parameter of the first) at `start`
/// and left standing. None if the limits cannot be held from there.
pub(crate) fn fastest(cells: &[Cell], entry: f64, start: f64) -> Option<Vec<Law>> {
    let slack = match cells.first() {
        Some(cell) if !cell.torque.is_empty() => TORQUE_SLACK,
        _ => SLACK,
    };
    let mut laws = Vec::with_capacity(cells.len());
    let mut time = start;
    let feasible = run(cells, entry, slack, |cell, x, a, end| {
        let law = law(cells[cell].width(), x, end, a, time);
        time = law.end();
        laws.push(law);
    });
    feasible.then_some(laws)
}

/// The laws that bring the arm to a stand soonest from the beginning of `cells` with squared rate `entry`,
/// under `acceleration`, and the parameter in the last of these cells where it stands.
pub(crate) fn brake(
    cells: &[Cell],
    acceleration: &JointPositions,
    entry: f64,
    start: f64,
) -> (Vec<Law>, f64) {
    let mut laws = Vec::new();
    let mut x = entry;
    let mut time = start;
    let mut stand = cells.first().map_or(0.0, |c| c.from);
    for (i, cell) in cells.iter().enumerate() {
        if i > 0 {
            x *= cell.link * cell.link;
        }
        if x <= 0.0 {
            break;
        }
        let width = cell.width();
        let (low, _) = cell.range(acceleration, x);
        let last = cells.get(i + 1).is_none_or(|next| next.link == 0.0);
        let a = if last {
            low.min(-x / (2.0 * width))
        } else {
            low
        };
        let end = x + 2.0 * a * width;
        if end <= 0.0 {
            let stopping = (-x / (2.0 * a)).min(width);
            stand = cell.from + stopping;
            laws.push(law(stopping, x, 0.0, -x / (2.0 * stopping), time));
            break;
        }
        let law = law(width, x, end, a, time);
        time = law.end();
        x = end;
        stand = cell.to;
        laws.push(law);
    }
    (laws, stand)
}

fn law(width: f64, x: f64, end: f64, acceleration: f64, start: f64) -> Law {
    let (rate, end_rate) = (x.max(0.0).sqrt(), end.sqrt());
    Law {
        start,
        duration: 2.0 * width / (rate + end_rate),
        rate,
        acceleration,
    }
}
