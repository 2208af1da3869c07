use depal_frames::convert::{point_to_glam, to_glam, vector_from_glam};
use depal_frames::{PlacedShape, Shape};
use rapier3d::dynamics::SpringCoefficients;
use rapier3d::prelude::*;

use crate::WorldSpec;

/// Way that a pair of bodies may go before the engine looks again where they touch, m.
///
/// Until then it keeps the contacts of the last look with their normals. Its own default of 50 mm is more than the
/// gaps between cartons: a carton lowered into one would come to stand on the edge that it had passed.
const CONTACT_REUSE: f32 = 0.001;

/// Whose collider it is; kept in the collider's `user_data`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Owner {
    Fixed(u32),
    Conveyor(u32),
    Carton(u32),
    Link(u32),
    Tool,
    /// The cups: no collider, but a party of collisions.
    Cups,
}

impl Owner {
    pub fn encode(self) -> u128 {
        let (kind, index) = match self {
            Self::Fixed(index) => (0u128, index),
            Self::Conveyor(index) => (1, index),
            Self::Carton(index) => (2, index),
            Self::Link(index) => (3, index),
            Self::Tool => (4, 0),
            Self::Cups => (5, 0),
        };
        kind << 32 | u128::from(index)
    }

    pub fn decode(user_data: u128) -> Self {
        let index = user_data as u32;
        match user_data >> 32 {
            0 => Self::Fixed(index),
            1 => Self::Conveyor(index),
            2 => Self::Carton(index),
            3 => Self::Link(index),
            4 => Self::Tool,
            _ => Self::Cups,
        }
    }

    /// Arm and tool touch cartons and the cell, never each other.
    fn groups(self) -> InteractionGroups {
        let arm = Group::GROUP_2;
        let rest = Group::GROUP_1;
        match self {
            Self::Link(_) | Self::Tool | Self::Cups => {
                InteractionGroups::new(arm, rest, InteractionTestMode::And)
            }
            _ => InteractionGroups::new(rest, rest | arm, InteractionTestMode::And),
        }
    }
}

/// A collider of `placed`, relative to its body, owned by `owner`.
pub(crate) fn collider(placed: &PlacedShape, owner: Owner, friction: f64) -> ColliderBuilder {
    // The engine's cylinders and capsules lie along Y, ours along Z.
    let upright = Pose::from_rotation(Rotation::from_rotation_x(std::f32::consts::FRAC_PI_2));
    let pose = to_glam(&placed.pose);
    let (builder, pose) = match &placed.shape {
        Shape::Cuboid { half_extents: h } => (
            ColliderBuilder::cuboid(h.x as f32, h.y as f32, h.z as f32),
            pose,
        ),
        Shape::Capsule {
            half_length,
            radius,
        } => (
            ColliderBuilder::capsule_y(*half_length as f32, *radius as f32),
            pose * upright,
        ),
        Shape::Cylinder {
            half_length,
            radius,
        } => (
            ColliderBuilder::cylinder(*half_length as f32, *radius as f32),
            pose * upright,
        ),
        Shape::Sphere { radius } => (ColliderBuilder::ball(*radius as f32), pose),
        Shape::Hull(hull) => {
            let corners: Vec<_> = hull.vertices().iter().map(point_to_glam).collect();
            let half = hull.half_extents();
            let boxed = || ColliderBuilder::cuboid(half.x as f32, half.y as f32, half.z as f32);
            (
                ColliderBuilder::convex_hull(&corners).unwrap_or_else(boxed),
                pose,
            )
        }
    };
    builder
        .position(pose)
        .friction(friction as f32)
        .restitution(0.0)
        .collision_groups(owner.groups())
        .user_data(owner.encode())
}

/// The engine with the settings of `spec`.
pub(crate) fn physics(spec: &WorldSpec) -> PhysicsWorld {
    let mut physics = PhysicsWorld::new();
    physics.gravity = depal_frames::convert::vector_to_glam(&spec.gravity);
    let parameters = &mut physics.integration_parameters;
    parameters.contact_softness = SpringCoefficients::new(spec.contact_frequency as f32, 10.0);
    parameters.static_contact_softness =
        SpringCoefficients::new(spec.fixed_contact_frequency as f32, 10.0);
    parameters.normalized_contact_recycle_distance = CONTACT_REUSE;
    physics
}

/// One contact of a pair of colliders after a step.
pub(crate) struct Touch {
    pub other: Owner,
    /// Impulse of the latest engine step, N s.
    pub impulse: f64,
    /// Deepest penetration, m; negative when apart.
    pub depth: f64,
    /// Direction of the deepest contact, world frame, either sign.
    pub normal: depal_frames::Vector,
}

/// All contacts of a collider, in the engine's (deterministic) order.
pub(crate) fn touches(physics: &PhysicsWorld, collider: ColliderHandle) -> Vec<Touch> {
    let pairs = physics.narrow_phase.contact_pairs_with(collider);
    pairs
        .filter_map(|pair| {
            let other = if pair.collider1 == collider {
                pair.collider2
            } else {
                pair.collider1
            };
            let (manifold, contact) = pair.find_deepest_contact()?;
            Some(Touch {
                other: Owner::decode(physics.colliders.get(other)?.user_data),
                impulse: f64::from(pair.total_impulse_magnitude()),
                depth: -f64::from(contact.dist),
                normal: vector_from_glam(manifold.data.normal),
            })
        })
        .collect()
}
