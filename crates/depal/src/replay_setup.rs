//! What a recording draws once: the parts of the cell that do not change.

use depal_cell::spec::CellSpec;
use depal_frames::{PlacedShape, Pose, Vector};
use depal_record::RecordingSetup;

/// The still parts of a cell, with their colours.
pub fn recording_setup(spec: &CellSpec) -> RecordingSetup {
    let mut fixed: Vec<_> = spec
        .world
        .fixed
        .iter()
        .map(|body| {
            let color = match body.name.as_str() {
                "floor" => [96, 98, 102],
                "pallet" => [150, 120, 80],
                _ => [90, 95, 105],
            };
            let shapes = if body.is_floor {
                vec![floor_patch()]
            } else {
                body.shapes.clone()
            };
            (body.name.replace(' ', "_"), shapes, color)
        })
        .collect();
    for conveyor in &spec.world.conveyors {
        fixed.push((
            conveyor.name.clone(),
            vec![conveyor.belt.clone()],
            [60, 66, 74],
        ));
    }
    RecordingSetup {
        title: format!("{} seed {}", spec.scene, spec.seed),
        readme: format!(
            "# {} with seed {}\n\nArm: {}. Gripper: {}. {} cartons.\n\n\
             Green wires: what vision reported. White wires: what was there to find.\n\
             Blue line: the path as planned; its red point is the pick.\n\n\
             Timelines: `sim_time`, `pick`, `frame`.\n",
            spec.scene,
            spec.seed,
            spec.arm.name(),
            spec.gripper.name,
            spec.cartons.len()
        ),
        arm_links: spec
            .arm
            .links()
            .iter()
            .map(|link| (link.name.clone(), link.visual.clone()))
            .collect(),
        joint_names: spec.arm.joint_names().to_vec(),
        gripper_bodies: spec.gripper.bodies.clone(),
        section_areas: spec.gripper.sections.iter().map(|s| s.area).collect(),
        fixed,
        intrinsics: spec.camera.intrinsics,
        world_from_camera: (!spec.is_eye_in_hand()).then(|| spec.world_from_camera(None)),
    }
}

/// A patch of floor that frames the cell: the whole floor would make everything else small.
fn floor_patch() -> PlacedShape {
    PlacedShape::cuboid(
        Pose::translation(0.6, 0.6, -0.01),
        Vector::new(4.4, 4.4, 0.02),
    )
}
