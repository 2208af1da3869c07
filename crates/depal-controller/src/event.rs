use depal_time::SimTime;
use depal_vm::execution::RuntimeError;
use depal_vm::system::{LogKind, MoveId, ProgramLocation};

/// What a controller does, as far as its tasks go; also what one of them does.
#[derive(Debug, Clone, PartialEq)]
pub enum ControllerState {
    /// No task was set.
    Idle,
    /// The task runs or waits.
    Running,
    /// The task returned from its entry routine. Queued moves are still carried out.
    Finished,
    /// The task asked to stop, with its reason; the arm brakes to a stand.
    Stopped(String),
    /// An error that the task did not handle; the arm brakes to a stand.
    Failed(RuntimeError),
}

/// What happened in the cabinet. Ordered by time within a cycle.
#[derive(Debug, Clone, PartialEq)]
pub enum ControllerEvent {
    /// The program pointer is somewhere else than before: the last place of a cycle only.
    Statement {
        /// When that statement began.
        at: SimTime,
        /// Where.
        location: ProgramLocation,
    },
    /// A signal changed.
    SignalEdge {
        /// When.
        at: SimTime,
        /// As spelled in its definition.
        name: String,
        /// The new value.
        value: f64,
    },
    /// The arm gets to a move: behind the corner of the one before.
    MoveStarted {
        /// When.
        at: SimTime,
        /// Which.
        id: MoveId,
        /// Its instruction.
        location: ProgramLocation,
    },
    /// The arm stands at a move's end, or leaves its corner.
    MoveReached {
        /// When.
        at: SimTime,
        /// Which.
        id: MoveId,
        /// Its instruction.
        location: ProgramLocation,
    },
    /// A fly-by move becomes a stop, because the next one came too late or left no room to slow down.
    CornerFailure {
        /// When that was found.
        at: SimTime,
        /// The move that was to be left by a corner.
        id: MoveId,
        /// Its instruction.
        location: ProgramLocation,
    },
    /// The arm brakes and the queue is dropped.
    MotionStopped {
        /// When it begins to brake.
        at: SimTime,
        /// Moves that will not be finished.
        dropped: Vec<MoveId>,
        /// Why.
        reason: String,
    },
    /// The arm brakes on its path and the path is kept.
    MotionHeld {
        /// When it begins to brake.
        at: SimTime,
    },
    /// The arm goes on along a path that was held.
    MotionResumed {
        /// When.
        at: SimTime,
    },
    /// A line for the operator or the event log.
    Log {
        /// When.
        at: SimTime,
        /// For whom.
        kind: LogKind,
        /// Where in the program.
        location: ProgramLocation,
        /// The line.
        text: String,
    },
    /// A question to the operator was answered.
    Answered {
        /// When.
        at: SimTime,
        /// The instruction that asked.
        instruction: &'static str,
        /// What the operator read.
        text: String,
        /// What was answered.
        answer: String,
    },
    /// A task is over.
    TaskEnded {
        /// When.
        at: SimTime,
        /// Its name.
        task: String,
        /// How.
        state: ControllerState,
    },
}

impl ControllerEvent {
    /// When it happened.
    pub fn at(&self) -> SimTime {
        match self {
            Self::Statement { at, .. }
            | Self::SignalEdge { at, .. }
            | Self::MoveStarted { at, .. }
            | Self::MoveReached { at, .. }
            | Self::CornerFailure { at, .. }
            | Self::MotionStopped { at, .. }
            | Self::MotionHeld { at }
            | Self::MotionResumed { at }
            | Self::Log { at, .. }
            | Self::Answered { at, .. }
            | Self::TaskEnded { at, .. } => *at,
        }
    }
}
