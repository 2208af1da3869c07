//! Bends a free route by small seeded changes while that saves time and stays free.

use depal_arm::JointLimit;
use depal_frames::JointPositions;
use depal_motion::{BlendedPath, slowest_joint_time};
use depal_time::RandomStream;

use super::{blends::fitting_blends, checker::Checker};
use crate::tree::distance;

/// Ways that are no slower than this against the bound are good enough.
const GOOD: f64 = 1.04;
/// Routes with more vias than this are not bent, only shortened.
const MOST_VIAS: usize = 7;

/// Waypoints with the largest blends that fit, split by `shares`.
#[derive(Debug, Clone)]
pub(crate) struct Route {
    pub points: Vec<JointPositions>,
    /// See [`fitting_blends`].
    pub shares: Vec<f64>,
    /// Stops at every point instead.
    pub stops: bool,
}

impl Route {
    pub fn new(points: Vec<JointPositions>) -> Self {
        Self {
            shares: vec![0.5; points.len()],
            points,
            stops: false,
        }
    }

    pub fn stopping(&self) -> Self {
        Self {
            stops: true,
            ..self.clone()
        }
    }

    /// Of every point.
    pub fn blends(&self) -> Vec<f64> {
        if self.stops {
            vec![0.0; self.points.len()]
        } else {
            fitting_blends(&self.points, &self.shares)
        }
    }

    pub fn path(&self) -> BlendedPath {
        BlendedPath::new(&self.points, &self.blends())
    }

    pub fn rough_time(&self, limits: &[JointLimit]) -> f64 {
        self.path().rough_time(limits)
    }
}

/// How much a refinement may try.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    /// Changes tried.
    pub changes: usize,
    /// States checked meanwhile.
    pub checks: usize,
}

/// The routes met, each better than the one before; the first is the given one, which must be free.
pub(crate) fn refine(
    checker: &mut Checker,
    route: Route,
    effort: Effort,
    random: &mut RandomStream,
) -> Vec<Route> {
    let limits = checker.scene.arm.limits();
    let start = route.points[0];
    let mut best = route;
    let mut trail = vec![best.clone()];
    let mut time = best.rough_time(limits);
    if best.points.len() < 3 {
        return trail;
    }
    let bound = slowest_joint_time(limits, &start, &best.points[best.points.len() - 1]);
    let last_check = checker.checks + effort.checks;
    let mut size = 0.3;
    for _ in 0..effort.changes {
        if time <= bound * GOOD || checker.checks > last_check {
            break;
        }
        let Some(changed) = change(&best, size, limits, random) else {
            continue;
        };
        let path = changed.path();
        let changed_time = path.rough_time(limits);
        if changed_time < time - 1e-4 && checker.path_is_free(&path) {
            (best, time) = (changed, changed_time);
            trail.push(best.clone());
            size = (size * 1.5_f64).min(0.4);
        } else {
            size = (size * 0.985).max(0.03);
        }
    }
    trail
}

fn change(
    route: &Route,
    size: f64,
    limits: &[JointLimit],
    random: &mut RandomStream,
) -> Option<Route> {
    let mut changed = route.clone();
    let vias = route.points.len() - 2;
    let kind = random.uniform(0.0, 1.0);
    let which = 1 + (random.uniform(0.0, vias as f64) as usize).min(vias - 1);
    if kind < 0.1 && vias > 1 {
        changed.points.remove(which);
        changed.shares.remove(which);
    } else if kind < 0.2 && vias < MOST_VIAS.min(4) {
        let share = random.uniform(0.2, 0.8);
        let middle = route.points[which].lerp(&route.points[which + 1], share);
        changed.points.insert(which + 1, middle);
        changed.shares.insert(which + 1, 0.5);
    } else if kind < 0.3 {
        changed.shares[which] = (changed.shares[which] + random.normal(size)).clamp(0.05, 0.95);
    } else if kind < 0.45 {
        // Towards the straight line.
        let middle =
            route.points[which - 1].lerp(&route.points[which + 1], random.uniform(0.0, 1.0));
        changed.points[which] = changed.points[which].lerp(&middle, random.uniform(0.0, 0.8));
    } else {
        let all = random.uniform(0.0, 1.0) < 0.4;
        let one = random.uniform(0.0, limits.len() as f64) as usize;
        let point = &mut changed.points[which];
        for (i, limit) in limits.iter().enumerate() {
            let step = random.normal(size);
            if all || i == one {
                point[i] = (point[i] + step).clamp(limit.lower, limit.upper);
            }
        }
    }
    let moves = changed
        .points
        .windows(2)
        .all(|w| distance(&w[0], &w[1]) > 1e-3);
    moves.then_some(changed)
}
