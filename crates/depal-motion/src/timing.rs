//! The law along the cells of a trajectory.
//!
//! With `x` the squared rate of the parameter at the beginning of a cell of width `w` and `a` the constant
//! acceleration of the parameter, a joint accelerates by `q' a + q'' x` at the beginning and by
//! `q' a + q'' (x + a w)` in the middle and by `q' a + q'' (x + 2 a w)` at the end: every limit is linear in `(a, x)`.
//! So is every torque, with what gravity takes as its constant part.

use depal_frames::JointPositions;

use crate::cell::{Cell, Law};
use crate::passes::{Bounds, Cells, run};

/// Relative excess of the given speed over the highest feasible one that still counts as feasible:
/// the limits are held at three places of a cell, and a cell that was divided has new ones.
const SLACK: f64 = 2e-4;
/// The same where torques limit: they bend along a cell. [`crate::torque`] leaves room for it.
const TORQUE_SLACK: f64 = 3e-3;

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
        self[cell].even
    }

    fn highest(&self, cell: usize) -> f64 {
        self[cell].highest
    }

    fn narrow(&self, cell: usize, bounds: &mut Bounds) {
        for band in &self[cell].bands {
            bounds.narrow(band);
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
