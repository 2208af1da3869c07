use depal_frames::{BoxSize, PlacedShape, Pose, Vector};
use depal_time::{SimDuration, TICK};

/// What stands in the cell from the start, and how the physics is solved.
#[derive(Debug, Clone, PartialEq)]
pub struct WorldSpec {
    /// Length of one [`World::step`](crate::World::step).
    pub timestep: SimDuration,
    /// Parts of a step in which contacts and, near the cups, cup forces are solved.
    pub substeps: usize,
    /// Acceleration of gravity in the world frame, m/s2.
    pub gravity: Vector,
    /// Natural frequency of contacts between moving bodies, Hz.
    ///
    /// It decides how far a stack sinks into itself: 30 Hz (the engine's own value) lets five
    /// layers sink by 10 mm, 120 Hz by 0.7 mm.
    pub contact_frequency: f64,
    /// The same for contacts with fixed bodies, Hz.
    pub fixed_contact_frequency: f64,
    /// Coefficient of friction of arm links and tool bodies.
    pub arm_friction: f64,
    /// Limit of contact forces on arm links and tool bodies, N.
    pub collision_force: f64,
    /// Limit of lateral contact forces on a held carton, N. The cups pass on no more than their
    /// friction holds: some 500 N with 24 sealed cups of 44 N.
    pub held_collision_force: f64,
    /// Limit of forces along the tool's axis, N: of the cups on a carton, and of a held carton
    /// on what is below it. Transport cartons bear some 2 to 5 kN on their top.
    pub crush_force: f64,
    /// A force above its limit for at least this long is a collision.
    pub collision_span: SimDuration,
    /// Floor, pallet, fences.
    pub fixed: Vec<FixedBody>,
    /// Belts.
    pub conveyors: Vec<ConveyorSpec>,
    /// Radius of the cartons' edges as a camera sees them, m. Contacts are those of sharp boxes: a carton
    /// rests on its faces, and a fold gives way where a rounded solid would not.
    pub carton_edge_radius: f64,
}

impl Default for WorldSpec {
    /// An empty world: 4 ms steps of four parts, contacts at 120 and 240 Hz, cartons with sharp edges,
    /// a collision is 500 N on the arm, 250 N on a held carton or 2 kN downwards, for 20 ms.
    fn default() -> Self {
        Self {
            timestep: TICK,
            substeps: 4,
            gravity: Vector::new(0.0, 0.0, -9.81),
            contact_frequency: 120.0,
            fixed_contact_frequency: 240.0,
            arm_friction: 0.3,
            collision_force: 500.0,
            held_collision_force: 250.0,
            crush_force: 2_000.0,
            collision_span: SimDuration::from_millis(20),
            fixed: Vec::new(),
            conveyors: Vec::new(),
            carton_edge_radius: 0.0,
        }
    }
}

/// Something that never moves.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedBody {
    /// Name for messages and the replay.
    pub name: String,
    /// Its solids in the world frame.
    pub shapes: Vec<PlacedShape>,
    /// Coefficient of friction; with a carton the mean of both counts.
    pub friction: f64,
    /// A carton that touches it is lost: the floor.
    pub is_floor: bool,
}

impl FixedBody {
    /// Something that stands in the cell, wood or steel on cardboard (friction 0.5).
    pub fn standing(name: &str, shapes: Vec<PlacedShape>) -> Self {
        Self {
            name: name.to_owned(),
            shapes,
            friction: 0.5,
            is_floor: false,
        }
    }

    /// The floor of the cell: a carton that touches it is lost.
    pub fn floor(shapes: Vec<PlacedShape>) -> Self {
        Self {
            is_floor: true,
            ..Self::standing("floor", shapes)
        }
    }
}

/// A belt that runs all the time.
#[derive(Debug, Clone, PartialEq)]
pub struct ConveyorSpec {
    /// Name for messages and the replay.
    pub name: String,
    /// Its solid in the world frame; all of its surface moves.
    pub belt: PlacedShape,
    /// Direction of travel in the world frame; its length does not matter.
    pub direction: Vector,
    /// Speed of the belt, m/s.
    pub speed: f64,
    /// A carton is delivered when its centre is this far from the belt's middle, along
    /// `direction`, m.
    pub delivered_at: f64,
    /// Coefficient of friction; with a carton the mean of both counts.
    pub friction: f64,
}

/// A carton as it is put into the world.
#[derive(Debug, Clone, PartialEq)]
pub struct CartonSpec {
    /// Outer size.
    pub size: BoxSize,
    /// Mass, kg, spread evenly.
    pub mass: f64,
    /// Pose of the geometric centre: X along the length, Y the width, Z the height.
    pub world_from_centre: Pose,
    /// Coefficient of friction.
    pub friction: f64,
}

/// Number of a carton, counted from 1 in the order in which cartons were added; never reused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CartonId(pub u32);
