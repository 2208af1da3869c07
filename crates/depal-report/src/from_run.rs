//! From a run's outcome to the numbers of its report.

use depal_cell::cell::RunOutcome;
use depal_cell::score::CartonFate;

use crate::RunTotals;

impl RunTotals {
    /// Counts and samples of a run of `scene` with `seed` that took `wall_time_s` seconds on the wall.
    pub fn of(scene: &str, seed: u64, outcome: &RunOutcome, wall_time_s: f64) -> Self {
        let score = &outcome.score;
        let succeeded = score
            .picks
            .iter()
            .filter(|(_, reason)| reason.is_none())
            .count();
        Self {
            scene: scene.to_owned(),
            seed,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            sim_time_s: outcome.sim_time.as_secs_f64(),
            wall_time_s,
            state_hash: outcome.state_hash.clone(),
            ended_because: format!("{}: {}", outcome.end.name(), outcome.end_detail),
            faults: score.faults.iter().cloned().collect(),
            boxes_total: score.fates.len() as u64,
            boxes_delivered: score.count(|fate| fate == CartonFate::Delivered) as u64,
            boxes_dropped: score.count(|fate| matches!(fate, CartonFate::Lost(_))) as u64,
            last_delivery_s: score.last_delivery.map(depal_time::SimTime::as_secs_f64),
            picks_attempted: score.picks.len() as u64,
            picks_succeeded: succeeded as u64,
            pick_failures: score
                .failures_by_reason()
                .into_iter()
                .map(|(reason, count)| (reason.name().to_owned(), count))
                .collect(),
            cycle_s: score.cycles.clone(),
            frames: u64::from(score.frames),
            visible_boxes: score.pickable,
            found_boxes: score.found,
            false_picks: score.false_picks,
            pose_err_mm: score.pose_errors_mm.clone(),
            pose_err_deg: score.pose_errors_deg.clone(),
            vision_ms: score.vision_ms.clone(),
            planning_ms: score.planning_ms.clone(),
            min_clearance_mm: score.min_clearance_mm,
            commands: score
                .commands
                .iter()
                .map(|(code, n)| (*code as u32, *n))
                .collect(),
            statuses: score
                .statuses
                .iter()
                .map(|(code, n)| (*code as u32, *n))
                .collect(),
        }
    }
}
