use depal_frames::convert::{from_glam, to_glam, vector_from_glam};
use depal_frames::{BoxSize, PlacedShape, Point, Pose, Vector};
use rapier3d::prelude::{ColliderHandle, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle};

use crate::engine::{Owner, collider};
use crate::{CartonId, CartonSpec};

/// Where a carton is and how it moves.
#[derive(Debug, Clone, PartialEq)]
pub struct CartonState {
    /// Its number.
    pub id: CartonId,
    /// Outer size.
    pub size: BoxSize,
    /// Mass, kg.
    pub mass: f64,
    /// Pose of the geometric centre.
    pub world_from_centre: Pose,
    /// Velocity of the centre in the world frame, m/s.
    pub linear_velocity: Vector,
    /// Angular velocity in the world frame, rad/s.
    pub angular_velocity: Vector,
}

/// A carton in the engine, with what the watch remembers of it.
pub(crate) struct Carton {
    pub size: BoxSize,
    pub mass: f64,
    pub body: RigidBodyHandle,
    pub collider: ColliderHandle,
    /// Where it last lay still.
    pub rest: Point,
    /// A disturbance was reported, or is expected, until it lies still again.
    pub disturbed: bool,
    /// Steps in a row in which it lay still since it was disturbed or let go.
    pub still_steps: u32,
    /// On a belt in the latest step.
    pub on_belt: bool,
    pub touched_belt: bool,
    pub delivered: bool,
    pub on_floor: bool,
}

impl Carton {
    pub fn insert(physics: &mut PhysicsWorld, id: CartonId, spec: &CartonSpec) -> Self {
        let solid = PlacedShape::cuboid(Pose::identity(), spec.size.half_extents() * 2.0);
        let (body, collider) = physics.insert(
            RigidBodyBuilder::dynamic().pose(to_glam(&spec.world_from_centre)),
            collider(&solid, Owner::Carton(id.0), spec.friction).mass(spec.mass as f32),
        );
        Self {
            size: spec.size,
            mass: spec.mass,
            body,
            collider,
            rest: Point::from(spec.world_from_centre.translation.vector),
            disturbed: false,
            still_steps: 0,
            on_belt: false,
            touched_belt: false,
            delivered: false,
            on_floor: false,
        }
    }

    pub fn state(&self, physics: &PhysicsWorld, id: CartonId) -> CartonState {
        let body = &physics.bodies[self.body];
        CartonState {
            id,
            size: self.size,
            mass: self.mass,
            world_from_centre: from_glam(body.position()),
            linear_velocity: vector_from_glam(body.linvel()),
            angular_velocity: vector_from_glam(body.angvel()),
        }
    }
}
