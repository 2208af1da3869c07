//! The physics: cartons, pallet, conveyor, arm links and cup forces on rapier.
//!
//! Arm links and tool follow the poses they are given (kinematic bodies); cartons are free
//! bodies; belts drag what lies on them; the cups of the gripper act on cartons through the
//! forces of [`depal_gripper`] and through nothing else.
//! What follows from that (grips, drops, deliveries, disturbed neighbours, collisions) is
//! reported as [`WorldEvent`]s.
//!
//! The physics must never know robot programs, the planner, vision or the network, and nothing
//! of the physics library shows outside: poses are [`depal_frames::Pose`], ids are our own.
//!
//! ```
//! use depal_frames::{BoxSize, PlacedShape, Pose, Vector};
//! use depal_time::SimDuration;
//! use depal_world::{CartonSpec, FixedBody, World, WorldSpec};
//! let floor = PlacedShape::cuboid(Pose::translation(0.0, 0.0, -0.5), Vector::new(8.0, 8.0, 1.0));
//! let mut spec = WorldSpec::default();
//! spec.fixed.push(FixedBody::floor(vec![floor]));
//! let mut world = World::new(&spec);
//! let size = BoxSize { length: 0.4, width: 0.3, height: 0.25 };
//! let world_from_centre = Pose::translation(0.0, 0.0, 0.125);
//! let id = world.add_carton(&CartonSpec { size, mass: 10.0, world_from_centre, friction: 0.5 });
//! world.settle(SimDuration::from_millis(500));
//! world.step(&[]);
//! assert!((world.carton(id).unwrap().world_from_centre.translation.z - 0.125).abs() < 0.001);
//! ```
//!
//! Units: SI. Frame: `world`, Z up. Poses of cartons are of their geometric centre, which is
//! the centre of mass as well.
//!
//! Limitations: bodies are rigid, cartons do not crush or sag; the arm has infinite strength,
//! so that a collision is an event and not a stop; arm against fixed body is reported from
//! penetration, with no finite force; arm links are not checked against each other or the tool;
//! cups meet cartons only; what lies on a belt does not change the belt's speed; the physics
//! runs in f32, a resolution of half a micrometre at four metres.

mod arm;
mod cartons;
mod collision;
mod conveyor;
mod cups;
mod engine;
mod event;
mod grip_report;
mod spec;
mod state_hash;
mod visible;
mod watch;
mod world;

pub use cartons::CartonState;
pub use event::{Body, WorldEvent};
pub use spec::{CartonId, CartonSpec, ConveyorSpec, FixedBody, WorldSpec};
pub use visible::{VisibleKind, VisibleShape};
pub use world::World;

#[cfg(test)]
mod tests;
