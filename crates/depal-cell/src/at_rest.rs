//! The world as a cell begins: nothing has moved yet.

use depal_frames::{JointPositions, Pose};
use depal_world::World;

use crate::spec::CellSpec;

impl CellSpec {
    /// Cartons settled on their pallet, the arm with its gripper standing at its start.
    pub fn world_at_rest(&self) -> World {
        let mut world = World::new(&self.world);
        for carton in &self.cartons {
            world.add_carton(carton);
        }
        let links: Vec<_> = self
            .arm
            .links()
            .iter()
            .map(|link| (link.name.clone(), link.collision.clone()))
            .collect();
        world.add_arm(&links, &self.gripper);
        let (world_from_links, world_from_tcp) = arm_poses(self, &self.controller.start);
        world.set_arm(&world_from_links, &world_from_tcp);
        world.settle(self.settle_time);
        world
    }
}

/// World poses of the links and of the tool centre point.
pub(crate) fn arm_poses(spec: &CellSpec, joints: &JointPositions) -> (Vec<Pose>, Pose) {
    let links = spec
        .arm
        .base_from_links(joints)
        .iter()
        .map(|base_from_link| spec.world_from_base * base_from_link)
        .collect();
    let world_from_tcp =
        spec.world_from_base * spec.arm.base_from_flange(joints) * spec.gripper.flange_from_tcp;
    (links, world_from_tcp)
}
