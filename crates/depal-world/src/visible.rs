use depal_frames::convert::from_glam;
use depal_frames::{PlacedShape, Pose};

use crate::{CartonId, World};

/// First id of shapes that are not cartons.
const SCENERY: u32 = 0x8000_0000;

/// A solid that a camera can see, in the world frame.
#[derive(Debug, Clone, PartialEq)]
pub struct VisibleShape {
    /// The carton's number, or a number from 0x8000_0000 up that is fixed for every other body.
    pub id: u32,
    /// What it is.
    pub kind: VisibleKind,
    /// Pose in the world frame, and solid.
    pub shape: PlacedShape,
    /// Radius of a box's edges, m; 0 = sharp.
    pub edge_radius: f64,
}

/// What a visible solid belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VisibleKind {
    /// A carton.
    Carton(CartonId),
    /// A fixed body: its index in the world's specification.
    Fixed(usize),
    /// A belt: its index in the world's specification.
    Conveyor(usize),
    /// An arm link: its index in the chain.
    Link(usize),
    /// The tool.
    Tool,
}

impl World {
    /// Every solid with its pose of this instant: cartons by id, fixed bodies, belts, arm, tool.
    ///
    /// Cups are not among them: they are no solids here. An arm that was never placed is absent.
    pub fn visible_shapes(&self) -> Vec<VisibleShape> {
        let mut shapes: Vec<_> = self
            .cartons()
            .into_iter()
            .map(|carton| VisibleShape {
                id: carton.id.0,
                kind: VisibleKind::Carton(carton.id),
                shape: PlacedShape::cuboid(
                    carton.world_from_centre,
                    carton.size.half_extents() * 2.0,
                ),
                edge_radius: self.spec.carton_edge_radius,
            })
            .collect();
        let mut next = SCENERY;
        let mut add = |kind, pose: &Pose, solids: &[PlacedShape]| {
            for solid in solids {
                let shape = solid.moved(pose);
                shapes.push(VisibleShape {
                    id: next,
                    kind,
                    shape,
                    edge_radius: 0.0,
                });
            }
            next += 1;
        };
        for (index, body) in self.spec.fixed.iter().enumerate() {
            add(VisibleKind::Fixed(index), &Pose::identity(), &body.shapes);
        }
        for (index, conveyor) in self.spec.conveyors.iter().enumerate() {
            let belt = std::slice::from_ref(&conveyor.belt);
            add(VisibleKind::Conveyor(index), &Pose::identity(), belt);
        }
        if let Some(arm) = self.arm.as_ref().filter(|arm| arm.is_placed()) {
            for (index, follower) in arm.followers().enumerate() {
                let kind = if index < arm.names.len() {
                    VisibleKind::Link(index)
                } else {
                    VisibleKind::Tool
                };
                add(kind, &follower.pose(&self.physics), &follower.shapes);
            }
        }
        shapes
    }

    /// Bits of all that moves: carton poses and velocities, section pressures.
    pub fn state_hash(&self) -> u64 {
        let mut hash = crate::state_hash::StateHash::new();
        for (&id, carton) in &self.cartons {
            let body = &self.physics.bodies[carton.body];
            let pose = from_glam(body.position());
            hash.word(u64::from(id));
            pose.translation.vector.iter().for_each(|&v| hash.value(v));
            pose.rotation.coords.iter().for_each(|&v| hash.value(v));
            let state = carton.state(&self.physics, CartonId(id));
            state.linear_velocity.iter().for_each(|&v| hash.value(v));
            state.angular_velocity.iter().for_each(|&v| hash.value(v));
        }
        if let Some(arm) = &self.arm {
            for section in 0..arm.gripper.sections.len() {
                hash.value(arm.state.section_vacuum(section));
            }
        }
        hash.finish()
    }
}
