//! Walks through a project and says what it needs next.

use std::collections::BTreeMap;

use depal_frames::Pose;

use crate::ask::{Ask, Failure, IndexError, Move, PickRequest, Piece, Target};
use crate::check::WorkflowError;
use crate::parameter::{ParameterError, read_parameter, write_parameter};
use crate::project::{Place, Project, StepKind, Travel};

/// Steps that a run may take before it counts as an endless loop.
const MOST_STEPS: usize = 10_000;

/// A run of a project. `P` is the driver's type of a planned pick.
#[derive(Debug, Clone)]
pub struct Engine<P> {
    project: Project,
    state: State,
    /// The step to carry out next; `None` at the end.
    place: Option<usize>,
    steps_taken: usize,
    recognised_project: Option<i32>,
    /// A pick whose place is not known yet.
    pending: Option<PickRequest>,
    /// Moves behind the pending pick.
    held_back: Vec<Move>,
    pieces: Vec<Piece<P>>,
    /// Current index of each step that has one; 0 where none is noted.
    indexes: BTreeMap<i32, u32>,
    external_pose: Option<Pose>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Idle,
    Recognising { project: i32, may_reuse: bool },
    Planning { step: i32 },
    AtBranch { place: usize },
    Notifying,
}

impl<P> Engine<P> {
    /// Refuses a project that cannot run; see [`Project::check`] for all errors at once.
    pub fn new(project: Project, vision_projects: &[i32]) -> Result<Self, WorkflowError> {
        match project.check(vision_projects).into_iter().next() {
            Some(error) => Err(error),
            None => Ok(Self {
                project,
                state: State::Idle,
                place: None,
                steps_taken: 0,
                recognised_project: None,
                pending: None,
                held_back: Vec::new(),
                pieces: Vec::new(),
                indexes: BTreeMap::new(),
                external_pose: None,
            }),
        }
    }

    /// The project, with its parameters as they are set now.
    pub fn project(&self) -> &Project {
        &self.project
    }

    /// The path so far.
    pub fn pieces(&self) -> &[Piece<P>] {
        &self.pieces
    }

    /// Begins a run at the first step; a run before is given up, and every index is 0 again.
    pub fn start(&mut self) -> Ask<P> {
        self.place = Some(0);
        self.steps_taken = 0;
        self.recognised_project = None;
        self.pending = None;
        self.held_back.clear();
        self.pieces.clear();
        self.indexes.clear();
        self.advance()
    }

    /// Gives the run up.
    pub fn stop(&mut self) {
        self.state = State::Idle;
        self.place = None;
    }

    /// The pose that an External Move goes to (502), tool in robot base; it holds for every later run.
    pub fn set_external_pose(&mut self, base_from_tcp: Pose) {
        self.external_pose = Some(base_from_tcp);
    }

    /// Takes the number N of command 204: the current index becomes N - 1, and N when the step is carried out.
    pub fn set_index(&mut self, step: i32, number: i32) -> Result<(), IndexError> {
        let places = self
            .project
            .step(step)
            .and_then(|step| step.kind.place_count())
            .ok_or(IndexError::UnknownStep { step })?;
        match u32::try_from(number) {
            Ok(number) if (1..=places).contains(&number) => {
                self.indexes.insert(step, number - 1);
                Ok(())
            }
            _ => Err(IndexError::OutOfRange {
                step,
                found: number,
                places,
            }),
        }
    }

    /// Current index of a step: how many of its places are taken.
    pub fn index(&self, step: i32) -> u32 {
        self.indexes.get(&step).copied().unwrap_or(0)
    }

    /// A step's parameter by its key, in the units of the wire (207).
    pub fn parameter(&self, step: i32, key: &str) -> Result<f64, ParameterError> {
        read_parameter(&self.project, step, key)
    }

    /// Changes a step's parameter, in the units of the wire (208); it stays until it is changed again.
    pub fn set_parameter(
        &mut self,
        step: i32,
        key: &str,
        value: f64,
    ) -> Result<(), ParameterError> {
        write_parameter(&mut self.project, step, key, value)
    }

    /// Answers [`Ask::Recognise`]: something was found, or the status code that says why not.
    pub fn recognised(&mut self, outcome: Result<(), i32>) -> Ask<P> {
        let State::Recognising { project, may_reuse } = self.state else {
            return self.fail(Failure::UnexpectedAnswer);
        };
        match outcome {
            Ok(()) => {
                self.recognised_project = Some(project);
                self.advance()
            }
            // Everything in the picture has its path: a loop over one picture ends here.
            Err(_) if may_reuse && self.has_plan() => self.done(),
            Err(code) => self.fail(Failure::Status(code)),
        }
    }

    /// Answers [`Ask::PlanPick`]: the plan, or the status code that says why there is none.
    pub fn planned(&mut self, outcome: Result<P, i32>) -> Ask<P> {
        let State::Planning { step } = self.state else {
            return self.fail(Failure::UnexpectedAnswer);
        };
        match outcome {
            Ok(plan) => {
                self.pieces.push(Piece::Planned { step, plan });
                self.pieces
                    .extend(self.held_back.drain(..).map(Piece::Move));
                self.advance()
            }
            Err(code) => self.fail(Failure::Status(code)),
        }
    }

    /// Answers [`Ask::WaitBranch`] with an exit, from 0.
    pub fn branch(&mut self, exit: usize) -> Ask<P> {
        let State::AtBranch { place } = self.state else {
            return self.fail(Failure::UnexpectedAnswer);
        };
        let target = match &self.project.steps[place].kind {
            StepKind::BranchByMsg { exits } => exits.get(exit).copied(),
            _ => None,
        };
        match target.and_then(|id| self.project.place_of(id)) {
            Some(next) => {
                self.place = Some(next);
                self.advance()
            }
            None => self.fail(Failure::UnexpectedAnswer),
        }
    }

    /// Answers [`Ask::Notify`].
    pub fn notified(&mut self) -> Ask<P> {
        if self.state == State::Notifying {
            self.advance()
        } else {
            self.fail(Failure::UnexpectedAnswer)
        }
    }

    fn has_plan(&self) -> bool {
        self.pieces
            .iter()
            .any(|piece| matches!(piece, Piece::Planned { .. }))
    }

    fn advance(&mut self) -> Ask<P> {
        self.state = State::Idle;
        while let Some(place) = self.place {
            self.steps_taken += 1;
            if self.steps_taken > MOST_STEPS {
                return self.fail(Failure::EndlessLoop);
            }
            let step = &self.project.steps[place];
            let id = step.id;
            match &step.kind {
                StepKind::VisualRecognition {
                    project,
                    reuses_result,
                } => {
                    let (project, may_reuse) = (*project, *reuses_result);
                    // A pick before this step is out of the picture before: plan it first, then come back.
                    if let Some(pick) = self.pending.take() {
                        return self.plan(pick, None);
                    }
                    self.place = self.project.place_after(place);
                    self.state = State::Recognising { project, may_reuse };
                    return Ask::Recognise {
                        step: id,
                        project,
                        may_reuse,
                    };
                }
                StepKind::VisionMove {
                    uses_sections,
                    plans_all,
                    max_group,
                    velocity_percent,
                } => {
                    let Some(project) = self.recognised_project else {
                        return self.fail(Failure::RecognitionNotCalled);
                    };
                    let pick = PickRequest {
                        step: id,
                        project,
                        uses_sections: *uses_sections,
                        plans_all: *plans_all,
                        max_group: *max_group,
                        velocity_percent: self.scaled(*velocity_percent),
                        wants_outputs: false,
                    };
                    // A pick before this one had no place: plan it first, then come back here.
                    if let Some(pick) = self.pending.take() {
                        return self.plan(pick, None);
                    }
                    self.pending = Some(pick);
                }
                StepKind::BranchByMsg { exits } => {
                    let exits = exits.len();
                    self.state = State::AtBranch { place };
                    return Ask::WaitBranch { step: id, exits };
                }
                StepKind::Notify { message } => {
                    let message = *message;
                    self.place = self.project.place_after(place);
                    self.state = State::Notifying;
                    return Ask::Notify { step: id, message };
                }
                StepKind::SetDo => {
                    if let Some(pick) = &mut self.pending {
                        pick.wants_outputs = true;
                    }
                }
                StepKind::PalletPattern { place: target } => {
                    let target = *target;
                    if let Some(pick) = self.pending.take() {
                        self.place = self.project.place_after(place);
                        return self.plan(pick, Some(target));
                    }
                }
                StepKind::FixedPointMove { joints, travel } => {
                    let (target, travel) = (Target::Joints(*joints), *travel);
                    self.travel(id, target, travel);
                }
                StepKind::RelativeMove {
                    offset,
                    frame,
                    reference,
                    travel,
                } => {
                    let target = Target::Relative {
                        offset: *offset,
                        frame: *frame,
                        reference: *reference,
                    };
                    let travel = *travel;
                    self.travel(id, target, travel);
                }
                StepKind::MoveByList { targets, travel } => {
                    let target = targets.get(self.index(id) as usize).copied();
                    let travel = *travel;
                    let Some(joints) = target else {
                        return self.fail(Failure::IndexOutOfRange);
                    };
                    self.travel_by_index(id, Target::Joints(joints), travel);
                }
                StepKind::MoveByGrid { grid, travel } => {
                    let target = grid.base_from_tcp(self.index(id));
                    let travel = *travel;
                    let Some(pose) = target else {
                        return self.fail(Failure::IndexOutOfRange);
                    };
                    self.travel_by_index(id, Target::Tool(pose), travel);
                }
                StepKind::CartonPattern { pattern, travel } => {
                    let target = pattern.base_from_carton(self.index(id));
                    let travel = *travel;
                    let Some(pose) = target else {
                        return self.fail(Failure::PatternFull);
                    };
                    self.travel_by_index(id, Target::Carton(pose), travel);
                }
                StepKind::ExternalMove { travel } => {
                    let travel = *travel;
                    let Some(pose) = self.external_pose else {
                        return self.fail(Failure::NoExternalPose);
                    };
                    self.travel(id, Target::Tool(pose), travel);
                }
            }
            self.place = self.project.place_after(place);
        }
        if let Some(pick) = self.pending.take() {
            return self.plan(pick, None);
        }
        self.done()
    }

    fn scaled(&self, velocity_percent: f64) -> f64 {
        velocity_percent * self.project.global_velocity_percent / 100.0
    }

    fn travel(&mut self, step: i32, target: Target, travel: Travel) {
        let next = Move {
            step,
            target,
            motion: travel.motion,
            velocity_percent: self.scaled(travel.velocity_percent),
        };
        if self.pending.is_some() {
            self.held_back.push(next);
        } else {
            self.pieces.push(Piece::Move(next));
        }
    }

    /// The step's index rises when it is carried out.
    fn travel_by_index(&mut self, step: i32, target: Target, travel: Travel) {
        *self.indexes.entry(step).or_insert(0) += 1;
        self.travel(step, target, travel);
    }

    fn plan(&mut self, pick: PickRequest, place: Option<Place>) -> Ask<P> {
        self.state = State::Planning { step: pick.step };
        Ask::PlanPick { pick, place }
    }

    fn done(&mut self) -> Ask<P> {
        self.stop();
        Ask::Done(std::mem::take(&mut self.pieces))
    }

    fn fail(&mut self, failure: Failure) -> Ask<P> {
        self.stop();
        Ask::Failed(failure)
    }
}
