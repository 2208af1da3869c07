//! What a run asks for, what becomes of it, and why it ends.

use depal_frames::{JointPositions, Pose};

use crate::project::{MoveMotion, OffsetFrame, Place, Reference};

/// What the engine needs, or how the run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ask<P> {
    /// Run a vision project; answer with [`Engine::recognised`](crate::Engine::recognised).
    Recognise {
        /// The step.
        step: i32,
        /// Number of the vision project.
        project: i32,
        /// What an earlier recognition of this run has left is to be used instead of a new picture, if there was one;
        /// if nothing is left of it, answer with an error and the run ends with the path so far.
        may_reuse: bool,
    },
    /// Plan a pick; answer with [`Engine::planned`](crate::Engine::planned). [`Engine::pieces`](crate::Engine::pieces) is the path so far.
    PlanPick {
        /// What to plan.
        pick: PickRequest,
        /// Where to put it, as part of the same plan; absent if the project's own steps go on from the pick.
        place: Option<Place>,
    },
    /// Wait for the robot to choose an exit; answer with [`Engine::branch`](crate::Engine::branch).
    WaitBranch {
        /// The step.
        step: i32,
        /// Number of exits.
        exits: usize,
    },
    /// Leave a message for the robot; answer with [`Engine::notified`](crate::Engine::notified).
    Notify {
        /// The step.
        step: i32,
        /// The message.
        message: i32,
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
    /// Pick and place everything that was recognised, round after round.
    pub plans_all: bool,
    /// Most objects of one pick.
    pub max_group: u32,
    /// Velocity of the Vision Move, percent, the global one included.
    pub velocity_percent: f64,
    /// A Set DO step follows: the robot wants the outputs. False if the project has none.
    pub wants_outputs: bool,
}

/// A move that the planner did not plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Move {
    /// The step.
    pub step: i32,
    /// Where to.
    pub target: Target,
    /// By joints or straight.
    pub motion: MoveMotion,
    /// Velocity, percent, the global one included.
    pub velocity_percent: f64,
}

/// Where a move goes.
#[derive(Debug, Clone, PartialEq)]
pub enum Target {
    /// To joints, radians.
    Joints(JointPositions),
    /// To a tool pose in the robot base.
    Tool(Pose),
    /// To an offset from another waypoint.
    Relative {
        /// From the reference to the waypoint.
        offset: Pose,
        /// Which axes the offset counts along.
        frame: OffsetFrame,
        /// The other waypoint.
        reference: Reference,
    },
    /// To where the carton that was picked last stands at a place: middle of its bottom face in the robot base, Z up.
    Carton(Pose),
}

impl Target {
    /// Tool pose at an offset from `base_from_reference`.
    pub fn offset_pose(base_from_reference: &Pose, offset: &Pose, frame: OffsetFrame) -> Pose {
        match frame {
            OffsetFrame::Tool => base_from_reference * offset,
            OffsetFrame::Base => Pose::from_parts(
                (base_from_reference.translation.vector + offset.translation.vector).into(),
                offset.rotation * base_from_reference.rotation,
            ),
        }
    }
}

/// A piece of the finished path.
#[derive(Debug, Clone, PartialEq)]
pub enum Piece<P> {
    /// A move of the project's own.
    Move(Move),
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
    /// A list or grid was asked for a place behind its last one.
    IndexOutOfRange,
    /// Every place of a pattern is taken.
    PatternFull,
    /// An External Move came although the robot sent no pose.
    NoExternalPose,
}

impl Failure {
    /// The interface's status code.
    pub fn status_code(self) -> i32 {
        match self {
            Self::Status(code) => code,
            Self::RecognitionNotCalled => 2036,
            Self::EndlessLoop | Self::UnexpectedAnswer => 2008,
            Self::IndexOutOfRange => 2027,
            Self::PatternFull => 2032,
            Self::NoExternalPose => 2013,
        }
    }
}

/// Why an index was not set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum IndexError {
    /// No such step, or one without an index.
    #[error("step {step} has no index")]
    UnknownStep {
        /// The step.
        step: i32,
    },
    /// Outside the step's places.
    #[error("step {step}: index {found}, expected 1 to {places}")]
    OutOfRange {
        /// The step.
        step: i32,
        /// The number sent.
        found: i32,
        /// Places of the step.
        places: u32,
    },
}

impl IndexError {
    /// The interface's status code.
    pub fn status_code(self) -> i32 {
        match self {
            Self::UnknownStep { .. } => 2026,
            Self::OutOfRange { .. } => 2027,
        }
    }
}
