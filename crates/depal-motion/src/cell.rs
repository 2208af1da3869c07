//! A short stretch of path with constant path acceleration.

use std::sync::Arc;

use depal_arm::JointLimit;
use depal_frames::JointPositions;

use crate::curve::{Curve, Derivatives};
use crate::passes::{Band, Limit};
use crate::torque::TorqueLimits;
use crate::{SegmentId, Speed};

/// What limits the arm along a cell.
#[derive(Debug, Clone)]
pub(crate) struct CellLimits {
    pub joint_speed: JointPositions,
    pub joint_acceleration: JointPositions,
    pub tcp: f64,
    pub orientation: f64,
    /// None where the arm has no torque limits.
    pub torque: Option<Arc<TorqueLimits>>,
}

impl CellLimits {
    pub fn new(limits: &[JointLimit], speed: &Speed) -> Self {
        let mut joint_speed = JointPositions::zeros(limits.len());
        let mut joint_acceleration = JointPositions::zeros(limits.len());
        for (i, limit) in limits.iter().enumerate() {
            joint_speed[i] = limit.max_speed * speed.joint_fraction.min(1.0);
            joint_acceleration[i] = limit.max_acceleration * speed.acceleration_fraction.min(1.0);
        }
        Self {
            joint_speed,
            joint_acceleration,
            tcp: speed.tcp,
            orientation: speed.orientation,
            torque: None,
        }
    }
}

/// The motion along a cell: the parameter starts at the cell's beginning with `rate` per second and
/// gains `acceleration` per second squared, for `duration`, from `start` on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Law {
    pub start: f64,
    pub duration: f64,
    pub rate: f64,
    pub acceleration: f64,
}

impl Law {
    pub const NONE: Self = Self {
        start: 0.0,
        duration: 0.0,
        rate: 0.0,
        acceleration: 0.0,
    };

    pub fn end(&self) -> f64 {
        self.start + self.duration
    }

    pub fn end_rate(&self) -> f64 {
        (self.rate + self.acceleration * self.duration).max(0.0)
    }
}

/// A stretch of a curve.
#[derive(Debug, Clone)]
pub(crate) struct Cell {
    pub curve: Arc<Curve>,
    pub limits: Arc<CellLimits>,
    pub segment: SegmentId,
    /// Parameter at the beginning and at the end.
    pub from: f64,
    pub to: f64,
    /// Metres of TCP path per unit of the parameter.
    pub tcp_rate: f64,
    /// Radians of reorientation per unit of the parameter.
    pub turn_rate: f64,
    /// Rate at the beginning of this cell over the rate at the end of the one before
    /// (their parameters differ in scale). Zero: the arm stands between the two.
    pub link: f64,
    pub at_from: Derivatives,
    pub at_middle: Derivatives,
    pub at_to: Derivatives,
    /// Torque limits at the three places; empty where the arm has none.
    pub torque: Vec<Limit>,
    /// All limits of the acceleration; empty where [`even`](Self::even) says it all.
    pub bands: Vec<Band>,
    /// Highest squared rate at the beginning under limits on which the acceleration has no influence.
    pub highest: f64,
    /// The largest acceleration where one and the same holds all along and at every speed.
    pub even: Option<f64>,
    pub law: Law,
}

impl Cell {
    pub fn new(
        curve: &Arc<Curve>,
        limits: &Arc<CellLimits>,
        segment: SegmentId,
        (from, to): (f64, f64),
        (tcp_rate, turn_rate): (f64, f64),
        link: f64,
    ) -> Self {
        let inside = 0.5 * (from + to);
        let mut cell = Self {
            at_from: curve.derivatives(from, inside),
            at_middle: curve.derivatives(inside, inside),
            at_to: curve.derivatives(to, inside),
            curve: Arc::clone(curve),
            limits: Arc::clone(limits),
            segment,
            from,
            to,
            tcp_rate,
            turn_rate,
            link,
            torque: Vec::new(),
            bands: Vec::new(),
            highest: f64::INFINITY,
            even: None,
            law: Law::NONE,
        };
        cell.measure_limits();
        cell
    }

    pub fn width(&self) -> f64 {
        self.to - self.from
    }

    /// Derivatives of the present stretch.
    fn measure(&mut self) {
        let inside = 0.5 * (self.from + self.to);
        self.at_from = self.curve.derivatives(self.from, inside);
        self.at_middle = self.curve.derivatives(inside, inside);
        self.at_to = self.curve.derivatives(self.to, inside);
        self.measure_limits();
    }

    fn measure_limits(&mut self) {
        let width = self.width();
        if let Some(torque) = &self.limits.torque {
            self.torque = [
                (self.from, &self.at_from, 0.0),
                (self.from + 0.5 * width, &self.at_middle, width),
                (self.to, &self.at_to, 2.0 * width),
            ]
            .iter()
            .flat_map(|(u, at, gain)| torque.rows(&self.curve.position(*u), at, *gain))
            .collect();
        } else if self.curve.is_straight() {
            let acceleration = &self.limits.joint_acceleration;
            let most = self.at_from.first.iter().zip(acceleration.iter());
            self.even = Some(
                most.map(|(slope, limit)| limit / slope.abs())
                    .fold(f64::INFINITY, f64::min),
            );
            return;
        }
        let mut bands = Vec::with_capacity(3 * self.at_from.first.len() + self.torque.len());
        let mut highest = f64::INFINITY;
        for limit in self.limits(&self.limits.joint_acceleration) {
            match limit.band() {
                Some(band) => bands.push(band),
                None => highest = highest.min(limit.highest()),
            }
        }
        (self.bands, self.highest) = (bands, highest);
    }

    /// Limits at the three places of the cell under these accelerations, and those of the torques.
    fn limits<'a>(&'a self, acceleration: &'a JointPositions) -> impl Iterator<Item = Limit> + 'a {
        let width = self.width();
        (0..acceleration.len())
            .flat_map(move |j| {
                [
                    (&self.at_from, 0.0),
                    (&self.at_middle, width),
                    (&self.at_to, 2.0 * width),
                ]
                .map(|(at, gain)| Limit {
                    of_a: at.first[j] + gain * at.second[j],
                    of_x: at.second[j],
                    rest: 0.0,
                    limit: acceleration[j],
                })
            })
            .chain(self.torque.iter().copied())
    }

    /// Lowest and highest `a` at `x` under these accelerations and the torque limits.
    pub fn range(&self, acceleration: &JointPositions, x: f64) -> (f64, f64) {
        self.limits(acceleration)
            .filter_map(|limit| limit.band())
            .map(|band| (band.middle + band.slope * x, band.half))
            .fold(
                (f64::NEG_INFINITY, f64::INFINITY),
                |(low, high), (middle, half)| (low.max(middle - half), high.min(middle + half)),
            )
    }

    /// The same stretch, ending earlier.
    pub fn cut_at(mut self, to: f64) -> Self {
        self.to = to;
        self.measure();
        self
    }

    /// The same stretch, beginning later.
    pub fn begun_at(mut self, from: f64) -> Self {
        self.from = from;
        self.measure();
        self
    }

    /// When a parameter of the stretch is passed.
    pub fn time_at(&self, parameter: f64) -> f64 {
        if parameter >= self.to {
            return self.law.end();
        }
        let way = (parameter - self.from).max(0.0);
        let Law {
            start,
            duration,
            rate,
            acceleration,
        } = self.law;
        // Root of `way = rate t + acceleration t^2 / 2`, in the form that bears no acceleration.
        let root = (rate * rate + 2.0 * acceleration * way).max(0.0).sqrt();
        let t = if way == 0.0 {
            0.0
        } else {
            2.0 * way / (rate + root)
        };
        start
            + if t.is_finite() {
                t.min(duration)
            } else {
                duration
            }
    }

    /// Parameter at a time.
    pub fn parameter(&self, time: f64) -> f64 {
        let t = (time - self.law.start).clamp(0.0, self.law.duration);
        let u = self.from + t * (self.law.rate + 0.5 * self.law.acceleration * t);
        u.clamp(self.from, self.to)
    }

    /// The cell before and after a time within it; both keep their part of the law.
    pub fn split(&self, time: f64) -> (Self, Self) {
        let at = self.parameter(time);
        let elapsed = time - self.law.start;
        let mut before = self.clone().cut_at(at);
        before.law.duration = elapsed;
        let mut after = self.clone();
        after.from = at;
        after.measure();
        after.link = 1.0;
        after.law = Law {
            start: time,
            duration: self.law.duration - elapsed,
            rate: before.law.end_rate(),
            acceleration: self.law.acceleration,
        };
        (before, after)
    }

    /// Highest squared rate that the speed limits allow at the beginning and at the end.
    pub fn speed_bounds(&self) -> (f64, f64) {
        let path = bound(self.limits.tcp, self.tcp_rate)
            .min(bound(self.limits.orientation, self.turn_rate));
        let joints = |at: &Derivatives| {
            at.first
                .iter()
                .zip(self.limits.joint_speed.iter())
                .map(|(rate, limit)| bound(*limit, rate.abs()))
                .fold(path, f64::min)
        };
        (joints(&self.at_from), joints(&self.at_to))
    }
}

/// Square of `limit / rate`; very large, yet finite, where nothing limits.
fn bound(limit: f64, rate: f64) -> f64 {
    const UNBOUNDED: f64 = 1e12;
    let quotient = limit / rate;
    if quotient.is_nan() {
        UNBOUNDED
    } else {
        (quotient * quotient).min(UNBOUNDED)
    }
}
