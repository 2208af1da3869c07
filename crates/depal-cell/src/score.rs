//! What the run was worth: picks, losses, vision errors and interface counters, by truth.

use std::collections::{BTreeMap, BTreeSet};

use depal_time::{SimDuration, SimTime};

use crate::event::FailureReason;

/// Where a carton ended up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CartonFate {
    /// Still on the pallet, or hanging, or on the way.
    InCell,
    /// On the belt, not yet out of the cell.
    OnConveyor,
    /// On its place of a pattern; counts as delivered if it still stands there at the end of the run.
    Placed,
    /// Carried out of the cell, or on its place of a pattern at the end of the run.
    Delivered,
    /// On the floor or anywhere else it should not be.
    Lost(FailureReason),
}

/// One vacuum-on to vacuum-off attempt.
#[derive(Debug, Clone, PartialEq)]
pub struct Pick {
    /// From 1.
    pub number: u32,
    /// When the vacuum was switched on.
    pub started: SimTime,
    /// The cartons that the plan aimed at, by truth.
    pub targets: Vec<u32>,
    /// Whether the vacuum switch closed.
    pub vacuum_reached: bool,
    /// The cartons that were held, in the order in which they were gripped.
    pub held: Vec<u32>,
    /// The first reason it went wrong.
    pub failure: Option<(FailureReason, String)>,
}

/// Counters and samples of a run.
#[derive(Debug, Clone, Default)]
pub struct Score {
    /// Fate of each carton, by number.
    pub fates: BTreeMap<u32, CartonFate>,
    /// Picks over, in order: success or the reason.
    pub picks: Vec<(Pick, Option<FailureReason>)>,
    /// What ended the run early, if anything did.
    pub run_failure: Option<(FailureReason, String)>,
    /// Time from one finished pick to the next, s (the first counts from the first exposure).
    pub cycles: Vec<f64>,
    /// Cartons placed by those picks.
    pub placed: u64,
    /// When each delivery or placement happened.
    pub last_success: Option<SimTime>,
    /// When the last carton left the cell.
    pub last_delivery: Option<SimTime>,
    /// When the first exposure was triggered.
    pub first_exposure: Option<SimTime>,
    /// Frames evaluated.
    pub frames: u32,
    /// Cartons that should have been found, summed over frames.
    pub pickable: u64,
    /// Of those, found.
    pub found: u64,
    /// Reports without a carton behind them.
    pub false_picks: u64,
    /// Scripted faults that struck, as the user wrote them, or the name of those of the camera; each once.
    pub faults: BTreeSet<String>,
    /// Position errors of the matched reports, mm.
    pub pose_errors_mm: Vec<f64>,
    /// Angle errors of the matched reports, degrees.
    pub pose_errors_deg: Vec<f64>,
    /// Wall time of vision per frame, ms (not part of the deterministic log).
    pub vision_ms: Vec<f64>,
    /// Wall time of planning per call, ms (not part of the deterministic log).
    pub planning_ms: Vec<f64>,
    /// Least clearance of all plans, mm.
    pub min_clearance_mm: Option<f64>,
    /// Commands received, by number.
    pub commands: BTreeMap<i32, u64>,
    /// Status codes answered.
    pub statuses: BTreeMap<i32, u64>,
    open: Option<Pick>,
    last_finish: Option<SimTime>,
}

impl Score {
    /// A score over cartons `0..count`.
    pub fn new(cartons: impl IntoIterator<Item = u32>) -> Self {
        Self {
            fates: cartons
                .into_iter()
                .map(|id| (id, CartonFate::InCell))
                .collect(),
            ..Self::default()
        }
    }

    /// The pick now under way.
    pub fn open_pick(&self) -> Option<&Pick> {
        self.open.as_ref()
    }

    /// The pick now under way, to add what happened to it.
    pub fn open_pick_mut(&mut self) -> Option<&mut Pick> {
        self.open.as_mut()
    }

    /// Opens a pick and returns its number.
    pub fn start_pick(&mut self, now: SimTime, targets: Vec<u32>) -> u32 {
        let number = self.picks.len() as u32 + 1;
        self.open = Some(Pick {
            number,
            started: now,
            targets,
            vacuum_reached: false,
            held: Vec::new(),
            failure: None,
        });
        number
    }

    /// Closes the open pick. Returns it, its reason if it failed, and the cycle time.
    pub fn finish_pick(
        &mut self,
        now: SimTime,
        otherwise: Option<(FailureReason, String)>,
    ) -> Option<(Pick, Option<(FailureReason, String)>, SimDuration)> {
        let pick = self.open.take()?;
        let failure = pick.failure.clone().or(otherwise);
        let since = self
            .last_finish
            .or(self.first_exposure)
            .unwrap_or(pick.started);
        let cycle = now - since;
        self.last_finish = Some(now);
        if failure.is_none() {
            self.cycles.push(cycle.as_secs_f64());
            self.placed += pick.held.len() as u64;
            self.last_success = Some(now);
        }
        self.picks
            .push((pick.clone(), failure.as_ref().map(|(reason, _)| *reason)));
        Some((pick, failure, cycle))
    }

    /// Cartons with a given fate.
    pub fn count(&self, wanted: impl Fn(CartonFate) -> bool) -> usize {
        self.fates.values().filter(|fate| wanted(**fate)).count()
    }

    /// Failed picks by reason, plus what ended the run early, once, unless a failed pick stands for it already.
    pub fn failures_by_reason(&self) -> BTreeMap<FailureReason, u64> {
        let mut by_reason = BTreeMap::new();
        for reason in self.picks.iter().filter_map(|(_, reason)| *reason) {
            *by_reason.entry(reason).or_insert(0) += 1;
        }
        if let Some((reason, _)) = &self.run_failure {
            by_reason.entry(*reason).or_insert(1);
        }
        by_reason
    }

    /// Cartons placed per hour, from the first exposure to the last successful pick.
    pub fn boxes_per_hour(&self) -> f64 {
        let (Some(first), Some(last)) = (self.first_exposure, self.last_success) else {
            return 0.0;
        };
        let hours = (last - first).as_secs_f64() / 3600.0;
        if hours > 0.0 {
            self.placed as f64 / hours
        } else {
            0.0
        }
    }

    /// Found cartons over those that should have been found; 1 when there was nothing to find.
    pub fn recall(&self) -> f64 {
        if self.pickable == 0 {
            1.0
        } else {
            self.found as f64 / self.pickable as f64
        }
    }
}
