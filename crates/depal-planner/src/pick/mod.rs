//! One group of boxes: whether it can be picked, by which grasp and on which way.

mod attempt;
mod free;
mod notes;
mod way;
mod waypoints;

use crate::{
    candidate::load,
    grasp::{Grasp, grasps},
    group::Group,
    in_order::first_in_order,
    plan::PickPlan,
    refusal::{RejectReason, Rejection},
    situation::Situation,
};
use attempt::{Attempt, attempts};
use notes::Notes;
use way::{Lifted, way};

/// A group on which no way was found so far.
pub(crate) struct Trial<'a> {
    group: &'a Group,
    state: State,
}

enum State {
    /// Nothing is left to be tried.
    Closed(RejectReason),
    /// Worse grasps are.
    Open(Box<Open>),
}

/// What was tried, and what is left.
struct Open {
    /// Best first.
    grasps: Vec<Grasp>,
    /// Of these grasps all attempts have failed.
    done: usize,
    /// The first attempts of all, with the index of their grasp: those that the search begins with.
    first: Vec<(usize, Attempt)>,
    tried: usize,
    notes: Notes,
}

/// Same number of sections, same offset: only the yaw differs.
fn equally_good(a: &Grasp, b: &Grasp) -> bool {
    a.sections.len() == b.sections.len() && (a.tcp_offset.norm() - b.tcp_offset.norm()).abs() < 1e-3
}

impl<'a> Trial<'a> {
    /// Tries the best grasp and those equally good; where there are no others, the search too.
    pub fn of_best_grasps(situation: &Situation, group: &'a Group) -> Result<PickPlan, Self> {
        let trial = |state| Self { group, state };
        let mut open = Open::new(situation, group).map_err(|r| trial(State::Closed(r)))?;
        let found = match open.next_tier(situation, group) {
            None if open.done < open.grasps.len() => {
                return Err(trial(State::Open(Box::new(open))));
            }
            None => open.search(situation, group),
            plan => plan,
        };
        closed(situation, found, &open).map_err(|r| trial(State::Closed(r)))
    }

    /// Tries what is left: worse grasps, then the search.
    pub fn with_all_grasps(self, situation: &Situation) -> Result<PickPlan, Rejection> {
        let group = self.group;
        let outcome = match self.state {
            State::Closed(reason) => Err(reason),
            State::Open(mut open) => {
                let mut found = None;
                while found.is_none() && open.done < open.grasps.len() {
                    found = open.next_tier(situation, group);
                }
                let found = found.or_else(|| open.search(situation, group));
                closed(situation, found, &open)
            }
        };
        outcome.map_err(|reason| rejection(group, reason))
    }

    /// Why it is turned down as far as it was tried.
    pub fn rejection(&self) -> Rejection {
        let reason = match &self.state {
            State::Closed(reason) => reason.clone(),
            State::Open(open) => open.notes.reason(open.tried),
        };
        rejection(self.group, reason)
    }
}

fn rejection(group: &Group, reason: RejectReason) -> Rejection {
    Rejection {
        box_index: group.members[0],
        with: group.members[1..].to_vec(),
        reason,
    }
}

/// The plan if there is one and it is not too long.
fn closed(
    situation: &Situation,
    found: Option<PickPlan>,
    open: &Open,
) -> Result<PickPlan, RejectReason> {
    let plan = found.ok_or_else(|| open.notes.reason(open.tried))?;
    let (found, limit) = (
        plan.waypoints.len(),
        situation.request.settings.max_waypoints,
    );
    if found > limit {
        return Err(RejectReason::TooManyWaypoints { found, limit });
    }
    Ok(plan)
}

impl Open {
    fn new(situation: &Situation, group: &Group) -> Result<Self, RejectReason> {
        let settings = situation.request.settings;
        let (mass, limit) = (load(group, settings), settings.max_load);
        if mass > limit {
            return Err(RejectReason::TooHeavy { mass, limit });
        }
        Ok(Self {
            grasps: grasps(situation.request.gripper, group, settings)?,
            done: 0,
            first: Vec::new(),
            tried: 0,
            notes: Notes::default(),
        })
    }

    /// Equally good grasps are mixed and sorted by time; worse ones come only when these lead nowhere.
    fn next_tier(&mut self, situation: &Situation, group: &Group) -> Option<PickPlan> {
        let left = &self.grasps[self.done..];
        let tier = left.chunk_by(equally_good).next()?.len();
        let begin = self.done;
        self.done += tier;
        let grasps = &self.grasps[begin..self.done];
        let attempts: Vec<(usize, Attempt)> = attempts(situation, group, grasps, &mut self.notes)
            .into_iter()
            .map(|attempt| (begin + attempt.grasp, attempt))
            .collect();
        let plan = self.first_way(situation, group, &attempts, false);
        if plan.is_none() {
            self.tried += attempts.len();
            let room = situation.request.settings.search_attempts - self.first.len();
            self.first.extend(attempts.into_iter().take(room));
        }
        plan
    }

    /// No template is free: a random search for the first few.
    fn search(&mut self, situation: &Situation, group: &Group) -> Option<PickPlan> {
        let first = std::mem::take(&mut self.first);
        self.first_way(situation, group, &first, true)
    }

    /// The first attempt that has a way, each with the low lift, then with the high one.
    fn first_way(
        &mut self,
        situation: &Situation,
        group: &Group,
        attempts: &[(usize, Attempt)],
        search: bool,
    ) -> Option<PickPlan> {
        let (low, high) = (situation.lift_height(group), situation.height_out(group));
        let lifts = if high > low {
            vec![low, high]
        } else {
            vec![low]
        };
        let lifted = attempts.iter().flat_map(|(grasp, attempt)| {
            let grasp = &self.grasps[*grasp];
            lifts.iter().map(move |&lift| Lifted {
                group,
                grasp,
                attempt,
                lift,
                beyond: lift - low,
            })
        });
        let (failures, plan) =
            first_in_order(lifted.collect(), |lifted| way(situation, &lifted, search));
        for notes in failures {
            self.notes.append(notes);
        }
        plan
    }
}
