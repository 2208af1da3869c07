//! What happened, in order: the event log is the run's memory and is byte-identical for the same
//! scene, seed and binary.

use depal_frames::Pose;
use depal_time::SimTime;
use serde::Serialize;

/// A pose as it is logged: position in mm, rotation as a quaternion (w, x, y, z).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LoggedPose {
    /// x, y, z in mm, rounded to a micrometre.
    pub xyz_mm: [f64; 3],
    /// w, x, y, z, rounded to 1e-7.
    pub quat_wxyz: [f64; 4],
}

impl From<&Pose> for LoggedPose {
    fn from(pose: &Pose) -> Self {
        let t = pose.translation.vector;
        let q = pose.rotation.coords;
        let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
        Self {
            xyz_mm: [t.x, t.y, t.z].map(|v| round(v * 1e3, 1e3)),
            quat_wxyz: [q.w, q.x, q.y, q.z].map(|v| round(v * sign, 1e7)),
        }
    }
}

/// Rounds to `1 / scale`, and never returns minus zero.
pub(crate) fn round(value: f64, scale: f64) -> f64 {
    (value * scale).round() / scale + 0.0
}

/// Why a pick did not deliver its carton, or a run its pallet: one stable vocabulary.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FailureReason {
    /// Vision reported no carton although some were left.
    NoDetection,
    /// The gripper took hold of a carton other than the one that was planned.
    WrongBox,
    /// The reported pose was too far from the true one to pick.
    PoseError,
    /// No inverse kinematics for pick, path or place.
    IkUnreachable,
    /// Every planned path would touch something.
    PlanCollision,
    /// The vacuum never reached the switching level.
    NoSeal,
    /// The seal broke while the carton was held.
    SealLost,
    /// The carton was heavier, or moved faster, than the vacuum holds.
    Dropped,
    /// Arm, gripper or held carton hit something.
    Collision,
    /// Other cartons were pushed or pulled out of place.
    NeighbourMoved,
    /// The carton was let go of, but not onto the conveyor.
    PlaceMissed,
    /// The dialogue between program and vision server went wrong.
    ProtocolError,
    /// The robot program stopped on an error of its own.
    ProgramError,
    /// The time limit of the run, or of a command, passed.
    Timeout,
}

impl FailureReason {
    /// The name used in reports and logs.
    pub fn name(self) -> &'static str {
        match self {
            Self::NoDetection => "no_detection",
            Self::WrongBox => "wrong_box",
            Self::PoseError => "pose_error",
            Self::IkUnreachable => "ik_unreachable",
            Self::PlanCollision => "plan_collision",
            Self::NoSeal => "no_seal",
            Self::SealLost => "seal_lost",
            Self::Dropped => "dropped",
            Self::Collision => "collision",
            Self::NeighbourMoved => "neighbour_moved",
            Self::PlaceMissed => "place_missed",
            Self::ProtocolError => "protocol_error",
            Self::ProgramError => "program_error",
            Self::Timeout => "timeout",
        }
    }
}

/// One carton as vision reported it, next to the truth that only the cell knows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoggedDetection {
    /// Reported top-face pose in the world frame (through the calibrated camera pose).
    pub world_from_box: LoggedPose,
    /// Reported size, mm.
    pub size_mm: [f64; 3],
    /// Confidence, 0 to 1.
    pub confidence: f64,
    /// The true carton that it matches, if any.
    pub carton: Option<u32>,
    /// Distance of the top-face centres, mm.
    pub error_mm: Option<f64>,
    /// Angle between the frames, degrees, modulo the carton's half-turn symmetry.
    pub error_deg: Option<f64>,
}

/// One waypoint of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoggedWaypoint {
    /// Joint positions, degrees.
    pub joints_deg: Vec<f64>,
    /// Tool pose in the world frame.
    pub world_from_tcp: LoggedPose,
    /// `joint` or `linear`.
    pub motion: &'static str,
    /// Share of the programmed speed, percent.
    pub velocity_percent: f64,
}

/// A point in simulated time and what happened there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Event {
    /// When, nanoseconds of simulated time.
    #[serde(rename = "t_ns")]
    pub time: SimTime,
    /// What.
    #[serde(flatten)]
    pub kind: EventKind,
}

/// The beats of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum EventKind {
    /// First event.
    RunStarted {
        /// Scene name.
        scene: String,
        /// Seed.
        seed: u64,
        /// Program version.
        version: String,
        /// Cartons at the start.
        cartons: usize,
        /// Largest height error of the settled top layer, mm.
        settle_error_mm: f64,
    },
    /// Once a simulated second: a digest of bodies, arm, gripper and counters.
    StateHash {
        /// 16 hexadecimal digits.
        hash: String,
    },
    /// A message on the wire, decoded.
    Protocol {
        /// `robot` or `vision`: who sent it.
        from: &'static str,
        /// Command number.
        command: i32,
        /// Status code of a reply.
        status: Option<i32>,
        /// Decoded text.
        text: String,
    },
    /// The program pointer moved to another line.
    ProgramLine {
        /// Module.
        module: String,
        /// Routine.
        routine: String,
        /// Line, from 1.
        line: u32,
    },
    /// A line for the operator or the event log.
    Message {
        /// The text.
        text: String,
    },
    /// A signal changed.
    Signal {
        /// Name.
        name: String,
        /// New value.
        value: f64,
    },
    /// A move began.
    MoveStarted {
        /// The instruction's module.
        module: String,
        /// The instruction's line.
        line: u32,
    },
    /// A move that should have been blended became a stop point.
    CornerPathFailure {
        /// The instruction's module.
        module: String,
        /// The instruction's line.
        line: u32,
    },
    /// The camera was triggered.
    Exposure {
        /// Frame counter, from 1.
        frame: u32,
    },
    /// Vision finished a frame.
    Vision {
        /// Frame counter.
        frame: u32,
        /// What it reported, and how far from the truth.
        detections: Vec<LoggedDetection>,
        /// True cartons that should have been found and were not.
        missed: Vec<u32>,
        /// How many should have been found.
        pickable: usize,
    },
    /// Command 701 came to a new camera pose, which all later pictures go through.
    Calibrated {
        /// Where a camera that stands still is in the robot base.
        #[serde(skip_serializing_if = "Option::is_none")]
        base_from_camera: Option<LoggedPose>,
        /// Where a camera on the flange is there.
        #[serde(skip_serializing_if = "Option::is_none")]
        flange_from_camera: Option<LoggedPose>,
        /// Root mean square distance of the disc centres from their places, mm.
        residual_rms_mm: f64,
        /// The largest, mm.
        residual_max_mm: f64,
        /// Pictures that were used.
        used: usize,
        /// Pictures that were taken.
        taken: usize,
        /// Distance of the camera from where it truly is, mm.
        error_mm: f64,
        /// Angle between its frame and the true one, degrees.
        error_deg: f64,
    },
    /// A path was planned.
    Plan {
        /// Index of the picked detection in the frame's list; of a group its first.
        detection: usize,
        /// Indices of all detections that are picked together.
        detections: Vec<usize>,
        /// The path.
        waypoints: Vec<LoggedWaypoint>,
        /// 0-based index of the Vision Move.
        pick_index: usize,
        /// Gripper sections to switch on, from 0.
        sections: Vec<usize>,
        /// Least distance to anything along the path, mm.
        min_clearance_mm: f64,
        /// Motion time from rest to rest, s.
        estimated_s: f64,
        /// Candidates that were turned down before, with the reason.
        rejected: Vec<String>,
    },
    /// No path could be planned.
    PlanRefused {
        /// The reason of each candidate, in words.
        reasons: Vec<String>,
    },
    /// The vacuum was switched on for a pick.
    PickStarted {
        /// Pick counter, from 1.
        pick: u32,
        /// Sections switched on.
        sections: Vec<usize>,
        /// The carton that the plan aimed at, by truth; of a group its first.
        target: Option<u32>,
        /// All cartons that the plan aimed at, by truth.
        targets: Vec<u32>,
    },
    /// The vacuum switch closed.
    VacuumReached {
        /// Pick counter.
        pick: u32,
    },
    /// A carton hangs on the gripper.
    Gripped {
        /// Pick counter.
        pick: u32,
        /// Carton.
        carton: u32,
    },
    /// A carton was lost by the gripper.
    GripLost {
        /// Pick counter.
        pick: u32,
        /// Carton.
        carton: u32,
        /// Why.
        reason: FailureReason,
        /// Numbers in words.
        detail: String,
    },
    /// A pick is over.
    PickFinished {
        /// Pick counter.
        pick: u32,
        /// Carton, if one was held; of several the first.
        carton: Option<u32>,
        /// All cartons that were held.
        cartons: Vec<u32>,
        /// `None` = success.
        reason: Option<FailureReason>,
        /// In words.
        detail: String,
        /// Time since the pick before was finished, s.
        cycle_s: f64,
    },
    /// A carton left the cell on the conveyor.
    Delivered {
        /// Carton.
        carton: u32,
    },
    /// A carton stands on its place of a pattern.
    Placed {
        /// Carton.
        carton: u32,
        /// Distance of the middle of its bottom from the place, mm.
        error_mm: f64,
        /// Angle between its long side and the place's, degrees, half turns left out.
        error_deg: f64,
    },
    /// A carton lies where it should not.
    Lost {
        /// Carton.
        carton: u32,
        /// Why.
        reason: FailureReason,
        /// In words.
        detail: String,
    },
    /// Something was hit.
    Collision {
        /// First body.
        a: String,
        /// Second body.
        b: String,
        /// Contact force, N.
        force_n: f64,
    },
    /// Cartons that nobody touched on purpose have moved.
    NeighbourMoved {
        /// Carton.
        carton: u32,
        /// How far, mm.
        distance_mm: f64,
    },
    /// Last event.
    RunEnded {
        /// `finished`, `stopped`, `failed` or `time_limit`.
        state: &'static str,
        /// In words.
        detail: String,
    },
}
