//! What a project must fulfil before it runs.

use std::collections::{BTreeSet, VecDeque};

use thiserror::Error;

use crate::project::{Next, Project, Reference, StepKind};

/// What is wrong with a project.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum WorkflowError {
    /// Nothing to run.
    #[error("the Viz project has no steps")]
    NoSteps,
    /// Ids are from 1.
    #[error("step id {id}: expected a number from 1")]
    StepId {
        /// The id.
        id: i32,
    },
    /// Two steps of one id.
    #[error("step id {id} is there twice")]
    DuplicateStep {
        /// The id.
        id: i32,
    },
    /// A step names another that does not exist.
    #[error("step {step} goes on at step {named}, which does not exist; steps are {known:?}")]
    UnknownStep {
        /// Where it is named.
        step: i32,
        /// The unknown id.
        named: i32,
        /// The ids there are.
        known: Vec<i32>,
    },
    /// A recognition names a vision project that does not exist.
    #[error(
        "step {step} runs vision project {project}, which does not exist; projects are {known:?}"
    )]
    UnknownProject {
        /// The step.
        step: i32,
        /// The unknown number.
        project: i32,
        /// The numbers there are.
        known: Vec<i32>,
    },
    /// A branch without exits can never go on.
    #[error("step {step} is a branch without exits")]
    NoExits {
        /// The step.
        step: i32,
    },
    /// A run that comes here never ends.
    #[error("step {step} is a dead end: no way leads from it to the end of the run")]
    DeadEnd {
        /// The step.
        step: i32,
    },
    /// No run ever comes here.
    #[error("step {step} is never reached")]
    Unreachable {
        /// The step.
        step: i32,
    },
    /// A pick on a way without recognition.
    #[error("step {step} picks, but a run can come to it without a visual recognition before")]
    PickWithoutRecognition {
        /// The step.
        step: i32,
    },
    /// A place on a way without pick.
    #[error("step {step} needs a Vision Move, but a run can come to it without one before")]
    PlaceWithoutPick {
        /// The step.
        step: i32,
    },
    /// All results are planned in one go only as far as a conveyor.
    #[error(
        "step {step} plans all results, but a run can leave it without a pallet_pattern behind"
    )]
    AllWithoutPlace {
        /// The Vision Move step.
        step: i32,
    },
    /// The planner finds the way from a pick to the conveyor by itself.
    #[error(
        "step {step} moves between a Vision Move and its pallet_pattern, whose way the planner finds by itself"
    )]
    MoveBeforePlace {
        /// The step that moves.
        step: i32,
    },
    /// An offset from a waypoint that a run may never have.
    #[error("step {step} is relative to the next waypoint, but a run can go on without one")]
    NoNextWaypoint {
        /// The step.
        step: i32,
    },
    /// A list, grid or pattern without places.
    #[error("step {step} has no places")]
    NoPlaces {
        /// The step.
        step: i32,
    },
    /// Messages are positive: 0 says that there is none.
    #[error("step {step} sends the message {message}, expected a number from 1")]
    Message {
        /// The step.
        step: i32,
        /// The message.
        message: i32,
    },
    /// A velocity that no robot can take.
    #[error("step {step}: velocity {found} %, expected more than 0 and at most 100")]
    Velocity {
        /// The step, 0 for the project's global velocity.
        step: i32,
        /// The velocity.
        found: f64,
    },
}

/// What a run has done when it comes to a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Done {
    recognised: bool,
    picked: bool,
    /// Place of a Vision Move that must come to a conveyor.
    all_open: Option<usize>,
    /// Place of a move behind a pick.
    moved: Option<usize>,
}

impl Project {
    /// Everything that is wrong; empty if the project can run. `vision_projects` are the numbers there are.
    pub fn check(&self, vision_projects: &[i32]) -> Vec<WorkflowError> {
        let mut errors = self.check_steps(vision_projects);
        // The flow can be followed only when all ids are good.
        if errors.is_empty() {
            errors = self.check_flow();
        }
        errors
    }

    fn check_steps(&self, vision_projects: &[i32]) -> Vec<WorkflowError> {
        let known: Vec<i32> = self.steps.iter().map(|step| step.id).collect();
        let mut errors = Vec::new();
        if self.steps.is_empty() {
            errors.push(WorkflowError::NoSteps);
        }
        let is_velocity = |v: f64| v > 0.0 && v <= 100.0;
        if !is_velocity(self.global_velocity_percent) {
            errors.push(WorkflowError::Velocity {
                step: 0,
                found: self.global_velocity_percent,
            });
        }
        for (place, step) in self.steps.iter().enumerate() {
            let id = step.id;
            if id < 1 {
                errors.push(WorkflowError::StepId { id });
            }
            if known[..place].contains(&id) {
                errors.push(WorkflowError::DuplicateStep { id });
            }
            let mut named = Vec::new();
            if let Next::Step(next) = step.next {
                named.push(next);
            }
            match &step.kind {
                StepKind::VisualRecognition { project, .. }
                    if !vision_projects.contains(project) =>
                {
                    errors.push(WorkflowError::UnknownProject {
                        step: id,
                        project: *project,
                        known: vision_projects.to_vec(),
                    });
                }
                StepKind::BranchByMsg { exits } if exits.is_empty() => {
                    errors.push(WorkflowError::NoExits { step: id });
                }
                StepKind::BranchByMsg { exits } => named.extend(exits),
                StepKind::Notify { message } if *message < 1 => {
                    errors.push(WorkflowError::Message {
                        step: id,
                        message: *message,
                    });
                }
                kind if kind.place_count() == Some(0) => {
                    errors.push(WorkflowError::NoPlaces { step: id });
                }
                _ => {}
            }
            if let Some(found) = step.kind.velocity_percent().filter(|v| !is_velocity(*v)) {
                errors.push(WorkflowError::Velocity { step: id, found });
            }
            errors.extend(
                named
                    .into_iter()
                    .filter(|n| !known.contains(n))
                    .map(|named| WorkflowError::UnknownStep {
                        step: id,
                        named,
                        known: known.clone(),
                    }),
            );
        }
        errors
    }

    fn check_flow(&self) -> Vec<WorkflowError> {
        let mut errors = Vec::new();
        let mut faulty = BTreeSet::new();
        let start = Done {
            recognised: false,
            picked: false,
            all_open: None,
            moved: None,
        };
        let mut seen = BTreeSet::from([(0, start)]);
        let mut queue = VecDeque::from([(0, start)]);
        while let Some((place, mut done)) = queue.pop_front() {
            if let Some((faulty_place, error)) = self.fault_at(place, done)
                && faulty.insert(faulty_place)
            {
                errors.push(error);
            }
            let kind = &self.steps[place].kind;
            match kind {
                StepKind::VisualRecognition { .. } => done.recognised = true,
                StepKind::VisionMove { plans_all, .. } => {
                    done.picked = true;
                    done.moved = None;
                    done.all_open = plans_all.then_some(place);
                }
                StepKind::PalletPattern { .. } => {
                    done.picked = false;
                    done.all_open = None;
                }
                StepKind::CartonPattern { .. } => done.picked = false,
                kind if kind.travel().is_some() && done.picked => {
                    done.moved = done.moved.or(Some(place));
                }
                _ => {}
            }
            for next in self.places_after(place) {
                match next {
                    Some(next) => {
                        if seen.insert((next, done)) {
                            queue.push_back((next, done));
                        }
                    }
                    None => {
                        if let Some(open) = done.all_open
                            && faulty.insert(open)
                        {
                            let step = self.steps[open].id;
                            errors.push(WorkflowError::AllWithoutPlace { step });
                        }
                    }
                }
            }
        }
        for (place, step) in self.steps.iter().enumerate() {
            if matches!(
                step.kind,
                StepKind::RelativeMove {
                    reference: Reference::Next,
                    ..
                }
            ) && !self.always_comes_to_a_waypoint(place)
            {
                errors.push(WorkflowError::NoNextWaypoint { step: step.id });
            }
        }
        let reached: BTreeSet<usize> = seen.into_iter().map(|(place, _)| place).collect();
        let ending = self.places_that_end();
        for (place, step) in self.steps.iter().enumerate() {
            if !reached.contains(&place) {
                errors.push(WorkflowError::Unreachable { step: step.id });
            } else if !ending.contains(&place) {
                errors.push(WorkflowError::DeadEnd { step: step.id });
            }
        }
        errors
    }

    /// What a run that comes to a step in this state runs into, and at which step.
    fn fault_at(&self, place: usize, done: Done) -> Option<(usize, WorkflowError)> {
        let step = &self.steps[place];
        let id = step.id;
        match step.kind {
            StepKind::VisionMove { .. } if !done.recognised => {
                Some((place, WorkflowError::PickWithoutRecognition { step: id }))
            }
            StepKind::VisionMove { .. } => done.all_open.map(|open| {
                let step = self.steps[open].id;
                (open, WorkflowError::AllWithoutPlace { step })
            }),
            StepKind::PalletPattern { .. } | StepKind::CartonPattern { .. } | StepKind::SetDo
                if !done.picked =>
            {
                Some((place, WorkflowError::PlaceWithoutPick { step: id }))
            }
            StepKind::PalletPattern { .. } => done.moved.map(|moved| {
                let step = self.steps[moved].id;
                (moved, WorkflowError::MoveBeforePlace { step })
            }),
            _ => None,
        }
    }

    /// Whether every way on from a step leads to a waypoint that does not itself depend on the one before.
    fn always_comes_to_a_waypoint(&self, place: usize) -> bool {
        let mut seen = BTreeSet::new();
        let mut open = self.places_after(place);
        while let Some(next) = open.pop() {
            let Some(next) = next else {
                return false;
            };
            match &self.steps[next].kind {
                StepKind::RelativeMove {
                    reference: Reference::Previous,
                    ..
                } => return false,
                StepKind::RelativeMove { .. } => {}
                StepKind::VisionMove { .. } => continue,
                kind if kind.travel().is_some() => continue,
                _ => {}
            }
            if seen.insert(next) {
                open.extend(self.places_after(next));
            }
        }
        true
    }

    /// Where a run may go from a step; `None` is the end.
    fn places_after(&self, place: usize) -> Vec<Option<usize>> {
        match &self.steps[place].kind {
            StepKind::BranchByMsg { exits } => exits.iter().map(|id| self.place_of(*id)).collect(),
            _ => vec![self.place_after(place)],
        }
    }

    /// Steps from which some way leads to the end.
    fn places_that_end(&self) -> BTreeSet<usize> {
        let mut ending = BTreeSet::new();
        loop {
            let before = ending.len();
            for place in 0..self.steps.len() {
                let ends = self
                    .places_after(place)
                    .iter()
                    .any(|next| next.is_none_or(|next| ending.contains(&next)));
                // A recognition that reuses its picture ends the run when nothing is left in it.
                let uses_up = matches!(
                    self.steps[place].kind,
                    StepKind::VisualRecognition {
                        reuses_result: true,
                        ..
                    }
                );
                if ends || uses_up {
                    ending.insert(place);
                }
            }
            if ending.len() == before {
                return ending;
            }
        }
    }
}
