use depal_camera::{Material, RenderShape, capture};
use depal_frames::{PlacedShape, Vector};
use depal_vision::detect;
use depal_workflow::StepKind;

use crate::*;

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/interface.toml");

#[test]
fn the_interface_scene_is_what_its_users_rely_on() {
    let spec = Scene::load_file(PATH, &[], None)
        .unwrap()
        .build()
        .unwrap()
        .spec;
    let projects: Vec<i32> = spec.projects.keys().copied().collect();
    assert_eq!(projects, [1, 2, 3, 4, 5]);
    assert_eq!(spec.workflow.check(&projects), []);
    assert_eq!(spec.workflow.index_steps(), [(3, 6)]);
    assert_eq!(spec.workflow.branches(), [(1, 2)]);
    assert_eq!(spec.workflow.global_velocity_percent, 50.0);
    for path in spec.projects.values().filter_map(|p| p.path.as_ref()) {
        assert_eq!(path.check(&projects), []);
    }
    let all = spec.projects[&5].path.as_ref().unwrap();
    assert!(matches!(
        all.steps[1].kind,
        StepKind::VisionMove {
            plans_all: true,
            ..
        }
    ));
    let ports = spec.projects[&3].custom_rows(2).unwrap();
    assert_eq!(ports[0].rows, [[7.5, -8.0], [7.5, -8.0]]);
    assert_eq!(ports[1].rows, [[1.0, 2.0, 3.0], [1.0, 2.0, 3.0]]);
    assert!((3..=100).contains(&spec.interface.calibration.len()));
    for joints in [[0.0, -20.0, 10.0, 0.0, 60.0, 0.0], [0.0; 6]] {
        let joints = depal_frames::JointPositions::from_degrees(&joints);
        assert!(spec.arm.within_limits(&joints));
    }
}

#[test]
fn vision_finds_every_carton_of_the_interface_scene() {
    let spec = Scene::load_file(PATH, &[], None)
        .unwrap()
        .cell_spec()
        .unwrap();
    let mut shapes: Vec<(PlacedShape, u32)> = Vec::new();
    for body in &spec.world.fixed {
        shapes.extend(body.shapes.iter().map(|shape| (shape.clone(), 0)));
    }
    for (id, carton) in (1..).zip(&spec.cartons) {
        let size = Vector::new(carton.size.length, carton.size.width, carton.size.height);
        shapes.push((PlacedShape::cuboid(carton.world_from_centre, size), id));
    }
    let shapes: Vec<RenderShape> = shapes
        .into_iter()
        .map(|(shape, id)| RenderShape {
            world_from_shape: shape.pose,
            shape: shape.shape,
            id,
            material: Material::KRAFT,
            edge_radius: if id > 0 {
                spec.world.carton_edge_radius
            } else {
                0.0
            },
        })
        .collect();
    let world_from_camera = spec.world_from_camera(None);
    let frame = capture(&spec.camera, &world_from_camera, &shapes, 1).frame;
    let settings = spec.projects[&1].settings_from(&spec.base_from_camera(None));
    let detection = detect(&frame, &settings);
    assert_eq!(detection.boxes.len(), 8);
    for carton in &spec.cartons {
        let top = carton.world_from_centre * depal_frames::Pose::translation(0.0, 0.0, 0.125);
        let nearest = detection
            .boxes
            .iter()
            .map(|found| world_from_camera * found.camera_from_box)
            .min_by(|a, b| {
                let distance =
                    |p: &depal_frames::Pose| (p.translation.vector - top.translation.vector).norm();
                distance(a).total_cmp(&distance(b))
            })
            .unwrap();
        let off = (nearest.translation.vector - top.translation.vector).norm();
        assert!(off < 0.006, "{off} m");
        // A carton looks alike after half a turn.
        let long = nearest.rotation * Vector::x();
        let turn = long
            .dot(&(top.rotation * Vector::x()))
            .abs()
            .min(1.0)
            .acos();
        assert!(turn < 2f64.to_radians(), "{} degrees", turn.to_degrees());
    }
    let settings = spec.projects[&4].settings_from(&spec.base_from_camera(None));
    let empty = detect(&frame, &settings);
    assert_eq!((empty.boxes.len(), empty.points_in_region), (0, 0));
}

/// What a scene says of the cartons' edges comes to the picture, and to that of nothing else.
#[test]
fn the_edges_of_cartons_are_as_round_in_the_picture_as_the_scene_says() {
    let radii = |overrides: &[(String, String)]| {
        let scene = Scene::load_file(PATH, overrides, None).unwrap();
        let spec = scene.cell_spec().unwrap();
        let mut world = depal_world::World::new(&spec.world);
        for carton in &spec.cartons {
            world.add_carton(carton);
        }
        let cartons = 1..=spec.cartons.len() as u32;
        depal_cell::cell::render_shapes(&world, &spec.skins)
            .into_iter()
            .map(|shape| (cartons.contains(&shape.id), shape.edge_radius))
            .collect::<Vec<_>>()
    };
    let four = radii(&super::sets(&[("cartons.edge_radius_mm", "4")]));
    assert!(four.iter().any(|(is_carton, _)| *is_carton));
    for (is_carton, radius) in four {
        let expected = if is_carton { 0.004 } else { 0.0 };
        assert!((radius - expected).abs() < 1e-12, "{is_carton} {radius}");
    }
}
