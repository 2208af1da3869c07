//! What is asked, and what is answered.

use depal_arm::{Arm, Load};
use depal_frames::{JointPositions, PlacedShape, Pose};

/// An arm with what it carries, among obstacles. Everything in the base frame of the arm, metres and radians.
#[derive(Debug, Clone)]
pub struct TransferScene {
    /// The arm; its limits are the limits of the motion.
    pub arm: Arm,
    /// Solids fixed to links, by the link's index in [`Arm::links`] and in its frame.
    pub attached: Vec<(usize, PlacedShape)>,
    /// What the attached solids weigh together, at the flange. It matters only to an arm with torque limits.
    pub load: Load,
    /// What stands around. Links that no joint moves are not tested against it.
    pub obstacles: Vec<PlacedShape>,
    /// Names of links that may meet, in either order. Solids of one link always may; attached ones take their link's name.
    pub allowed_pairs: Vec<(String, String)>,
    /// The link that a pose goal is meant for, by index; the flange if none.
    pub tcp_link: Option<usize>,
}

/// Where to go.
#[derive(Debug, Clone, Copy)]
pub enum TransferGoal {
    /// These joints.
    Joints(JointPositions),
    /// This pose of the tool link in the base frame, with any joints.
    Tcp(Pose),
}

/// A point of a way in joint space; the way to it is a straight line in joint space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransferWaypoint {
    /// Radians.
    pub joints: JointPositions,
    /// The corner is flown as a parabola from this far before the point to this far behind it,
    /// radians (L2 in joint space); 0 is a stop.
    pub blend: f64,
}

/// A way from rest to rest.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferPlan {
    /// First the start, last the goal.
    pub waypoints: Vec<TransferWaypoint>,
    /// Fastest time over this very way inside the limits of the arm, s: speeds and accelerations, and torques where the
    /// arm has limits for them, with the load and without it.
    pub motion_time: f64,
    /// Time of the slowest joint alone without obstacles, s; torques do not count.
    pub lower_bound: f64,
    /// Least distance of moving bodies to obstacles and of checked pairs along the way, m (unpadded bodies);
    /// 2.5 m stands for that and all beyond.
    pub min_clearance: f64,
    /// Which rung of the ladder gave it.
    pub found_by: &'static str,
}

/// No way.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferRefusal {
    /// Why, in words.
    pub reason: String,
    /// As in [`TransferPlan`]; none when the goal has no joints.
    pub lower_bound: Option<f64>,
}
