use std::fmt;

use depal_frames::JointPositions;

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
    },
    /// Picks one object, or a group, out of the last recognition.
    VisionMove {
        /// The gripper's sections are chosen one by one; else all of them are used.
        uses_sections: bool,
    },
    /// Waits for the robot to choose an exit.
    BranchByMsg {
        /// Ids of the steps behind the exits, exit 0 first.
        exits: Vec<i32>,
    },
    /// Goes to taught joints.
    FixedPointMove(FixedPoint),
    /// Sends the gripper's outputs of the last Vision Move to the robot.
    SetDo,
    /// Places what was picked.
    PalletPattern {
        /// Where.
        place: Place,
    },
}

/// A taught move.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedPoint {
    /// Joints, radians.
    pub joints: JointPositions,
    /// How to get there.
    pub motion: MoveMotion,
    /// Velocity, percent, before the project's global one.
    pub velocity_percent: f64,
}

/// How a taught move goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MoveMotion {
    /// All joints together.
    Joint,
    /// Straight line of the TCP.
    Linear,
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

impl fmt::Display for Project {
    /// The workflow as text, one step a line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for step in &self.steps {
            write!(f, "{:>4}  {}", step.id, step.kind)?;
            match (&step.kind, step.next) {
                (StepKind::BranchByMsg { .. }, _) | (_, Next::Following) => writeln!(f)?,
                (_, Next::Step(id)) => writeln!(f, " -> {id}")?,
                (_, Next::End) => writeln!(f, " -> end")?,
            }
        }
        Ok(())
    }
}

impl fmt::Display for StepKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::VisualRecognition { project } => {
                write!(f, "visual_recognition project {project}")
            }
            Self::VisionMove {
                uses_sections: true,
            } => f.write_str("vision_move by sections"),
            Self::VisionMove { .. } => f.write_str("vision_move"),
            Self::BranchByMsg { exits } => {
                f.write_str("branch_by_msg ->")?;
                exits.iter().try_for_each(|id| write!(f, " {id}"))
            }
            Self::FixedPointMove(point) => write!(
                f,
                "fixed_point_move {} at {} %",
                match point.motion {
                    MoveMotion::Joint => "joint",
                    MoveMotion::Linear => "linear",
                },
                point.velocity_percent
            ),
            Self::SetDo => f.write_str("set_do"),
            Self::PalletPattern {
                place: Place::Conveyor,
            } => f.write_str("pallet_pattern conveyor"),
        }
    }
}
