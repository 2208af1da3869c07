use depal_frames::MAX_JOINTS;

use crate::Place;

/// Why a description was refused. Every message names the file and the element.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArmError {
    /// Not XML, or not URDF.
    #[error("{at}: not a readable URDF: {reason}")]
    Unreadable {
        /// Where it stands.
        at: Place,
        /// What the reader said.
        reason: String,
    },
    /// A tag without what it needs, or with an attribute that cannot be read.
    #[error("{at}: {element}: {reason}")]
    Malformed {
        /// Where it stands.
        at: Place,
        /// Kind, name and tag.
        element: String,
        /// Expected and found.
        reason: String,
    },
    /// Two elements of one kind share a name.
    #[error("{at}: {element} is defined twice, first in line {first}; names must differ")]
    Duplicate {
        /// Where it stands.
        at: Place,
        /// Kind and name.
        element: String,
        /// Line of the first one.
        first: usize,
    },
    /// A joint names a link that does not exist.
    #[error(
        "{at}: joint '{joint}': {role} link '{link}' does not exist; expected the name of a <link> of this file"
    )]
    UnknownLink {
        /// Where it stands.
        at: Place,
        /// The joint.
        joint: String,
        /// `parent` or `child`.
        role: &'static str,
        /// The missing link.
        link: String,
    },
    /// Following the joints leads back to the same link.
    #[error("{at}: the joints form a cycle through link '{link}'; expected a tree")]
    Cycle {
        /// Where it stands.
        at: Place,
        /// A link on the cycle.
        link: String,
    },
    /// A link is the child of two joints.
    #[error(
        "{at}: link '{link}' is the child of both joint '{first}' and joint '{second}'; expected one parent"
    )]
    TwoParents {
        /// Where it stands.
        at: Place,
        /// The link.
        link: String,
        /// Its first joint in the file.
        first: String,
        /// Its second joint in the file.
        second: String,
    },
    /// More than one link has no parent.
    #[error(
        "{at}: {} root links ({}); expected one: a joint is missing, a fixed one for instance",
        roots.len(), roots.join(", ")
    )]
    ManyRoots {
        /// Where it stands.
        at: Place,
        /// Links without parent, in file order.
        roots: Vec<String>,
    },
    /// NaN or infinity.
    #[error("{at}: {element}: {value} is not a finite number; expected a number")]
    NotFinite {
        /// Where it stands.
        at: Place,
        /// Kind, name and attribute.
        element: String,
        /// As it was read.
        value: f64,
    },
    /// A revolute joint without `<limit>`.
    #[error(
        "{at}: joint '{joint}': <limit> is missing; expected lower, upper (rad) and velocity (rad/s)"
    )]
    MissingLimit {
        /// Where it stands.
        at: Place,
        /// The joint.
        joint: String,
    },
    /// Limits the wrong way round, or empty.
    #[error(
        "{at}: joint '{joint}' <limit>: lower {lower} rad is not below upper {upper} rad; swap or widen them"
    )]
    LimitOrder {
        /// Where it stands.
        at: Place,
        /// The joint.
        joint: String,
        /// Radians.
        lower: f64,
        /// Radians.
        upper: f64,
    },
    /// Limits beyond many turns.
    #[error(
        "{at}: joint '{joint}' <limit>: {lower} to {upper} rad is many turns; limits are radians, not degrees ({upper} degrees are {:.4} rad)",
        upper.to_radians()
    )]
    LimitInDegrees {
        /// Where it stands.
        at: Place,
        /// The joint.
        joint: String,
        /// As it was read.
        lower: f64,
        /// As it was read.
        upper: f64,
    },
    /// A length that no arm has.
    #[error(
        "{at}: {element}: {length:.0} m long, expected at most {most} m; lengths are metres{hint}"
    )]
    TooLong {
        /// Where it stands.
        at: Place,
        /// Kind, name and attribute.
        element: String,
        /// Metres.
        length: f64,
        /// Metres.
        most: f64,
        /// What to write instead, or nothing.
        hint: &'static str,
    },
    /// A length, mass, speed or acceleration must be positive.
    #[error("{at}: {element}: {value} found, expected a positive value")]
    NotPositive {
        /// Where it stands.
        at: Place,
        /// Kind, name and attribute.
        element: String,
        /// SI.
        value: f64,
    },
    /// `<axis xyz="0 0 0"/>`.
    #[error(
        "{at}: joint '{joint}' <axis>: the zero vector has no direction; expected for instance xyz=\"0 0 1\""
    )]
    ZeroAxis {
        /// Where it stands.
        at: Place,
        /// The joint.
        joint: String,
    },
    /// Joints that this crate cannot move.
    #[error(
        "{at}: joint '{joint}': {what} is not supported; expected revolute, continuous or fixed"
    )]
    UnsupportedJoint {
        /// Where it stands.
        at: Place,
        /// The joint.
        joint: String,
        /// What it is.
        what: String,
    },
    /// No joint between base and flange, or more than can be held.
    #[error(
        "{at}: chain from '{base}' to '{tip}': {found} joints, expected 1 to {MAX_JOINTS} revolute or continuous ones"
    )]
    JointCount {
        /// Where it stands.
        at: Place,
        /// Root link.
        base: String,
        /// Flange link.
        tip: String,
        /// On the chain, without mimics.
        found: usize,
    },
    /// A mimic joint follows a joint that does not exist.
    #[error(
        "{at}: joint '{joint}' <mimic>: joint '{master}' does not exist; expected the name of a <joint> of this file"
    )]
    UnknownMimic {
        /// Where it stands.
        at: Place,
        /// The joint.
        joint: String,
        /// The missing one.
        master: String,
    },
    /// Mimics follow each other in a ring, or one itself.
    #[error(
        "{at}: joint '{joint}' <mimic>: it follows itself in the end; expected one that leads to a joint without <mimic>"
    )]
    MimicLoop {
        /// Where it stands.
        at: Place,
        /// The joint.
        joint: String,
    },
    /// The list of accelerations does not fit.
    #[error("{at}: {found} joint accelerations given, expected {expected}")]
    AccelerationCount {
        /// Where it stands.
        at: Place,
        /// Given.
        found: usize,
        /// Joints of the arm.
        expected: usize,
    },
    /// Two independent computations of the flange pose differ.
    #[error(
        "{at}: forward kinematics differ by {error_m:e} m and {error_rad:e} rad from {oracle} at joints {joints:?} rad; allowed 1e-9 m and 1e-7 rad"
    )]
    ForwardMismatch {
        /// Where it stands.
        at: Place,
        /// Which other computation.
        oracle: &'static str,
        /// Metres.
        error_m: f64,
        /// Radians.
        error_rad: f64,
        /// Radians.
        joints: Vec<f64>,
    },
}

impl ArmError {
    /// Where the fault stands.
    pub fn place(&self) -> &Place {
        match self {
            Self::Unreadable { at, .. }
            | Self::Malformed { at, .. }
            | Self::Duplicate { at, .. }
            | Self::UnknownLink { at, .. }
            | Self::Cycle { at, .. }
            | Self::TwoParents { at, .. }
            | Self::ManyRoots { at, .. }
            | Self::NotFinite { at, .. }
            | Self::MissingLimit { at, .. }
            | Self::LimitOrder { at, .. }
            | Self::LimitInDegrees { at, .. }
            | Self::TooLong { at, .. }
            | Self::NotPositive { at, .. }
            | Self::ZeroAxis { at, .. }
            | Self::UnsupportedJoint { at, .. }
            | Self::JointCount { at, .. }
            | Self::UnknownMimic { at, .. }
            | Self::MimicLoop { at, .. }
            | Self::AccelerationCount { at, .. }
            | Self::ForwardMismatch { at, .. } => at,
        }
    }
}

/// What was left out of a description that is otherwise good.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArmWarning {
    /// Mesh files are not read: no source of them was given, or the mesh is only to look at.
    #[error(
        "{at}: link '{link}' <{element}>: mesh '{mesh}' is not read; the link has no such body there"
    )]
    MeshSkipped {
        /// Where it stands.
        at: Place,
        /// The link.
        link: String,
        /// `visual` or `collision`.
        element: &'static str,
        /// The file it names.
        mesh: String,
    },
    /// A mesh file could not be used.
    #[error(
        "{at}: link '{link}' <{element}>: mesh '{mesh}': {reason}; the link has no such body there"
    )]
    MeshUnread {
        /// Where it stands.
        at: Place,
        /// The link.
        link: String,
        /// `visual` or `collision`.
        element: &'static str,
        /// The file it names.
        mesh: String,
        /// Not found, or not readable.
        reason: String,
    },
    /// A movable joint beside the chain to the flange.
    #[error("{at}: joint '{joint}' is not on the way to the flange: it stays at zero")]
    JointFrozen {
        /// Where it stands.
        at: Place,
        /// The joint.
        joint: String,
    },
    /// No closed form fits.
    #[error("{at}: inverse kinematics is numeric, because {reason}")]
    NumericInverse {
        /// The joint that no closed form knows.
        at: Place,
        /// Why, with the joint.
        reason: String,
    },
}

impl ArmWarning {
    /// Where it stands.
    pub fn place(&self) -> &Place {
        match self {
            Self::MeshSkipped { at, .. }
            | Self::MeshUnread { at, .. }
            | Self::JointFrozen { at, .. }
            | Self::NumericInverse { at, .. } => at,
        }
    }
}
