//! Walks through a project and says what it needs next.

use crate::check::WorkflowError;
use crate::project::{FixedPoint, Place, Project, StepKind};

/// Steps that a run may take before it counts as an endless loop.
const MOST_STEPS: usize = 10_000;

/// What the engine needs, or how the run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ask<P> {
    /// Run a vision project; answer with [`Engine::recognised`].
    Recognise {
        /// The step.
        step: i32,
        /// Number of the vision project.
        project: i32,
    },
    /// Plan a pick; answer with [`Engine::planned`].
    PlanPick {
        /// What to plan.
        pick: PickRequest,
        /// Where to put it; absent if the project ends with the pick.
        place: Option<Place>,
    },
    /// Wait for the robot to choose an exit; answer with [`Engine::branch`].
    WaitBranch {
        /// The step.
        step: i32,
        /// Number of exits.
        exits: usize,
    },
    /// The run is over: the pieces of the path in order.
    Done(Vec<Piece<P>>),
    /// The run is over without a path.
    Failed(Failure),
}

/// A pick to plan.
#[derive(Debug, Clone, PartialEq)]
pub struct PickRequest {
    /// The Vision Move step.
    pub step: i32,
    /// The vision project whose last recognition is picked from.
    pub project: i32,
    /// Choose gripper sections one by one.
    pub uses_sections: bool,
    /// A Set DO step follows: the robot wants the outputs. False if the project has none.
    pub wants_outputs: bool,
    /// Taught moves between pick and place, in order; velocities include the global one.
    pub via: Vec<FixedPoint>,
}

/// A piece of the finished path.
#[derive(Debug, Clone, PartialEq)]
pub enum Piece<P> {
    /// A taught move; its velocity includes the global one.
    Fixed {
        /// The step.
        step: i32,
        /// The move.
        point: FixedPoint,
    },
    /// What the planner answered.
    Planned {
        /// The Vision Move step.
        step: i32,
        /// The driver's own value.
        plan: P,
    },
}

/// Why a run failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// Vision or planner refused; the status code that the driver gave.
    Status(i32),
    /// A Vision Move came before any recognition.
    RecognitionNotCalled,
    /// The run took too many steps.
    EndlessLoop,
    /// An answer came that was not asked for, or an exit that does not exist.
    UnexpectedAnswer,
}

impl Failure {
    /// The interface's status code.
    pub fn status_code(self) -> i32 {
        match self {
            Self::Status(code) => code,
            Self::RecognitionNotCalled => 2036,
            Self::EndlessLoop | Self::UnexpectedAnswer => 2008,
        }
    }
}

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
    pieces: Vec<Piece<P>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Idle,
    Recognising { project: i32 },
    Planning { step: i32 },
    AtBranch { place: usize },
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
                pieces: Vec::new(),
            }),
        }
    }

    /// The project.
    pub fn project(&self) -> &Project {
        &self.project
    }

    /// Begins a run at the first step; a run before is given up.
    pub fn start(&mut self) -> Ask<P> {
        self.place = Some(0);
        self.steps_taken = 0;
        self.recognised_project = None;
        self.pending = None;
        self.pieces.clear();
        self.advance()
    }

    /// Gives the run up.
    pub fn stop(&mut self) {
        self.state = State::Idle;
        self.place = None;
    }

    /// Answers [`Ask::Recognise`]: something was found, or the status code that says why not.
    pub fn recognised(&mut self, outcome: Result<(), i32>) -> Ask<P> {
        let State::Recognising { project } = self.state else {
            return self.fail(Failure::UnexpectedAnswer);
        };
        match outcome {
            Ok(()) => {
                self.recognised_project = Some(project);
                self.advance()
            }
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
                StepKind::VisualRecognition { project } => {
                    let project = *project;
                    self.place = self.project.place_after(place);
                    self.state = State::Recognising { project };
                    return Ask::Recognise { step: id, project };
                }
                StepKind::VisionMove { uses_sections } => {
                    let uses_sections = *uses_sections;
                    let Some(project) = self.recognised_project else {
                        return self.fail(Failure::RecognitionNotCalled);
                    };
                    // A pick before this one had no place: plan it first, then come back here.
                    if let Some(pick) = self.pending.take() {
                        return self.plan(pick, None);
                    }
                    self.pending = Some(PickRequest {
                        step: id,
                        project,
                        uses_sections,
                        wants_outputs: false,
                        via: Vec::new(),
                    });
                }
                StepKind::BranchByMsg { exits } => {
                    let exits = exits.len();
                    self.state = State::AtBranch { place };
                    return Ask::WaitBranch { step: id, exits };
                }
                StepKind::FixedPointMove(point) => {
                    let mut point = point.clone();
                    point.velocity_percent *= self.project.global_velocity_percent / 100.0;
                    match &mut self.pending {
                        Some(pick) => pick.via.push(point),
                        None => self.pieces.push(Piece::Fixed { step: id, point }),
                    }
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
            }
            self.place = self.project.place_after(place);
        }
        if let Some(pick) = self.pending.take() {
            return self.plan(pick, None);
        }
        Ask::Done(std::mem::take(&mut self.pieces))
    }

    fn plan(&mut self, pick: PickRequest, place: Option<Place>) -> Ask<P> {
        self.state = State::Planning { step: pick.step };
        Ask::PlanPick { pick, place }
    }

    fn fail(&mut self, failure: Failure) -> Ask<P> {
        self.stop();
        Ask::Failed(failure)
    }
}
