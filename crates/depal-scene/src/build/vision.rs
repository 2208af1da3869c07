//! The vision projects of a scene.

use std::collections::BTreeMap;

use depal_cell::spec::{CustomPort, CustomRows, Recipe, Region, VisionProject};
use depal_frames::{BoxSize, Pose, Vector};
use depal_vision::VisionSettings;

use super::{solids, workflow};
use crate::scene::Scene;
use crate::vision::{ProjectOutput, VisionProject as SceneProject};

/// Around the pallet's footprint, metres: cartons overhang and shift.
const REGION_MARGIN: f64 = 0.15;
/// Below the deck, metres: the deck itself is in view, and vision must tell it from cartons.
const REGION_BELOW: f64 = 0.03;
/// Above the deck, metres: a full stack and a carton on it.
const REGION_ABOVE: f64 = 2.2;

/// The vision projects, with their regions in the robot base.
pub(super) fn projects(scene: &Scene, base_from_world: &Pose) -> BTreeMap<i32, VisionProject> {
    let mut projects = BTreeMap::new();
    for project in &scene.vision.project {
        let sizes = |boxes: &[[f64; 3]]| boxes.iter().map(|b| BoxSize::from_mm(*b)).collect();
        let settings = VisionSettings {
            min_depth: scene.camera.near_mm * 1e-3,
            max_depth: scene.camera.far_mm * 1e-3,
            ..VisionSettings::new(sizes(&project.box_mm))
        };
        let recipes = project
            .recipes
            .iter()
            .map(|recipe| {
                let looked_for = Recipe {
                    sizes: sizes(&recipe.box_mm),
                    labels: recipe.labels.clone(),
                };
                (i32::from(recipe.id), looked_for)
            })
            .collect();
        let custom_ports = project
            .port
            .iter()
            .map(|port| CustomPort {
                name: port.name.clone(),
                rows: if port.rows.is_empty() {
                    CustomRows::Same(port.row.clone())
                } else {
                    CustomRows::ByPoint(port.rows.clone())
                },
            })
            .collect();
        let path = (project.output == ProjectOutput::Path).then(|| workflow::path_steps(project));
        projects.insert(
            i32::from(project.id),
            VisionProject {
                id: i32::from(project.id),
                settings,
                region: Some(region(scene, project, base_from_world)),
                labels: project.labels.clone(),
                recipes,
                custom_ports,
                path,
            },
        );
    }
    projects
}

/// Where a project looks for cartons: its own region, or the air above the pallet.
fn region(scene: &Scene, project: &SceneProject, base_from_world: &Pose) -> Region {
    let (world_from_region, size) =
        if let (Some(centre), Some(size)) = (project.region_xyz_mm, project.region_size_mm) {
            (solids::pose_mm_yaw(centre, 0.0), Vector::from(size) * 1e-3)
        } else {
            let pallet = &scene.pallet;
            let deck = pallet.size_mm[2] * 1e-3;
            let size = Vector::new(
                pallet.size_mm[0] * 1e-3 + 2.0 * REGION_MARGIN,
                pallet.size_mm[1] * 1e-3 + 2.0 * REGION_MARGIN,
                REGION_ABOVE + REGION_BELOW,
            );
            let middle = Pose::translation(0.0, 0.0, deck - REGION_BELOW + 0.5 * size.z);
            let world_from_pallet = solids::pose_mm_yaw(pallet.xyz_mm, pallet.yaw_deg);
            (world_from_pallet * middle, size)
        };
    Region {
        base_from_region: base_from_world * world_from_region,
        half_extents: size * 0.5,
    }
}
