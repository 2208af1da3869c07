use depal_time::SimTime;
use depal_vm::execution::RobotTask;
use depal_vm::system::ProgramLocation;

use crate::ControllerState;

/// What a task is to its cabinet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskRole {
    /// Its name, `T_ROB1`.
    pub name: String,
    /// Whether it moves the arm; in another task moves are refused.
    pub moves_arm: bool,
    /// Whether it belongs to the cabinet rather than to the production: the controller has finished without it.
    pub is_background: bool,
    /// Whether an error that it does not handle stops all tasks, not it alone.
    pub stops_all: bool,
}

impl TaskRole {
    /// The task that moves the arm.
    pub fn motion(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            moves_arm: true,
            is_background: false,
            stops_all: true,
        }
    }

    /// A task in the background: without arm, and nobody waits for its end.
    pub fn background(name: &str) -> Self {
        Self {
            moves_arm: false,
            is_background: true,
            ..Self::motion(name)
        }
    }
}

/// What a cabinet knows of a task beside the task itself.
#[derive(Debug, Clone)]
pub(crate) struct TaskRecord {
    pub role: TaskRole,
    pub state: ControllerState,
    /// When its next statement begins.
    pub cursor: SimTime,
    /// Whether it waited at the end of the last cycle.
    pub waiting: bool,
    /// Place of the last statement, and the one told last.
    pub statement: Option<(SimTime, ProgramLocation)>,
    pub statement_told: Option<ProgramLocation>,
    /// For each of its shared data the place in the cabinet's list; none for what it has alone.
    pub shares: Vec<Option<usize>>,
}

impl TaskRecord {
    pub fn new(role: TaskRole) -> Self {
        Self {
            role,
            state: ControllerState::Running,
            cursor: SimTime::ZERO,
            waiting: false,
            statement: None,
            statement_told: None,
            shares: Vec::new(),
        }
    }
}

/// What all tasks together do: an error that stops all, else what the tasks of the production do as long as
/// one of them runs, else how the first of them ended. A cabinet with background tasks only goes by these.
pub(crate) fn overall(tasks: &[TaskRecord]) -> ControllerState {
    let failed = |task: &&TaskRecord| {
        task.role.stops_all && matches!(task.state, ControllerState::Failed(_))
    };
    if let Some(task) = tasks.iter().find(failed) {
        return task.state.clone();
    }
    let production = tasks.iter().any(|task| !task.role.is_background);
    let counts = |task: &&TaskRecord| task.role.is_background != production;
    let mut counted = tasks.iter().filter(counts);
    if counted.clone().any(|t| t.state == ControllerState::Running) {
        return ControllerState::Running;
    }
    let stopped = |task: &&TaskRecord| task.state != ControllerState::Finished;
    let first = counted.clone().find(stopped).or_else(|| counted.next());
    first.map_or(ControllerState::Idle, |task| task.state.clone())
}

/// The tasks of a controller, in the order in which they run.
pub(crate) type Tasks = Vec<Box<dyn RobotTask>>;
