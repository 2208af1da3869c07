use depal_frames::MAX_JOINTS;

/// Why a description was refused. Every message names the file and the element.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArmError {
    /// Not XML, or not URDF.
    #[error("{file}: not a readable URDF: {reason}")]
    Unreadable {
        /// Name of the source.
        file: String,
        /// What the reader said.
        reason: String,
    },
    /// Two elements of one kind share a name.
    #[error("{file}: {element} is defined twice")]
    Duplicate {
        /// Name of the source.
        file: String,
        /// Kind and name.
        element: String,
    },
    /// A joint names a link that does not exist.
    #[error("{file}: joint '{joint}': {role} link '{link}' does not exist")]
    UnknownLink {
        /// Name of the source.
        file: String,
        /// The joint.
        joint: String,
        /// `parent` or `child`.
        role: &'static str,
        /// The missing link.
        link: String,
    },
    /// Following the joints leads back to the same link.
    #[error("{file}: the joints form a cycle through link '{link}'; expected a tree")]
    Cycle {
        /// Name of the source.
        file: String,
        /// A link on the cycle.
        link: String,
    },
    /// A link is the child of two joints.
    #[error(
        "{file}: link '{link}' is the child of both joint '{first}' and joint '{second}'; expected one parent"
    )]
    TwoParents {
        /// Name of the source.
        file: String,
        /// The link.
        link: String,
        /// Its first joint in the file.
        first: String,
        /// Its second joint in the file.
        second: String,
    },
    /// More than one link has no parent.
    #[error(
        "{file}: {} root links ({}); expected one, a joint is missing",
        roots.len(), roots.join(", ")
    )]
    ManyRoots {
        /// Name of the source.
        file: String,
        /// Links without parent, in file order.
        roots: Vec<String>,
    },
    /// NaN or infinity.
    #[error("{file}: {element}: {value} is not a finite number")]
    NotFinite {
        /// Name of the source.
        file: String,
        /// Kind, name and attribute.
        element: String,
        /// As it was read.
        value: f64,
    },
    /// A revolute joint without `<limit>`.
    #[error(
        "{file}: joint '{joint}': <limit> is missing; expected lower, upper (rad) and velocity (rad/s)"
    )]
    MissingLimit {
        /// Name of the source.
        file: String,
        /// The joint.
        joint: String,
    },
    /// Limits the wrong way round, or empty.
    #[error("{file}: joint '{joint}' <limit>: lower {lower} rad is not below upper {upper} rad")]
    LimitOrder {
        /// Name of the source.
        file: String,
        /// The joint.
        joint: String,
        /// Radians.
        lower: f64,
        /// Radians.
        upper: f64,
    },
    /// A length, mass, speed or acceleration must be positive.
    #[error("{file}: {element}: {value} found, expected a positive value")]
    NotPositive {
        /// Name of the source.
        file: String,
        /// Kind, name and attribute.
        element: String,
        /// SI.
        value: f64,
    },
    /// `<axis xyz="0 0 0"/>`.
    #[error("{file}: joint '{joint}' <axis>: the zero vector has no direction")]
    ZeroAxis {
        /// Name of the source.
        file: String,
        /// The joint.
        joint: String,
    },
    /// Joints that this crate cannot move.
    #[error(
        "{file}: joint '{joint}': {what} is not supported; expected revolute, continuous or fixed"
    )]
    UnsupportedJoint {
        /// Name of the source.
        file: String,
        /// The joint.
        joint: String,
        /// What it is.
        what: String,
    },
    /// No joint between base and flange, or more than can be held.
    #[error(
        "{file}: chain from '{base}' to '{tip}': {found} joints, expected 1 to {MAX_JOINTS} revolute or continuous ones"
    )]
    JointCount {
        /// Name of the source.
        file: String,
        /// Root link.
        base: String,
        /// Flange link.
        tip: String,
        /// On the chain, without mimics.
        found: usize,
    },
    /// A mimic joint follows a joint that does not exist.
    #[error("{file}: joint '{joint}' <mimic>: joint '{master}' does not exist")]
    UnknownMimic {
        /// Name of the source.
        file: String,
        /// The joint.
        joint: String,
        /// The missing one.
        master: String,
    },
    /// Mimics follow each other in a ring, or one itself.
    #[error("{file}: joint '{joint}' <mimic>: it follows itself in the end")]
    MimicLoop {
        /// Name of the source.
        file: String,
        /// The joint.
        joint: String,
    },
    /// The list of accelerations does not fit.
    #[error("{file}: {found} joint accelerations given, expected {expected}")]
    AccelerationCount {
        /// Name of the source.
        file: String,
        /// Given.
        found: usize,
        /// Joints of the arm.
        expected: usize,
    },
    /// Two independent computations of the flange pose differ.
    #[error(
        "{file}: forward kinematics differ by {error_m:e} m and {error_rad:e} rad from {oracle} at joints {joints:?} rad; allowed 1e-9 m and 1e-7 rad"
    )]
    ForwardMismatch {
        /// Name of the source.
        file: String,
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

/// What was left out of a description that is otherwise good.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArmWarning {
    /// Mesh files are not read: no source of them was given, or the mesh is only to look at.
    #[error(
        "link '{link}' <{element}>: mesh '{mesh}' is not read; the link has no such body there"
    )]
    MeshSkipped {
        /// The link.
        link: String,
        /// `visual` or `collision`.
        element: &'static str,
        /// The file it names.
        mesh: String,
    },
    /// A mesh file could not be used.
    #[error("link '{link}' <{element}>: mesh '{mesh}': {reason}; the link has no such body there")]
    MeshUnread {
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
    #[error("joint '{joint}' is not on the way to the flange: it stays at zero")]
    JointFrozen {
        /// The joint.
        joint: String,
    },
    /// No closed form fits.
    #[error("inverse kinematics is numeric, because {reason}")]
    NumericInverse {
        /// Why, with the joint.
        reason: String,
    },
}
