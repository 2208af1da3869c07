use std::collections::BTreeMap;

use serde::Serialize;

use crate::accept::{Accept, AcceptLimits, judge};
use crate::statistics::{largest, mean, percentile, ratio};
use crate::totals::RunTotals;

/// The report of one run, schema 1. Fields that are `None` are `null` in the JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Version of this structure: 1.
    pub schema: u32,
    /// Name of the scene.
    pub scene: String,
    /// Seed of the run.
    pub seed: u64,
    /// Version of the program.
    pub version: String,
    /// Simulated time at the end, s.
    pub sim_time_s: f64,
    /// Time on the wall, s.
    pub wall_time_s: f64,
    /// Simulated over wall time; `None` when the wall time is zero.
    pub real_time_factor: Option<f64>,
    /// Where the cartons are.
    pub boxes: Boxes,
    /// The picks.
    pub picks: Picks,
    /// Time from one pick to the next.
    pub cycle_s: CycleTimes,
    /// Cartons delivered per hour of simulated time, up to the last delivery when all were delivered,
    /// up to the end otherwise.
    pub boxes_per_hour: Option<f64>,
    /// Estimates against the truth.
    pub vision: Vision,
    /// The planner.
    pub planning: Planning,
    /// What went over the wire.
    pub interface: InterfaceCounts,
    /// Hash of the state at the end.
    pub state_hash: String,
    /// The verdict.
    pub accept: Accept,
    /// Why the run ended; for the summary, not in the JSON.
    #[serde(skip)]
    pub ended_because: String,
    /// Scripted faults that struck; for the summary, not in the JSON.
    #[serde(skip)]
    pub faults: Vec<String>,
}

/// Where the cartons are at the end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Boxes {
    /// At the start.
    pub total: u64,
    /// Carried away by the conveyor.
    pub delivered: u64,
    /// Fallen or lost.
    pub dropped: u64,
    /// Neither: still on the pallet, in the gripper or on the belt.
    pub left: u64,
}

/// The picks of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Picks {
    /// Begun.
    pub attempted: u64,
    /// Held until the place.
    pub succeeded: u64,
    /// The others.
    pub failed: u64,
    /// Failed picks by reason.
    pub by_reason: BTreeMap<String, u64>,
}

/// Cycle times, s.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CycleTimes {
    /// Mean.
    pub mean: Option<f64>,
    /// Median.
    pub p50: Option<f64>,
    /// 95th percentile.
    pub p95: Option<f64>,
}

/// Median and 95th percentile.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MedianAndTail {
    /// Median.
    pub p50: Option<f64>,
    /// 95th percentile.
    pub p95: Option<f64>,
}

/// Median, 95th percentile and largest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MedianTailMax {
    /// Median.
    pub p50: Option<f64>,
    /// 95th percentile.
    pub p95: Option<f64>,
    /// Largest.
    pub max: Option<f64>,
}

/// Vision against the truth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Vision {
    /// Pictures taken.
    pub frames: u64,
    /// Cartons found over cartons to be seen whole; `None` when there was none to see.
    pub recall: Option<f64>,
    /// Estimates where no carton was.
    pub false_picks: u64,
    /// Error of position, mm.
    pub pose_err_mm: MedianTailMax,
    /// Error of direction, degrees.
    pub pose_err_deg: MedianTailMax,
    /// Computing time, ms.
    pub time_ms: MedianAndTail,
}

/// The planner.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Planning {
    /// Calls.
    pub calls: u64,
    /// Computing time, ms.
    pub time_ms: MedianAndTail,
    /// Smallest clear distance of any path, mm.
    pub min_clearance_mm: Option<f64>,
}

/// Commands and statuses by number; keys are texts in the JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InterfaceCounts {
    /// Commands that arrived.
    pub commands: BTreeMap<u32, u64>,
    /// Statuses that were answered.
    pub statuses: BTreeMap<u32, u64>,
}

impl MedianAndTail {
    fn of(samples: &[f64]) -> Self {
        Self {
            p50: percentile(samples, 0.5),
            p95: percentile(samples, 0.95),
        }
    }
}

impl MedianTailMax {
    fn of(samples: &[f64]) -> Self {
        Self {
            p50: percentile(samples, 0.5),
            p95: percentile(samples, 0.95),
            max: largest(samples),
        }
    }
}

impl Report {
    /// Works out all figures and the verdict.
    pub fn new(totals: &RunTotals, limits: &AcceptLimits) -> Self {
        let finite = |value: f64| value.is_finite().then_some(value);
        let all_delivered = totals.boxes_delivered == totals.boxes_total;
        let span_s = totals
            .last_delivery_s
            .filter(|_| all_delivered)
            .unwrap_or(totals.sim_time_s);
        let mut report = Self {
            schema: 1,
            scene: totals.scene.clone(),
            seed: totals.seed,
            version: totals.version.clone(),
            sim_time_s: totals.sim_time_s,
            wall_time_s: totals.wall_time_s,
            real_time_factor: finite(totals.sim_time_s / totals.wall_time_s),
            boxes: Boxes {
                total: totals.boxes_total,
                delivered: totals.boxes_delivered,
                dropped: totals.boxes_dropped,
                left: totals
                    .boxes_total
                    .saturating_sub(totals.boxes_delivered)
                    .saturating_sub(totals.boxes_dropped),
            },
            picks: Picks {
                attempted: totals.picks_attempted,
                succeeded: totals.picks_succeeded,
                failed: totals
                    .picks_attempted
                    .saturating_sub(totals.picks_succeeded),
                by_reason: totals.pick_failures.clone(),
            },
            cycle_s: CycleTimes {
                mean: mean(&totals.cycle_s),
                p50: percentile(&totals.cycle_s, 0.5),
                p95: percentile(&totals.cycle_s, 0.95),
            },
            boxes_per_hour: finite(totals.boxes_delivered as f64 * 3600.0 / span_s),
            vision: Vision {
                frames: totals.frames,
                recall: ratio(totals.found_boxes, totals.visible_boxes),
                false_picks: totals.false_picks,
                pose_err_mm: MedianTailMax::of(&totals.pose_err_mm),
                pose_err_deg: MedianTailMax::of(&totals.pose_err_deg),
                time_ms: MedianAndTail::of(&totals.vision_ms),
            },
            planning: Planning {
                calls: totals.planning_ms.len() as u64,
                time_ms: MedianAndTail::of(&totals.planning_ms),
                min_clearance_mm: totals.min_clearance_mm.and_then(finite),
            },
            interface: InterfaceCounts {
                commands: totals.commands.clone(),
                statuses: totals.statuses.clone(),
            },
            state_hash: totals.state_hash.clone(),
            accept: Accept {
                passed: false,
                checks: Vec::new(),
            },
            ended_because: totals.ended_because.clone(),
            faults: totals.faults.clone(),
        };
        report.accept = judge(&report, limits);
        report
    }

    /// The text of `report.json`: indented, with an end of line.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self)
            .expect("plain data with text and number keys is always JSON");
        text.push('\n');
        text
    }
}
