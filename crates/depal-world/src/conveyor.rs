use depal_frames::convert::vector_to_glam;
use rapier3d::prelude::*;

use crate::ConveyorSpec;
use crate::engine::Owner;

/// Lets the surfaces of conveyors run: the engine's hook for contacts.
pub(crate) struct Belts {
    velocities: Vec<Vector>,
}

impl Belts {
    pub fn new(conveyors: &[ConveyorSpec]) -> Self {
        let velocity = |conveyor: &ConveyorSpec| {
            let length = conveyor.direction.norm();
            let direction = if length > 0.0 {
                conveyor.direction / length
            } else {
                conveyor.direction
            };
            vector_to_glam(&(direction * conveyor.speed))
        };
        Self {
            velocities: conveyors.iter().map(velocity).collect(),
        }
    }

    fn velocity(&self, colliders: &ColliderSet, handle: ColliderHandle) -> Vector {
        match colliders.get(handle).map(|c| Owner::decode(c.user_data)) {
            Some(Owner::Conveyor(index)) => self.velocities[index as usize],
            _ => Vector::ZERO,
        }
    }
}

impl PhysicsHooks for Belts {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let first = self.velocity(context.colliders, context.collider1);
        let second = self.velocity(context.colliders, context.collider2);
        // The solver brings `v1 - v2 + tangent_velocity` to zero; a belt's own body rests.
        let surface = first - second;
        if let Some(manifold) = context.rigid_mut() {
            for contact in manifold.solver_contacts.iter_mut() {
                contact.tangent_velocity = surface;
            }
        }
    }
}
