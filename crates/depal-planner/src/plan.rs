use depal_frames::{JointPositions, PlacedShape, Pose, Vector};

use crate::refusal::Rejection;

/// How a waypoint is reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// All joints together.
    Joint,
    /// The tool centre on a straight line.
    Linear,
}

/// One point of the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Waypoint {
    /// Joint positions, rad.
    pub joints: JointPositions,
    /// Tool pose at these joints.
    pub base_from_tcp: Pose,
    /// How it is reached from the one before (from the start for the first).
    pub motion: Motion,
    /// Percent of full velocity of the move to it.
    pub velocity_percent: f64,
    /// The vacuum goes on here: the Vision Move.
    pub is_pick: bool,
}

/// A checked way from the start to the pick and on to the place.
///
/// The start itself is not among the waypoints. Pick and place are to be reached exactly; every other waypoint may be flown past
/// with a corner of up to `PlannerSettings::corner_zone`.
#[derive(Debug, Clone, PartialEq)]
pub struct PickPlan {
    /// In order; the last one is the place.
    pub waypoints: Vec<Waypoint>,
    /// Index of the pick among the waypoints.
    pub pick_index: usize,
    /// Index of the box among the request's; of a group its first.
    pub box_index: usize,
    /// Indices of all boxes that are picked, ascending.
    pub box_indices: Vec<usize>,
    /// The carton or group before it is lifted: middle of the top face, Z up, X along the long side.
    pub base_from_group: Pose,
    /// Sections to switch on, ascending.
    pub sections: Vec<usize>,
    /// From the tool centre to the middle of the carton's (or the group's) top face, tool frame, m.
    pub tcp_offset: Vector,
    /// Which edge or corner of the suction field is flush with the edges of the carton or group, in the tool frame:
    /// 1 to 4 the edges at +X, +Y, -X, -Y; 5 to 8 the corners +X +Y, -X +Y, -X -Y, +X -Y; 0 none, or opposite ones.
    pub edge_corner_id: u8,
    /// Orientation of the group against the gripper's long side: 0 along it, 1 across.
    pub group_orientation: u8,
    /// Orientation of the boxes in their group: long side along the group's long side 0, across it 1. One box is its own group: 0.
    pub box_orientation: u8,
    /// Length, width and height of the group, m.
    pub group_size: [f64; 3],
    /// The carton or group in the tool frame while it is carried.
    pub carried: PlacedShape,
    /// Least distance of arm, gripper and (in free moves) carton to anything, m; at most 0.15, where measuring ends.
    /// The picked box itself counts as carton, and the carton's rubbing distance to its neighbours and to the supports
    /// during the straight lift and set-down does not count. Measured at single states: between them it may be smaller by
    /// a fifth and 1 mm, and it is proven to stay positive.
    pub min_clearance: f64,
    /// Time of the whole way, without waiting, s: that of the law which moves the arm, in the manner of the shipped
    /// programs (percentages of 5 m/s and 500 degrees/s, 70 % of the accelerations behind the pick, stops at pick and
    /// place, corners of 10 mm beside them and of 50 mm elsewhere), with gripper and assumed cartons for an arm with torque limits.
    pub estimated_time: f64,
    /// Boxes that come before this one in order or are unfit, and why.
    pub rejected: Vec<Rejection>,
}
