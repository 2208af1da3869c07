use depal_frames::{JointPositions, Pose};

use crate::parameter::{Parameter, parameters};
use crate::pattern::{CartonPattern, Grid};

/// A Viz project: its steps, the first one being where a run begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Project {
    /// Steps in the order in which they follow one another unless they say otherwise.
    pub steps: Vec<Step>,
    /// Scales the velocity of every move, percent.
    pub global_velocity_percent: f64,
}

/// One step.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// The id that commands and other steps name, from 1.
    pub id: i32,
    /// What it does.
    pub kind: StepKind,
    /// Where the run goes on; a branch ignores it.
    pub next: Next,
}

/// Where a run goes on after a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next {
    /// At the next step of the list; the run ends after the last one.
    Following,
    /// At the step with this id.
    Step(i32),
    /// Nowhere: the path is complete.
    End,
}

/// What a step does.
#[derive(Debug, Clone, PartialEq)]
pub enum StepKind {
    /// Runs a vision project.
    VisualRecognition {
        /// Number of the vision project.
        project: i32,
        /// In a loop: goes on with what the picture before has left, and ends the run when nothing is left.
        reuses_result: bool,
    },
    /// Picks one object, or a group, out of the last recognition.
    VisionMove {
        /// The gripper's sections are chosen one by one; else all of them are used.
        uses_sections: bool,
        /// Everything that was recognised is picked and placed, round after round, in one path.
        plans_all: bool,
        /// Most objects of one pick: like ones side by side.
        max_group: u32,
        /// Velocity, percent, before the project's global one.
        velocity_percent: f64,
    },
    /// Waits for the robot to choose an exit.
    BranchByMsg {
        /// Ids of the steps behind the exits, exit 0 first.
        exits: Vec<i32>,
    },
    /// Goes to taught joints.
    FixedPointMove {
        /// Joints, radians.
        joints: JointPositions,
        /// How to get there.
        travel: Travel,
    },
    /// Goes to a place that is given against another waypoint.
    RelativeMove {
        /// From the reference to the waypoint.
        offset: Pose,
        /// Which axes the offset counts along.
        frame: OffsetFrame,
        /// What it counts from.
        reference: Reference,
        /// How to get there.
        travel: Travel,
    },
    /// Goes to one of several taught joints, chosen by the step's index.
    MoveByList {
        /// The list, radians.
        targets: Vec<JointPositions>,
        /// How to get there.
        travel: Travel,
    },
    /// Goes to one of the poses of a grid, chosen by the step's index.
    MoveByGrid {
        /// The grid.
        grid: Grid,
        /// How to get there.
        travel: Travel,
    },
    /// Places what was picked by a pattern, place by place in the order of the step's index.
    CartonPattern {
        /// The places.
        pattern: CartonPattern,
        /// How to get there.
        travel: Travel,
    },
    /// Goes to the tool pose that the robot sent before the run (502).
    ExternalMove {
        /// How to get there.
        travel: Travel,
    },
    /// Sends the gripper's outputs of the last Vision Move to the robot.
    SetDo,
    /// Leaves a message for the robot.
    Notify {
        /// The message, a positive number.
        message: i32,
    },
    /// Places what was picked; the planner finds the whole way from the pick.
    PalletPattern {
        /// Where.
        place: Place,
    },
}

/// How a move goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Travel {
    /// By joints or straight.
    pub motion: MoveMotion,
    /// Velocity, percent, before the project's global one.
    pub velocity_percent: f64,
}

/// By joints or straight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MoveMotion {
    /// All joints together.
    Joint,
    /// Straight line of the TCP.
    Linear,
}

/// Which axes an offset counts along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OffsetFrame {
    /// Those of the tool at the reference: `base_from_tcp = base_from_reference * offset`.
    Tool,
    /// Those of the robot base: position and turn are added in base axes about the reference's origin.
    Base,
}

/// The waypoint that an offset counts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// The one before; at the start of the path where the robot stands.
    Previous,
    /// The one after.
    Next,
}

/// Where picked objects go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Onto the conveyor, always the same spot.
    Conveyor,
}

impl Project {
    /// A project of these steps at full velocity.
    pub fn new(steps: Vec<Step>) -> Self {
        Self {
            steps,
            global_velocity_percent: 100.0,
        }
    }

    /// The branch steps: id and number of exits.
    pub fn branches(&self) -> Vec<(i32, usize)> {
        self.steps
            .iter()
            .filter_map(|step| match &step.kind {
                StepKind::BranchByMsg { exits } => Some((step.id, exits.len())),
                _ => None,
            })
            .collect()
    }

    /// The steps that have an index (command 204): id and number of places.
    pub fn index_steps(&self) -> Vec<(i32, u32)> {
        self.steps
            .iter()
            .filter_map(|step| Some((step.id, step.kind.place_count()?)))
            .collect()
    }

    /// Every parameter that a robot may read (207), with what it may write (208), in the units of the wire.
    pub fn parameters(&self) -> Vec<Parameter> {
        parameters(self)
    }

    /// The step with an id.
    pub fn step(&self, id: i32) -> Option<&Step> {
        self.steps.iter().find(|step| step.id == id)
    }

    /// Place of a step in the list.
    pub(crate) fn place_of(&self, id: i32) -> Option<usize> {
        self.steps.iter().position(|step| step.id == id)
    }

    /// Place of the step after the one at `place`, branches left out; `None` at the end of the run.
    pub(crate) fn place_after(&self, place: usize) -> Option<usize> {
        match self.steps[place].next {
            Next::Following => Some(place + 1).filter(|next| *next < self.steps.len()),
            Next::Step(id) => self.place_of(id),
            Next::End => None,
        }
    }
}

impl Step {
    /// A step that goes on at the following one.
    pub fn new(id: i32, kind: StepKind) -> Self {
        Self {
            id,
            kind,
            next: Next::Following,
        }
    }

    /// The same step with another continuation.
    pub fn then(mut self, next: Next) -> Self {
        self.next = next;
        self
    }
}

impl StepKind {
    /// Number of places of a step with an index; none for other steps.
    pub fn place_count(&self) -> Option<u32> {
        match self {
            Self::MoveByList { targets, .. } => Some(targets.len() as u32),
            Self::MoveByGrid { grid, .. } => Some(grid.len()),
            Self::CartonPattern { pattern, .. } => Some(pattern.len()),
            _ => None,
        }
    }

    /// Velocity of a step that moves, percent.
    pub(crate) fn velocity_percent(&self) -> Option<f64> {
        match self {
            Self::VisionMove {
                velocity_percent, ..
            } => Some(*velocity_percent),
            other => other.travel().map(|travel| travel.velocity_percent),
        }
    }

    pub(crate) fn velocity_percent_mut(&mut self) -> Option<&mut f64> {
        match self {
            Self::VisionMove {
                velocity_percent, ..
            } => Some(velocity_percent),
            Self::FixedPointMove { travel, .. }
            | Self::RelativeMove { travel, .. }
            | Self::MoveByList { travel, .. }
            | Self::MoveByGrid { travel, .. }
            | Self::CartonPattern { travel, .. }
            | Self::ExternalMove { travel } => Some(&mut travel.velocity_percent),
            _ => None,
        }
    }

    /// How a step that moves by itself goes.
    pub(crate) fn travel(&self) -> Option<Travel> {
        match self {
            Self::FixedPointMove { travel, .. }
            | Self::RelativeMove { travel, .. }
            | Self::MoveByList { travel, .. }
            | Self::MoveByGrid { travel, .. }
            | Self::CartonPattern { travel, .. }
            | Self::ExternalMove { travel } => Some(*travel),
            _ => None,
        }
    }
}

impl Travel {
    /// All joints together at a velocity in percent.
    pub fn joint(velocity_percent: f64) -> Self {
        Self {
            motion: MoveMotion::Joint,
            velocity_percent,
        }
    }

    /// Straight at a velocity in percent.
    pub fn linear(velocity_percent: f64) -> Self {
        Self {
            motion: MoveMotion::Linear,
            velocity_percent,
        }
    }
}
