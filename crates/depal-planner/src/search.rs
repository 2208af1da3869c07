//! The random search for a pick's free moves, where every template is blocked.

use depal_frames::JointPositions;
use depal_time::{RandomStream, RandomStreams};

use crate::{
    contact::Check,
    path::{Blocked, drawn_in, edge_is_free, touch_on_way},
    request::PlannerSettings,
    timing::Trapezoid,
    tree::{self, Ground},
};

/// Longest step by which a tree grows, rad.
const RANGE: f64 = 0.6;
/// Random short-cuts tried on a found way.
const SHORT_CUTS: usize = 60;

/// The cell around a pick.
struct Cell<'a> {
    check: &'a Check<'a>,
    from: JointPositions,
    to: JointPositions,
    upright: Option<f64>,
    settings: &'a PlannerSettings,
}

impl Ground for Cell<'_> {
    /// Inside the limits; axes 4 and 6 stay within half a turn of the ends.
    fn draw(&mut self, _turn: usize, random: &mut RandomStream) -> Option<JointPositions> {
        use std::f64::consts::PI;
        let arm = self.check.robot.arm;
        let (from, to) = (&self.from, &self.to);
        let mut drawn = *from;
        for (i, limit) in arm.limits().iter().enumerate() {
            let (mut low, mut high) = (limit.lower, limit.upper);
            if i == 3 || i == 5 {
                low = low.max(from[i].min(to[i]) - PI);
                high = high.min(from[i].max(to[i]) + PI);
            }
            drawn[i] = random.uniform(low, high);
        }
        let hangs = |at: &JointPositions| drawn_in(at, drawn[1], drawn[2]);
        if drawn.len() < 6 {
            // A palletizer's tool hangs anyhow.
        } else if let (Some(a), Some(b)) = (hangs(from), hangs(to)) {
            let share = random.uniform(0.0, 1.0);
            drawn[3] = a[3] + (b[3] - a[3]) * share;
            drawn[4] = a[4] + (b[4] - a[4]) * share;
        }
        arm.within_limits(&drawn).then_some(drawn)
    }

    fn edge_is_free(&mut self, from: &JointPositions, to: &JointPositions) -> bool {
        edge_is_free(self.check, from, to, self.upright, self.settings)
    }

    /// Seconds, with a stop at every point.
    fn cost(&self, way: &[JointPositions]) -> f64 {
        let limits = self.check.robot.arm.limits();
        way.windows(2)
            .map(|w| Trapezoid::joints(&w[0], &w[1], limits).duration)
            .sum()
    }

    fn spent(&self) -> bool {
        false
    }
}

/// Two trees, then short-cuts by time.
///
/// The seed is fixed, so the same question gets the same way. Where the tool hangs upright at both ends,
/// only upright postures are drawn, and between two of them it stays upright; otherwise all joints are drawn freely.
pub(crate) fn search(
    check: &Check,
    from: &JointPositions,
    to: &JointPositions,
    upright: Option<f64>,
    settings: &PlannerSettings,
) -> Option<Vec<JointPositions>> {
    let mut random = RandomStreams::new(settings.search_seed).stream("planner search");
    let mut cell = Cell {
        check,
        from: *from,
        to: *to,
        upright,
        settings,
    };
    let turns = settings.search_rounds;
    let mut way = tree::connect(&mut cell, from, to, RANGE, turns, &mut random, &mut 0)?;
    tree::drop_vertices(&mut cell, &mut way);
    tree::short_cuts(&mut cell, &mut way, SHORT_CUTS, usize::MAX, &mut random);
    match touch_on_way(check, &way, upright, settings) {
        Ok(()) => Some(way),
        Err(Blocked::Touches(_) | Blocked::Leans) => None,
    }
}
