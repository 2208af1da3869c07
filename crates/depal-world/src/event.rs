use depal_gripper::LossReason;

use crate::CartonId;

/// A body named in an event.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Body {
    /// A carton.
    Carton(CartonId),
    /// An arm link, by name.
    Link(String),
    /// The tool's solid bodies.
    Tool,
    /// The cups of the tool.
    Cups,
    /// A fixed body, by name.
    Fixed(String),
    /// A belt, by name.
    Conveyor(String),
}

/// What happened in one step.
#[derive(Debug, Clone, PartialEq)]
pub enum WorldEvent {
    /// A vacuum switch closed over sealed cups: the carton is held.
    GripStarted {
        /// The carton.
        carton: CartonId,
        /// Indices of the gripper's sections with sealed cups on it, ascending.
        sections: Vec<usize>,
    },
    /// The valves are closed and the vacuum is gone: the carton is free, as intended.
    GripReleased {
        /// The carton.
        carton: CartonId,
    },
    /// The carton came off against the valves' will, or was never held.
    GripLost {
        /// The carton.
        carton: CartonId,
        /// Why.
        reason: LossReason,
        /// Highest load on the cups in the 0.2 s before, N: the axial force plus the lateral one
        /// over the friction (load case of a level gripper), from weight and acceleration.
        load_n: f64,
        /// What the sealed cups could hold, N.
        limit_n: f64,
    },
    /// First touch of a carton with a belt.
    CartonTouchedBelt {
        /// The carton.
        carton: CartonId,
        /// Name of the conveyor.
        conveyor: String,
    },
    /// The carton's centre has passed the end of a belt. Reported once.
    CartonDelivered {
        /// The carton.
        carton: CartonId,
        /// Name of the conveyor.
        conveyor: String,
    },
    /// The carton touches the floor: lost. Reported once.
    CartonOnFloor {
        /// The carton.
        carton: CartonId,
    },
    /// A carton that is neither held nor on a belt was moved by more than 10 mm since it last
    /// lay still. Reported once per disturbance.
    NeighbourMoved {
        /// The carton.
        carton: CartonId,
        /// How far, m.
        distance: f64,
    },
    /// Arm, tool, cups or a held carton press on something with more than the limit
    /// (see [`WorldSpec`](crate::WorldSpec)).
    /// Reported when it begins; again only after the force was gone.
    Collision {
        /// The moving side.
        a: Body,
        /// What it hit.
        b: Body,
        /// Contact force, N; infinite between arm and fixed bodies, which do not give way.
        force_n: f64,
    },
}
