//! Joint positions for a flange pose.

use depal_frames::{JointPositions, Pose};

use super::{Arm, Inverse, LIMIT_SLACK};
use crate::numeric;

/// Combinations of whole turns that are listed of one branch.
const MOST_TURNS: usize = 1024;

impl Arm {
    /// Every joint vector inside the limits that brings the flange there: all branches, and each with all whole turns
    /// that the limits allow. Sorted by joint 1, then 2, and so on; empty when out of reach.
    /// At a singularity of the wrist one of the endless many is given.
    pub fn inverse(&self, base_from_flange: &Pose) -> Vec<JointPositions> {
        let mut solutions = Vec::with_capacity(32);
        for branch in self.branches(base_from_flange, None) {
            self.add_turns(&branch, &mut solutions);
        }
        solutions.sort_by(compare);
        solutions.dedup_by(|a, b| a.max_distance(b) < 1e-9);
        solutions
    }

    /// The solution of [`Arm::inverse`] whose largest joint difference from `near` is smallest; none when out of reach.
    /// At a singularity of the wrist joints 4 and 6 stay near `near`.
    /// Without a closed form it is the one that a descent from `near` finds, if it finds one.
    pub fn inverse_nearest(
        &self,
        base_from_flange: &Pose,
        near: &JointPositions,
    ) -> Option<JointPositions> {
        let mut solutions = Vec::new();
        if matches!(self.inverse, Inverse::Numeric)
            && base_from_flange
                .translation
                .vector
                .iter()
                .all(|v| v.is_finite())
            && let Some(found) = numeric::nearest(&self.chain, &self.limits, base_from_flange, near)
        {
            return Some(found);
        }
        for branch in self.branches(base_from_flange, Some(near)) {
            self.add_turns(&branch, &mut solutions);
        }
        solutions.sort_by(compare);
        solutions
            .into_iter()
            .min_by(|a, b| a.max_distance(near).total_cmp(&b.max_distance(near)))
    }

    /// One entry per branch.
    fn branches(
        &self,
        base_from_flange: &Pose,
        near: Option<&JointPositions>,
    ) -> Vec<JointPositions> {
        let finite = base_from_flange
            .translation
            .vector
            .iter()
            .all(|v| v.is_finite())
            && base_from_flange
                .rotation
                .coords
                .iter()
                .all(|v| v.is_finite());
        if !finite {
            return Vec::new();
        }
        let model_from_flange = self.model_from_base * base_from_flange;
        match &self.inverse {
            Inverse::Wrist(solver) => solver
                .branches(&model_from_flange, near)
                .iter()
                .map(|b| JointPositions::from_slice(b))
                .collect(),
            Inverse::Palletizer(palletizer) => palletizer
                .branches(&model_from_flange, near)
                .iter()
                .map(|b| JointPositions::from_slice(b))
                .collect(),
            Inverse::Numeric => numeric::solutions(&self.chain, &self.limits, base_from_flange),
        }
    }

    /// Adds `branch` with every combination of whole turns inside the limits. Beyond [`MOST_TURNS`] combinations the
    /// joints that are left get the turn next to zero only.
    fn add_turns(&self, branch: &JointPositions, solutions: &mut Vec<JointPositions>) {
        use std::f64::consts::TAU;
        let start = solutions.len();
        solutions.push(*branch);
        for (joint, limit) in self.limits.iter().enumerate() {
            let angle = branch[joint];
            let mut first = ((limit.lower - LIMIT_SLACK - angle) / TAU).ceil() as i64;
            let mut last = ((limit.upper + LIMIT_SLACK - angle) / TAU).floor() as i64;
            if first > last {
                solutions.truncate(start);
                return;
            }
            let end = solutions.len();
            if (last - first + 1) as usize * (end - start) > MOST_TURNS {
                let next_to_zero = (-angle / TAU).round() as i64;
                first = next_to_zero.clamp(first, last);
                last = first;
            }
            let turned = |turns: i64| (angle + turns as f64 * TAU).clamp(limit.lower, limit.upper);
            for turns in first + 1..=last {
                for at in start..end {
                    let mut other = solutions[at];
                    other[joint] = turned(turns);
                    solutions.push(other);
                }
            }
            for solution in &mut solutions[start..end] {
                solution[joint] = turned(first);
            }
        }
    }
}

fn compare(a: &JointPositions, b: &JointPositions) -> std::cmp::Ordering {
    a.iter()
        .zip(b.iter())
        .map(|(x, y)| x.total_cmp(y))
        .find(|o| o.is_ne())
        .unwrap_or(std::cmp::Ordering::Equal)
}
