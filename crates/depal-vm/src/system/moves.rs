//! Moves as a program asks for them, and what happens along their way.

use depal_frames::{JointPositions, Point, Pose};
use depal_time::SimDuration;

use super::{ProgramLocation, SignalCheck};

/// How the arm gets to the target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MoveKind {
    /// All joints start and end together, the path between is not a line (MoveAbsJ, MoveJ, PTP).
    Joint,
    /// The TCP travels a straight line, or the arc that the target is; the orientation turns evenly (MoveL, MoveC).
    Linear,
}

/// Where a move goes.
#[derive(Debug, Clone, PartialEq)]
pub enum MoveTarget {
    /// Joint positions, radians, URDF order.
    Joints(JointPositions),
    /// A pose of the tool centre point in the robot base. Among the inverse solutions the one
    /// nearest to the end of the move before is taken, unless the move asks for a configuration.
    Tcp(Pose),
    /// As `Tcp`, on the arc through a point.
    Arc {
        /// A point of the way in the robot base, metres.
        through: Point,
        /// The end.
        to: Pose,
    },
}

/// Programmed speed, before override.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MoveSpeed {
    /// Highest speed of the TCP, m/s.
    pub tcp: f64,
    /// Highest speed of reorientation, rad/s.
    pub orientation: f64,
    /// Share of the joint speed limits, 0..=1: 1 unless the language programs percentages.
    pub joint_fraction: f64,
    /// Share of the acceleration limits, 0..=1 (AccSet).
    pub acceleration_fraction: f64,
}

/// How a move ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MoveZone {
    /// The arm stands still at the target.
    Fine,
    /// The path may leave for the next target this far before the target.
    Fly {
        /// TCP distance, metres.
        tcp: f64,
        /// Reorientation distance, radians.
        orientation: f64,
    },
}

/// One motion instruction, language-neutral.
#[derive(Debug, Clone, PartialEq)]
pub struct MoveRequest {
    /// Joint or linear.
    pub kind: MoveKind,
    /// Where to.
    pub target: MoveTarget,
    /// How fast.
    pub speed: MoveSpeed,
    /// How it ends.
    pub zone: MoveZone,
    /// `flange_from_tcp` of the tool in use.
    pub flange_from_tcp: Pose,
    /// Quarter turns in which joints 1, 4 and 6 must stand at a pose (0: 0 to 90 degrees, -1: -90 to 0);
    /// `None` takes the nearest solution. A cabinet without an arm has none to choose from.
    pub configuration: Option<[i32; 3]>,
    /// The instruction.
    pub location: ProgramLocation,
}

/// A place along a move, by TCP path length in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PathPlace {
    /// So far before its end; the end of a fly-by move is the middle of its corner.
    BeforeEnd(f64),
    /// So far after its start.
    AfterStart(f64),
}

/// What happens at a place along a move.
#[derive(Debug, Clone, PartialEq)]
pub enum PathAction {
    /// An output is set.
    Set {
        /// The output.
        signal: String,
        /// Its new value.
        value: f64,
    },
    /// A signal is looked at, and a notice given if it is not as it must be.
    Check(SignalCheck),
    /// A notice of this name is given; programs [count](super::System::notices) them.
    Notify(String),
}

/// Something that happens when the arm passes a place of a move.
#[derive(Debug, Clone, PartialEq)]
pub struct PathEvent {
    /// Where.
    pub place: PathPlace,
    /// How long before the arm gets there.
    pub lead: SimDuration,
    /// How long after that (a delay of the output alone).
    pub delay: SimDuration,
    /// What.
    pub action: PathAction,
}
