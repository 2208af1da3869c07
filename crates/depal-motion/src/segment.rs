use depal_frames::{JointPositions, Point, Pose};

use crate::MotionError;

/// How the arm gets to the target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// A straight line in joint space: all joints start and end together.
    Joint,
    /// A straight line of the TCP, or an arc if the target is one; the orientation turns evenly about one axis.
    Linear,
}

/// Where a segment ends.
#[derive(Debug, Clone, PartialEq)]
pub enum SegmentTarget {
    /// Joint positions, radians.
    Joints(JointPositions),
    /// `base_from_tcp`; the inverse solution nearest to the end of the path before is taken.
    Tcp(Pose),
    /// As `Tcp`, on the arc through a point; a joint move goes to its end.
    Arc {
        /// A point of the TCP path in the robot base, metres.
        through: Point,
        /// `base_from_tcp` at the end.
        to: Pose,
    },
}

/// Upper limits of the speed along a segment. All apply together, next to the joint limits of the arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speed {
    /// TCP, m/s. Infinite for no limit.
    pub tcp: f64,
    /// Reorientation, rad/s. Infinite for no limit.
    pub orientation: f64,
    /// Share of the joint speed limits, above 0, at most 1.
    pub joint_fraction: f64,
    /// Share of the joint acceleration limits, above 0, at most 1.
    pub acceleration_fraction: f64,
}

impl Speed {
    /// As fast as the joints allow.
    pub const UNLIMITED: Self = Self {
        tcp: f64::INFINITY,
        orientation: f64::INFINITY,
        joint_fraction: 1.0,
        acceleration_fraction: 1.0,
    };

    pub(crate) fn check(&self) -> Result<(), MotionError> {
        for (quantity, found) in [
            ("TCP speed", self.tcp),
            ("reorientation speed", self.orientation),
            ("joint speed fraction", self.joint_fraction),
            ("acceleration fraction", self.acceleration_fraction),
        ] {
            if found.is_nan() || found <= 0.0 {
                return Err(MotionError::Speed { quantity, found });
            }
        }
        Ok(())
    }
}

/// How a segment ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Zone {
    /// The arm stands still at the target.
    Fine,
    /// The path may leave for the next segment when the rest of this one is shorter than both distances.
    /// Cut to half of the shorter of the two neighbouring segments.
    Fly {
        /// TCP path length, metres.
        tcp: f64,
        /// Rest of the turn, radians.
        orientation: f64,
    },
    /// Between two joint moves the corner is flown as the parabola between the points so far before the target and so
    /// far behind it: see [`BlendedPath`](crate::BlendedPath). Beside a linear move the arm stands at the target.
    /// Two neighbouring blends together must not exceed the move between them, or the second is cut short.
    Blend {
        /// L2 in joint space, radians.
        joints: f64,
    },
}

/// One move.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Shape of the way.
    pub interpolation: Interpolation,
    /// End of the way.
    pub target: SegmentTarget,
    /// The tool whose centre point [`Speed`], [`Zone`] and linear moves are about.
    pub flange_from_tcp: Pose,
    /// Limits on top of those of the joints.
    pub speed: Speed,
    /// How it ends.
    pub zone: Zone,
    /// Quarter turns that joints 1, 4 and 6 must stand in at the end of a move to a pose (0: 0 to 90 degrees,
    /// -1: -90 to 0); `None` takes the solution nearest to the end of the path before.
    pub quarters: Option<[i32; 3]>,
}

impl Segment {
    /// A joint move at full speed that ends in a corner of this size (L2 in joint space, radians), or stops at 0.
    pub fn blended(target: JointPositions, joints: f64) -> Self {
        Self {
            interpolation: Interpolation::Joint,
            target: SegmentTarget::Joints(target),
            flange_from_tcp: Pose::identity(),
            speed: Speed::UNLIMITED,
            zone: if joints > 0.0 {
                Zone::Blend { joints }
            } else {
                Zone::Fine
            },
            quarters: None,
        }
    }
}

/// A segment of a trajectory, counted from 0 in the order of appending.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SegmentId(pub u64);
