//! The passes that find the fastest law along the cells.
//!
//! With `x` the squared rate of the parameter at the beginning of a cell of width `w` and `a` the constant
//! acceleration of the parameter, a joint accelerates by `q' a + q'' x` at the beginning and by
//! `q' a + q'' (x + a w)` in the middle and by `q' a + q'' (x + 2 a w)` at the end: every limit is linear in `(a, x)`.
//! So is every torque, with what gravity takes as its constant part.

use depal_frames::JointPositions;

use crate::cell::{Cell, Law};

/// Coefficients below this do not limit the acceleration, only the speed.
const FLAT: f64 = 1e-9;
/// Relative excess of the given speed over the highest feasible one that still counts as feasible:
/// the limits are held at three places of a cell, and a cell that was divided has new ones.
const SLACK: f64 = 2e-4;
/// The same where torques limit: they bend along a cell. [`crate::torque`] leaves room for it.
const TORQUE_SLACK: f64 = 3e-3;

/// `|a * of_a + x * of_x + rest| <= limit`, with the size of `rest` below `limit`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limit {
    pub of_a: f64,
    pub of_x: f64,
    pub rest: f64,
    pub limit: f64,
}

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

/// A line `at_zero + slope * x`.
#[derive(Clone, Copy)]
struct Line {
    at_zero: f64,
    slope: f64,
}

impl Line {
    fn at(self, x: f64) -> f64 {
        self.at_zero + self.slope * x
    }
}

impl Limit {
    /// Highest and lowest `a` as functions of `x`; none where `a` has no influence.
    fn bounds(self) -> Option<(Line, Line)> {
        if self.of_a.abs() < FLAT {
            return None;
        }
        let slope = -self.of_x / self.of_a;
        let reach = self.limit / self.of_a.abs();
        let rest = self.rest / self.of_a;
        Some((
            Line {
                at_zero: reach - rest,
                slope,
            },
            Line {
                at_zero: -reach - rest,
                slope,
            },
        ))
    }
}

/// Range of `a` at `x` under the joint acceleration and torque limits; empty (low above high) where `x` is too high.
fn range(cell: &Cell, acceleration: &JointPositions, x: f64) -> (f64, f64) {
    let mut low = f64::NEG_INFINITY;
    let mut high = f64::INFINITY;
    for limit in limits(cell, acceleration) {
        if let Some((upper, lower)) = limit.bounds() {
            high = high.min(upper.at(x));
            low = low.max(lower.at(x));
        }
    }
    (low, high)
}

/// Highest `x` at the beginning of a cell from which some `a` obeys all limits and ends with at most `right`.
fn controllable(cell: &Cell, right: f64) -> f64 {
    let acceleration = &cell.limits.joint_acceleration;
    let double_width = 2.0 * cell.width();
    let mut x = cell.speed_bounds().0;
    if cell.curve.is_straight() && cell.torque.is_empty() {
        let (_, high) = range(cell, acceleration, 0.0);
        return x.min(right + double_width * high);
    }
    for limit in limits(cell, acceleration) {
        if limit.of_a.abs() < FLAT && limit.of_x != 0.0 {
            x = x.min((limit.limit - limit.rest * limit.of_x.signum()) / limit.of_x.abs());
        }
    }
    // The gap between the least upper and the greatest lower bound of `a` is concave in `x` and not negative
    // at zero. From the right, each crossing of the two bounds that hold there comes closer; finitely many exist.
    for _ in 0..64 {
        let mut upper = Line {
            at_zero: right / double_width,
            slope: -1.0 / double_width,
        };
        let mut lower = Line {
            at_zero: 0.0,
            slope: -1.0 / double_width,
        };
        for limit in limits(cell, acceleration) {
            if let Some((high, low)) = limit.bounds() {
                if high.at(x) < upper.at(x) {
                    upper = high;
                }
                if low.at(x) > lower.at(x) {
                    lower = low;
                }
            }
        }
        let gap = upper.at(x) - lower.at(x);
        if gap >= -1e-9 * (1.0 + upper.at(x).abs() + lower.at(x).abs()) {
            return x;
        }
        let closing = upper.slope - lower.slope;
        if closing >= 0.0 {
            return 0.0;
        }
        x = ((lower.at_zero - upper.at_zero) / closing).clamp(0.0, x);
    }
    x
}

/// Fastest laws for `cells`, entered with the squared rate `entry` (in the parameter of the first) at `start`
/// and left standing. None if the limits cannot be held from there.
pub(crate) fn fastest(cells: &[Cell], entry: f64, start: f64) -> Option<Vec<Law>> {
    // Highest squared rate at the end of each cell.
    let mut right_ends = vec![0.0; cells.len()];
    let mut left = 0.0_f64;
    for (i, cell) in cells.iter().enumerate().rev() {
        let after = match cells.get(i + 1) {
            Some(next) if next.link > 0.0 => left / (next.link * next.link),
            _ => 0.0,
        };
        right_ends[i] = after.min(cell.speed_bounds().1);
        left = controllable(cell, right_ends[i]);
    }
    let slack = match cells.first() {
        Some(cell) if !cell.torque.is_empty() => TORQUE_SLACK,
        _ => SLACK,
    };
    if entry > left * (1.0 + slack) {
        return None;
    }
    let mut laws = Vec::with_capacity(cells.len());
    let mut x = entry;
    let mut time = start;
    for (i, cell) in cells.iter().enumerate() {
        if i > 0 {
            x *= cell.link * cell.link;
        }
        let double_width = 2.0 * cell.width();
        let (low, high) = range(cell, &cell.limits.joint_acceleration, x);
        let a = (if low > high { 0.5 * (low + high) } else { high })
            .min((right_ends[i] - x) / double_width)
            .max(-x / double_width);
        let end = (x + a * double_width).max(0.0);
        let law = law(cell.width(), x, end, a, time);
        time = law.end();
        x = end;
        laws.push(law);
    }
    Some(laws)
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
        let (low, _) = range(cell, acceleration, x);
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
