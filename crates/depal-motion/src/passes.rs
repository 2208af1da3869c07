//! The two passes that find the fastest law along cells of constant path acceleration.
//!
//! With `x` the squared rate of the path's parameter at the beginning of a cell and `a` its acceleration there, every
//! limit is linear in `(a, x)`. The backward pass finds the highest `x` from which everything ahead can still be
//! obeyed, the forward pass takes the highest `a`
//! (Pham and Pham, IEEE T-RO 34(3), 2018, doi 10.1109/TRO.2018.2819195).
//! [`crate::Trajectory`] and [`crate::BlendedPath`] are timed by these same passes.

/// Coefficients below this do not limit the acceleration, only the speed.
pub(crate) const FLAT: f64 = 1e-9;
/// Crossings of bounds after which the search for the highest speed ends.
const MOST_CROSSINGS: usize = 64;

/// A line `at_zero + slope * x`.
#[derive(Clone, Copy)]
pub(crate) struct Line {
    pub at_zero: f64,
    pub slope: f64,
}

impl Line {
    pub fn at(self, x: f64) -> f64 {
        self.at_zero + self.slope * x
    }
}

/// `|a * of_a + x * of_x + rest| <= limit`, with the size of `rest` below `limit`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limit {
    pub of_a: f64,
    pub of_x: f64,
    pub rest: f64,
    pub limit: f64,
}

impl Limit {
    /// Highest and lowest `a` as functions of `x`; none where `a` has no influence.
    pub fn band(&self) -> Option<Band> {
        if self.of_a.abs() < FLAT {
            return None;
        }
        let inverse = 1.0 / self.of_a;
        Some(Band {
            slope: -self.of_x * inverse,
            middle: -self.rest * inverse,
            half: self.limit * inverse.abs(),
        })
    }

    /// Highest `x` where `a` has no influence.
    pub fn highest(&self) -> f64 {
        if self.of_a.abs() < FLAT && self.of_x != 0.0 {
            (self.limit - self.rest * self.of_x.signum()) / self.of_x.abs()
        } else {
            f64::INFINITY
        }
    }
}

/// `a` lies within `half` of `middle + slope * x`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Band {
    pub slope: f64,
    pub middle: f64,
    pub half: f64,
}

/// The least upper and the greatest lower bound of `a` at one `x`.
#[derive(Clone, Copy)]
pub(crate) struct Bounds {
    x: f64,
    high: f64,
    low: f64,
    pub upper: Line,
    pub lower: Line,
}

impl Bounds {
    pub fn new(x: f64, upper: Line, lower: Line) -> Self {
        Self {
            x,
            high: upper.at(x),
            low: lower.at(x),
            upper,
            lower,
        }
    }

    /// Without any limit yet.
    fn open(x: f64) -> Self {
        let far = |at_zero| Line {
            at_zero,
            slope: 0.0,
        };
        Self::new(x, far(f64::INFINITY), far(f64::NEG_INFINITY))
    }

    pub fn narrow(&mut self, band: &Band) {
        let middle = band.middle + band.slope * self.x;
        let line = |offset: f64| Line {
            at_zero: band.middle + offset,
            slope: band.slope,
        };
        if middle + band.half < self.high {
            self.high = middle + band.half;
            self.upper = line(band.half);
        }
        if middle - band.half > self.low {
            self.low = middle - band.half;
            self.lower = line(-band.half);
        }
    }
}

/// A path cut into cells, as the passes see it.
pub(crate) trait Cells {
    fn count(&self) -> usize;
    /// Range of the parameter.
    fn width(&self, cell: usize) -> f64;
    /// Highest squared rate that the speed limits allow at the beginning and at the end.
    fn speed_bounds(&self, cell: usize) -> (f64, f64);
    /// Rate at the beginning over the rate at the end of the cell before; zero if the arm stands between the two.
    fn link(&self, cell: usize) -> f64;
    /// The largest acceleration where one and the same holds all along and at every speed.
    fn even(&self, cell: usize) -> Option<f64>;
    /// Highest squared rate at the beginning under limits on which the acceleration has no influence.
    fn highest(&self, cell: usize) -> f64;
    /// Applies all limits of the acceleration.
    fn narrow(&self, cell: usize, bounds: &mut Bounds);
}

/// Range of `a` at `x` under the limits; empty (low above high) where `x` is too high.
fn range<C: Cells + ?Sized>(cells: &C, cell: usize, x: f64) -> (f64, f64) {
    let mut bounds = Bounds::open(x);
    cells.narrow(cell, &mut bounds);
    (bounds.low, bounds.high)
}

/// Highest `x` at the beginning of a cell from which some `a` obeys all limits and ends with at most `right`.
fn controllable<C: Cells + ?Sized>(cells: &C, cell: usize, right: f64) -> f64 {
    let double_width = 2.0 * cells.width(cell);
    let mut x = cells.speed_bounds(cell).0;
    if let Some(most) = cells.even(cell) {
        return x.min(right + double_width * most);
    }
    x = x.min(cells.highest(cell));
    // The gap between the least upper and the greatest lower bound of `a` is concave in `x` and not negative
    // at zero. From the right, each crossing of the two bounds that hold there comes closer; finitely many exist.
    for _ in 0..MOST_CROSSINGS {
        let slope = -1.0 / double_width;
        let upper = Line {
            at_zero: right / double_width,
            slope,
        };
        let lower = Line {
            at_zero: 0.0,
            slope,
        };
        let mut bounds = Bounds::new(x, upper, lower);
        cells.narrow(cell, &mut bounds);
        let gap = bounds.high - bounds.low;
        if gap >= -1e-9 * (1.0 + bounds.high.abs() + bounds.low.abs()) {
            return x;
        }
        let closing = bounds.upper.slope - bounds.lower.slope;
        if closing >= 0.0 {
            return 0.0;
        }
        x = ((bounds.lower.at_zero - bounds.upper.at_zero) / closing).clamp(0.0, x);
    }
    x
}

/// Both passes along `cells`, entered with the squared rate `entry` and left standing.
/// `reached` is told of each cell in turn: the squared rate at its beginning, the acceleration, the squared rate at
/// its end. False, and nothing told, if `entry` is higher than the limits allow by more than the share `slack`.
pub(crate) fn run<C: Cells + ?Sized>(
    cells: &C,
    entry: f64,
    slack: f64,
    mut reached: impl FnMut(usize, f64, f64, f64),
) -> bool {
    let count = cells.count();
    // Highest squared rate at the end of each cell.
    let mut right_ends = vec![0.0; count];
    let mut left = 0.0_f64;
    let mut link = 0.0;
    for cell in (0..count).rev() {
        let after = if link > 0.0 {
            left / (link * link)
        } else {
            0.0
        };
        link = cells.link(cell);
        right_ends[cell] = after.min(cells.speed_bounds(cell).1);
        left = controllable(cells, cell, right_ends[cell]);
    }
    if entry > left * (1.0 + slack) {
        return false;
    }
    let mut x = entry;
    for (cell, right) in right_ends.into_iter().enumerate() {
        if cell > 0 {
            let link = cells.link(cell);
            x *= link * link;
        }
        let double_width = 2.0 * cells.width(cell);
        let most = match cells.even(cell) {
            Some(most) => most,
            None => match range(cells, cell, x) {
                (low, high) if low > high => 0.5 * (low + high),
                (_, high) => high,
            },
        };
        let a = most.min((right - x) / double_width).max(-x / double_width);
        let end = (x + a * double_width).max(0.0);
        reached(cell, x, a, end);
        x = end;
    }
    true
}
