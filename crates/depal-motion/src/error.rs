use thiserror::Error;

/// Why a move cannot be made. Nothing of the path changes when one of these is returned.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MotionError {
    /// A joint target lies outside a limit.
    #[error(
        "joint {joint} would be at {found_deg:.2} deg, its limits are {lower_deg:.2} to {upper_deg:.2} deg"
    )]
    JointLimit {
        /// From 1.
        joint: usize,
        /// Where the joint would be, degrees.
        found_deg: f64,
        /// Lower limit, degrees.
        lower_deg: f64,
        /// Upper limit, degrees.
        upper_deg: f64,
    },
    /// A target has a different number of joints than the arm.
    #[error("target with {found} joints, the arm has {expected}")]
    JointCount {
        /// Joints of the arm.
        expected: usize,
        /// Joints of the target.
        found: usize,
    },
    /// No inverse solution at the target.
    #[error(
        "no joint positions reach the target: TCP at x {x_mm:.1}, y {y_mm:.1}, z {z_mm:.1} mm in the robot base"
    )]
    TargetOutOfReach {
        /// Target, mm.
        x_mm: f64,
        /// Target, mm.
        y_mm: f64,
        /// Target, mm.
        z_mm: f64,
    },
    /// No inverse solution on the way of a linear move.
    #[error(
        "the straight or circular way leaves the reach or the joint limits after {travelled_mm:.1} of {length_mm:.1} mm, TCP at x {x_mm:.1}, y {y_mm:.1}, z {z_mm:.1} mm in the robot base"
    )]
    LineOutOfReach {
        /// Distance from the start of the line, mm.
        travelled_mm: f64,
        /// Length of the line, mm.
        length_mm: f64,
        /// There, mm.
        x_mm: f64,
        /// There, mm.
        y_mm: f64,
        /// There, mm.
        z_mm: f64,
    },
    /// The joints would have to jump on the way of a linear move: a singularity, or another arm configuration.
    #[error(
        "joint {joint} would jump by {jump_deg:.1} deg after {travelled_mm:.1} of {length_mm:.1} mm of the way (singularity or change of arm configuration); use a joint move"
    )]
    LineJumps {
        /// From 1.
        joint: usize,
        /// Jump between neighbouring grid points, degrees.
        jump_deg: f64,
        /// Distance from the start of the line, mm.
        travelled_mm: f64,
        /// Length of the line, mm.
        length_mm: f64,
    },
    /// The three points of an arc are too near to each other, or in line.
    #[error(
        "no arc goes through these three points: the nearest two are {shortest_mm:.3} mm apart (at least 0.1), the angle at the start is {angle_deg:.2} deg (at least 1)"
    )]
    NoCircle {
        /// Shortest distance between two of them, mm.
        shortest_mm: f64,
        /// Angle at the start between the way to the point between and to the end, degrees.
        angle_deg: f64,
    },
    /// The target can be reached, but not with its arm configuration.
    #[error(
        "the target cannot be reached in its configuration: joint {joint} would be at {found_deg:.2} deg, expected in quarter {quarter} ({lower} to {upper} deg)", lower = quarter * 90, upper = quarter * 90 + 90
    )]
    Configuration {
        /// From 1.
        joint: usize,
        /// Where the joint would be, degrees.
        found_deg: f64,
        /// The quarter turn that the target asks for; 0 is 0 to 90 degrees.
        quarter: i32,
    },
    /// A speed or fraction is not a positive number.
    #[error("{quantity} is {found}, expected a positive number")]
    Speed {
        /// Which one.
        quantity: &'static str,
        /// As given.
        found: f64,
    },
    /// An axis could hardly hold the arm and its load on the way, let alone move it.
    #[error(
        "joint {joint} needs {needed_nm:.1} N m to hold the arm with a load of {load_kg:.1} kg at its flange, and may use {usable_nm:.1} for it"
    )]
    Overload {
        /// From 1.
        joint: usize,
        /// Torque to stand still there, N m.
        needed_nm: f64,
        /// 98 % of the axis's torque limit, N m.
        usable_nm: f64,
        /// Mass of the load, kg.
        load_kg: f64,
    },
}
