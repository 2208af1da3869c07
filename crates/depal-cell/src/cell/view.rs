//! What others are shown of the cell: vision's truth, and the observers' snapshots.

use super::{Cell, arm_poses};
use crate::observer::{CartonView, CartonViewState, Snapshot};
use crate::score::CartonFate;
use crate::truth::TrueCarton;

impl Cell {
    /// Cartons that a camera could be asked to find: not held, not on the belt, not lost.
    pub(super) fn pickable_cartons(&self) -> Vec<TrueCarton> {
        let held = self
            .world
            .gripper()
            .map(depal_gripper::GripperState::held_cartons)
            .unwrap_or_default();
        self.world
            .cartons()
            .into_iter()
            .filter(|carton| {
                !held.contains(&carton.id.0)
                    && self.score.fates.get(&carton.id.0) == Some(&CartonFate::InCell)
            })
            .map(|carton| TrueCarton {
                id: carton.id.0,
                world_from_centre: carton.world_from_centre,
                size: [carton.size.length, carton.size.width, carton.size.height],
            })
            .collect()
    }

    /// Everything that moves, now.
    pub(super) fn snapshot(&self) -> Snapshot {
        let joints = self.controller.commanded_joints();
        let (world_from_links, world_from_tcp) = arm_poses(&self.spec, &joints);
        let gripper = self.world.gripper();
        let held = gripper
            .map(depal_gripper::GripperState::held_cartons)
            .unwrap_or_default();
        let targets = self.vision.targets();
        let cartons = self
            .world
            .cartons()
            .into_iter()
            .map(|carton| {
                let id = carton.id.0;
                let state = match self.score.fates.get(&id) {
                    Some(CartonFate::Lost(_)) => CartonViewState::Lost,
                    Some(CartonFate::OnConveyor | CartonFate::Placed) => CartonViewState::Placed,
                    _ if held.contains(&id) => CartonViewState::Gripped,
                    _ if targets.contains(&id) => CartonViewState::Target,
                    _ => CartonViewState::Waiting,
                };
                CartonView {
                    id,
                    world_from_centre: carton.world_from_centre,
                    size: [carton.size.length, carton.size.width, carton.size.height],
                    state,
                }
            })
            .collect();
        Snapshot {
            time: self.now,
            joints,
            world_from_links,
            world_from_tcp,
            section_vacuum: (0..self.spec.gripper.sections.len())
                .map(|section| gripper.map_or(0.0, |g| g.section_vacuum(section)))
                .collect(),
            valves: self.last_valves.clone(),
            cartons,
        }
    }
}
