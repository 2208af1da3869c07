//! The vision server of a scene: its projects, its planning project, its port.

use std::collections::BTreeMap;

use depal_cell::spec::{CustomPort, CustomRows, VisionProject};
use depal_frames::{BoxSize, EulerConvention, Pose, Vector};
use depal_interface::{
    BranchStep, Encoding, FaultScript, OutputPort, PortSettings, Profile, ServerSettings,
    VisionProject as ServedProject, VizProject,
};
use depal_time::SimDuration;
use depal_vision::{RegionOfInterest, VisionSettings};

use super::{solids, workflow};
use crate::interface::{RobotBrand, WireEncoding};
use crate::scene::Scene;
use crate::vision::{ProjectOutput, VisionProject as SceneProject};
use crate::viz::VizAction;

/// Around the pallet's footprint, metres: cartons overhang and shift.
const REGION_MARGIN: f64 = 0.15;
/// Below the deck, metres: the deck itself is in view, and vision must tell it from cartons.
const REGION_BELOW: f64 = 0.03;
/// Above the deck, metres: a full stack and a carton on it.
const REGION_ABOVE: f64 = 2.2;

/// The vision projects, with their regions in the camera frame.
pub(super) fn projects(scene: &Scene, camera_from_base: &Pose) -> BTreeMap<i32, VisionProject> {
    let base_from_world =
        solids::pose_mm_yaw(scene.robot.base_xyz_mm, scene.robot.base_yaw_deg).inverse();
    let camera_from_world = camera_from_base * base_from_world;
    let mut projects = BTreeMap::new();
    for project in &scene.vision.project {
        let sizes = |boxes: &[[f64; 3]]| boxes.iter().map(|b| BoxSize::from_mm(*b)).collect();
        let settings = VisionSettings {
            min_depth: scene.camera.near_mm * 1e-3,
            max_depth: scene.camera.far_mm * 1e-3,
            region: Some(region(scene, project, &camera_from_world)),
            ..VisionSettings::new(sizes(&project.box_mm))
        };
        let recipes = project
            .recipes
            .iter()
            .map(|recipe| (i32::from(recipe.id), sizes(&recipe.box_mm)))
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
                settings,
                recipes,
                custom_ports,
                path,
            },
        );
    }
    projects
}

/// Where a project looks for cartons: its own region, or the air above the pallet.
fn region(scene: &Scene, project: &SceneProject, camera_from_world: &Pose) -> RegionOfInterest {
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
    RegionOfInterest {
        camera_from_region: camera_from_world * world_from_region,
        half_extents: size * 0.5,
    }
}

/// The server: one port, and what it must know of the projects.
pub(super) fn server(scene: &Scene) -> ServerSettings {
    let interface = &scene.interface;
    let port = PortSettings {
        encoding: match interface.encoding {
            WireEncoding::Ascii => Encoding::Ascii,
            WireEncoding::HexLe => Encoding::HexLittleEndian,
            WireEncoding::HexBe => Encoding::HexBigEndian,
        },
        profile: Profile {
            pose_cap: interface.pose_cap as usize,
            ..Profile::v1_8()
        },
        euler: match interface.brand {
            RobotBrand::Abb => EulerConvention::AbbZyx,
            RobotBrand::Kuka => EulerConvention::KukaAbc,
            RobotBrand::Fanuc => EulerConvention::FanucWpr,
        },
        timeout: SimDuration::from_secs_f64(interface.timeout_s),
        ..PortSettings::default()
    };
    let projects = scene.vision.project.iter().map(|project| ServedProject {
        id: i32::from(project.id),
        recipes: project.recipes.iter().map(|r| i32::from(r.id)).collect(),
        output: match project.output {
            ProjectOutput::Poses | ProjectOutput::Custom => OutputPort::Poses,
            ProjectOutput::Path => OutputPort::Path,
        },
        ..ServedProject::default()
    });
    let branches = scene
        .viz
        .steps
        .iter()
        .filter_map(|step| match &step.action {
            VizAction::BranchByMsg(branch) => Some(BranchStep {
                step: i32::from(step.id),
                exits: branch.exits.len() as i32,
            }),
            _ => None,
        });
    ServerSettings {
        ports: vec![port],
        projects: projects.collect(),
        viz: Some(VizProject {
            branches: branches.collect(),
            ..VizProject::default()
        }),
        faults: FaultScript::parse(&interface.inject).expect("the reader refuses wrong faults"),
        ..ServerSettings::default()
    }
}
