use depal_frames::{BoxSize, JointPositions, Pose, Vector};
use depal_wire::Status;

use crate::PortId;

/// One run of a project. Results of a run that was stopped or overtaken are ignored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JobId {
    /// The session that wants it.
    pub port: PortId,
    /// Counts the runs of that session, from 1.
    pub number: u32,
}

/// Work for the cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Job {
    /// Capture and recognise; report with [`crate::Server::finish_vision`].
    RunVision {
        /// The run.
        job_id: JobId,
        /// Number of the vision project.
        project: i32,
        /// Recipe chosen by 103, if any.
        recipe: Option<i32>,
        /// Box size set by 501, if any; it overrides the project's.
        box_size: Option<BoxSize>,
        /// Where the robot says it is.
        pose: RobotPose,
    },
    /// Run the Viz project; report with [`crate::Server::finish_viz`].
    StartViz {
        /// The run.
        job_id: JobId,
        /// Where the robot says it is, or where the path starts; nothing: the planner's home.
        pose: RobotPose,
        /// Box sizes set by 501, by vision project.
        box_sizes: Vec<(i32, BoxSize)>,
        /// Recipes chosen by 103, by vision project.
        recipes: Vec<(i32, i32)>,
    },
    /// Give the run up; no report is wanted.
    StopViz {
        /// The run.
        job_id: JobId,
    },
    /// A counting step of the run goes on from another place.
    SetIndex {
        /// The run.
        job_id: JobId,
        /// Step id.
        step: i32,
        /// The current index, from 0: what 204 named, less 1.
        index: usize,
    },
    /// A step parameter of the Viz project has a new value, from the next run on.
    WriteParameter {
        /// The session.
        port: PortId,
        /// Step id.
        step: i32,
        /// Name of the parameter.
        key: String,
        /// Value, in the unit of the step's own settings.
        value: f64,
    },
    /// The pose of "external move" steps, from the next run on.
    SetOuterPose {
        /// The session.
        port: PortId,
        /// Tool pose in the robot base.
        base_from_tcp: Pose,
    },
    /// The pose that a step of a vision project works with, from the next run on.
    SetInputPose {
        /// The session.
        port: PortId,
        /// Number of the vision project.
        project: i32,
        /// Name of the step.
        step: String,
        /// The pose; its frames are the step's business.
        pose: Pose,
    },
    /// A global variable has a new value.
    SetVariable {
        /// The session.
        port: PortId,
        /// Its name.
        name: String,
        /// The value.
        value: VariableValue,
    },
    /// Another solution is wanted.
    SwitchSolution {
        /// The session.
        port: PortId,
        /// Number of the solution.
        solution: i32,
    },
    /// The robot stands at a calibration pose: capture now.
    CaptureCalibration {
        /// The session.
        port: PortId,
        /// Which pose of the settings, from 1.
        number: usize,
        /// Where the robot says it is.
        base_from_flange: Pose,
        /// Its joints, radians.
        joints: JointPositions,
    },
    /// Command 701 came although no calibration is set up; it was refused.
    NoCalibration {
        /// Port that asked.
        port: PortId,
    },
    /// A branch step that waits may go on.
    SetBranch {
        /// The run.
        job_id: JobId,
        /// Step id.
        step: i32,
        /// Exit, from 0.
        exit: usize,
    },
}

/// What a robot tells with commands 100, 101, 200 and 201.
#[derive(Debug, Clone, PartialEq)]
pub enum RobotPose {
    /// Nothing.
    NotSent,
    /// Where it is now.
    Current {
        /// Joints, radians, unless it has none to tell.
        joints: Option<JointPositions>,
        /// Flange in the robot base, unless not sent.
        base_from_flange: Option<Pose>,
    },
    /// Where a planned path shall start, radians.
    PathStart(JointPositions),
}

impl RobotPose {
    /// Whether it tells where the robot is: then a camera on its flange can be placed.
    pub fn is_current(&self) -> bool {
        match self {
            Self::Current {
                joints,
                base_from_flange,
            } => joints.is_some() || base_from_flange.is_some(),
            Self::NotSent | Self::PathStart(_) => false,
        }
    }
}

/// What vision found, or why it did not.
pub type VisionOutcome = Result<Vec<VisionPoint>, Status>;

/// One object.
#[derive(Debug, Clone, PartialEq)]
pub struct VisionPoint {
    /// Centre of the top face, Z up out of it, X along the long side.
    pub base_from_object: Pose,
    /// Class of the object, 0 if none.
    pub label: i32,
}

/// What the Viz project planned, or why it did not.
pub type VizOutcome = Result<VizPath, Status>;

/// A planned path.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VizPath {
    /// Waypoints in order.
    pub points: Vec<PathPoint>,
    /// Numbers of the gripper's outputs to switch on at the Vision Move; at most 64.
    pub digital_outputs: Vec<u16>,
}

/// A value of a global variable.
#[derive(Debug, Clone, PartialEq)]
pub enum VariableValue {
    /// From 504.
    Number(f64),
    /// From 505.
    Numbers(Vec<f64>),
    /// From 506.
    Text(String),
    /// From 507.
    Texts(Vec<String>),
}

/// The values of one custom port of a vision project.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CustomPort {
    /// Its name: ports are sent in alphabetical order (by bytes), whatever their order here.
    pub name: String,
    /// One row for each point, or for each Vision Move waypoint of a path, in their order.
    pub rows: Vec<Vec<f64>>,
}

/// Vision points and the custom values that go with them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VisionResult {
    /// The points.
    pub points: Vec<VisionPoint>,
    /// The custom ports.
    pub custom_ports: Vec<CustomPort>,
}

/// A path of one or several rounds: what vision projects plan, and Viz projects that reuse a vision result.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PlannedPath {
    /// Waypoints of all rounds in order.
    pub points: Vec<PathPoint>,
    /// Numbers of the gripper's outputs to switch on, by round.
    pub rounds: Vec<Vec<u16>>,
    /// Sections of the gripper: places of a round in the DO list unless the robot names another number.
    pub sections: usize,
    /// Custom values, one row for each Vision Move waypoint.
    pub custom_ports: Vec<CustomPort>,
}

impl From<VizPath> for PlannedPath {
    /// A path of one round without custom values.
    fn from(path: VizPath) -> Self {
        Self {
            points: path.points,
            rounds: vec![path.digital_outputs],
            ..Self::default()
        }
    }
}

/// How a waypoint is reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// All joints together; 1 on the wire.
    Joint,
    /// Straight line of the TCP; 2 on the wire.
    Linear,
}

/// One waypoint.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPoint {
    /// Joints, radians.
    pub joints: JointPositions,
    /// Tool centre point in the robot base, Z out of the tool.
    pub base_from_tcp: Pose,
    /// How it is reached.
    pub motion: Motion,
    /// Tool id, -1 for none.
    pub tool: i32,
    /// Velocity, percent.
    pub velocity_percent: f64,
    /// Label of the picked object, 0 if none.
    pub label: i32,
    /// Present if this is the waypoint of a Vision Move step.
    pub vision_move: Option<VisionMoveData>,
}

/// What is picked at a Vision Move waypoint.
#[derive(Debug, Clone, PartialEq)]
pub struct VisionMoveData {
    /// Labels of the picked objects; unused places are 0.
    pub labels: [i32; 10],
    /// Objects picked since the start of the project, these included.
    pub picked_total: i32,
    /// Objects picked now.
    pub picked_now: i32,
    /// Edge or corner of the gripper that is used.
    pub edge_or_corner: i32,
    /// From the tool centre to the centre of the picked group, in the tool frame, metres.
    pub group_from_tcp_offset: Vector,
    /// The group's long side is square to the gripper's long side instead of parallel.
    pub is_group_square: bool,
    /// The single box's long side is square to the gripper's long side instead of parallel.
    pub is_box_square: bool,
    /// Outer size of the group, metres.
    pub group_size: BoxSize,
}
