use serde::Serialize;

use crate::report::Report;
use crate::statistics::ratio;

/// Thresholds of the scene; `None` is not looked at.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AcceptLimits {
    /// Cartons delivered, at least.
    pub delivered_min: Option<f64>,
    /// Cartons dropped, at most.
    pub dropped_max: Option<f64>,
    /// Picks succeeded over picks attempted, at least.
    pub pick_success_min: Option<f64>,
    /// Cartons delivered per hour, at least.
    pub boxes_per_hour_min: Option<f64>,
    /// Cartons found over cartons to be seen, at least.
    pub vision_recall_min: Option<f64>,
    /// Estimates where no carton was, at most.
    pub false_picks_max: Option<f64>,
    /// 95th percentile of the error of position, mm, at most.
    pub pose_err_mm_p95_max: Option<f64>,
    /// 95th percentile of the error of direction, degrees, at most.
    pub pose_err_deg_p95_max: Option<f64>,
}

/// One threshold and what the run reached.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// Key of the threshold; `_min` and `_max` at its end say which side is good.
    pub name: String,
    /// The threshold.
    pub limit: f64,
    /// What the run reached; `None` when nothing was measured, which misses the threshold.
    pub value: Option<f64>,
    /// The value keeps the threshold.
    pub passed: bool,
}

/// The verdict.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Accept {
    /// Every threshold was kept; true when there is none.
    pub passed: bool,
    /// One row per threshold of the scene.
    pub checks: Vec<Check>,
}

/// Which side of a threshold is good.
#[derive(Clone, Copy)]
enum Side {
    AtLeast,
    AtMost,
}

pub(crate) fn judge(report: &Report, limits: &AcceptLimits) -> Accept {
    use Side::{AtLeast, AtMost};
    let count = |count: u64| Some(count as f64);
    let vision = &report.vision;
    let picks = &report.picks;
    let rows = [
        (
            "delivered_min",
            AtLeast,
            limits.delivered_min,
            count(report.boxes.delivered),
        ),
        (
            "dropped_max",
            AtMost,
            limits.dropped_max,
            count(report.boxes.dropped),
        ),
        (
            "pick_success_min",
            AtLeast,
            limits.pick_success_min,
            ratio(picks.succeeded, picks.attempted),
        ),
        (
            "boxes_per_hour_min",
            AtLeast,
            limits.boxes_per_hour_min,
            report.boxes_per_hour,
        ),
        (
            "vision_recall_min",
            AtLeast,
            limits.vision_recall_min,
            vision.recall,
        ),
        (
            "false_picks_max",
            AtMost,
            limits.false_picks_max,
            count(vision.false_picks),
        ),
        (
            "pose_err_mm_p95_max",
            AtMost,
            limits.pose_err_mm_p95_max,
            vision.pose_err_mm.p95,
        ),
        (
            "pose_err_deg_p95_max",
            AtMost,
            limits.pose_err_deg_p95_max,
            vision.pose_err_deg.p95,
        ),
    ];
    let checks: Vec<Check> = rows
        .into_iter()
        .filter_map(|(name, side, limit, value)| {
            let limit = limit?;
            let passed = value.is_some_and(|value| match side {
                AtLeast => value >= limit,
                AtMost => value <= limit,
            });
            Some(Check {
                name: name.to_owned(),
                limit,
                value,
                passed,
            })
        })
        .collect();
    Accept {
        passed: checks.iter().all(|check| check.passed),
        checks,
    }
}
