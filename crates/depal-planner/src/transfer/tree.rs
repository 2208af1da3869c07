//! The random search of a transfer.

use std::f64::consts::PI;

use depal_frames::JointPositions;
use depal_motion::slowest_joint_time;
use depal_time::RandomStream;

use super::checker::Checker;
use crate::tree::{self, Ground};

/// Longest step by which a tree grows, rad.
const RANGE: f64 = 1.0;
/// Random short-cuts tried on a found way.
const SHORT_CUTS: usize = 60;
/// Most waypoints of a way, ends included.
const MOST_POINTS: usize = 9;

/// The cell between two ends.
struct Cell<'a, 'b> {
    checker: &'a mut Checker<'b>,
    from: JointPositions,
    to: JointPositions,
    last_check: usize,
}

impl Ground for Cell<'_, '_> {
    /// Inside the limits, every other time near the box that start and goal span;
    /// joints that can turn all round stay within half a turn of the ends.
    fn draw(&mut self, turn: usize, random: &mut RandomStream) -> Option<JointPositions> {
        let near = turn % 4 < 2;
        let (from, to) = (&self.from, &self.to);
        let mut drawn = *from;
        for (i, limit) in self.checker.scene.arm.limits().iter().enumerate() {
            let room = if near { 0.9 } else { PI };
            let low = limit.lower.max(from[i].min(to[i]) - room);
            let high = limit.upper.min(from[i].max(to[i]) + room);
            drawn[i] = random.uniform(low, high);
        }
        Some(drawn)
    }

    fn edge_is_free(&mut self, from: &JointPositions, to: &JointPositions) -> bool {
        self.checker.edge_is_free(from, to)
    }

    /// Seconds of the slowest joint, point by point.
    fn cost(&self, way: &[JointPositions]) -> f64 {
        let limits = self.checker.scene.arm.limits();
        way.windows(2)
            .map(|w| slowest_joint_time(limits, &w[0], &w[1]))
            .sum()
    }

    fn spent(&self) -> bool {
        self.checker.checks >= self.last_check
    }
}

/// A free chain of straight joint moves, shortened; none when the checks are spent. Adds up the random postures drawn.
pub(crate) fn grow(
    checker: &mut Checker,
    from: &JointPositions,
    to: &JointPositions,
    random: &mut RandomStream,
    rounds: &mut usize,
) -> Option<Vec<JointPositions>> {
    let most_checks = checker.most_checks;
    let mut cell = Cell {
        checker,
        from: *from,
        to: *to,
        // A tenth is kept for shortening.
        last_check: most_checks - most_checks / 10,
    };
    let mut way = tree::connect(&mut cell, from, to, RANGE, usize::MAX, random, rounds)?;
    cell.last_check = most_checks;
    tree::drop_vertices(&mut cell, &mut way);
    tree::short_cuts(&mut cell, &mut way, SHORT_CUTS, MOST_POINTS, random);
    tree::drop_vertices(&mut cell, &mut way);
    Some(way)
}
