use depal_frames::{PlacedShape, Vector};
use depal_gripper::GripperSpec;
use depal_time::SimDuration;

use super::cell::*;
use crate::{Body, FixedBody, VisibleKind, World, WorldEvent};

fn collisions(events: &[WorldEvent]) -> Vec<(Body, Body)> {
    let found = events.iter().filter_map(|event| match event {
        WorldEvent::Collision { a, b, .. } => Some((a.clone(), b.clone())),
        _ => None,
    });
    found.collect()
}

#[test]
fn pressing_the_cups_softly_is_no_collision() {
    let (mut cell, _) = Cell::one_carton(12.0);
    cell.grip(&MIDDLE);
    cell.stay(0.5, &CLOSED);
    assert_eq!(collisions(&cell.events), []);
}

#[test]
fn crushing_a_carton_is_one() {
    let (mut cell, id) = Cell::one_carton(12.0);
    cell.grip(&CLOSED);
    let [x, y, z] = cell.tool;
    cell.go([x, y, z - 0.04], 0.1, 1.0, &CLOSED);
    let found = collisions(&cell.events);
    assert!(found.contains(&(Body::Cups, Body::Carton(id))), "{found:?}");
    assert!(found.contains(&(Body::Tool, Body::Carton(id))), "{found:?}");
    assert_eq!(found.len(), 2, "each is reported once: {found:?}");
}

#[test]
fn a_held_carton_pushed_against_a_wall_collides() {
    let mut walled = spec();
    let wall = PlacedShape::cuboid(at(0.0, 1.0, 1.0), Vector::new(2.0, 0.2, 2.0));
    walled.fixed.push(FixedBody::standing("fence", vec![wall]));
    let run = |spec, to_y: f64| {
        let mut world = World::new(spec);
        let id = world.add_carton(&carton(0.0, 0.0, PALLET_HEIGHT, 12.0));
        world.settle(SimDuration::from_millis(200));
        let mut cell = Cell::new(world, [0.0, -0.06, PALLET_HEIGHT + SIZE.height + 0.05]);
        cell.grip(&MIDDLE);
        cell.go([0.0, -0.06, 0.9], 0.8, 3.0, &MIDDLE);
        // The carton reaches 0.26 m ahead of the tool's middle, the plate 0.20 m.
        cell.go([0.0, to_y, 0.9], 0.3, 3.0, &MIDDLE);
        (collisions(&cell.events), id)
    };
    let (found, id) = run(&walled, 0.68);
    assert_eq!(found, [(Body::Carton(id), Body::Fixed("fence".to_owned()))]);
    assert_eq!(run(&walled, 0.63).0, []);
    assert_eq!(run(&spec(), 0.68).0, []);
}

#[test]
fn links_collide_with_fixed_bodies_but_the_base_may_stand() {
    let mut world = World::new(&spec());
    let block = vec![PlacedShape::cuboid(
        at(0.0, 0.0, 0.0),
        Vector::new(0.2, 0.2, 0.2),
    )];
    let links = [
        ("base".to_owned(), block.clone()),
        ("arm".to_owned(), block),
    ];
    world.add_arm(&links, &GripperSpec::four_sections());
    let mut events = Vec::new();
    for step in 0..100 {
        let height = 0.3 - 0.003 * f64::from(step);
        let poses = [at(2.0, 0.0, 0.05), at(2.0, 0.0, height)];
        world.set_arm(&poses, &down(2.0, 0.0, 2.0));
        events.extend(world.step(&[]));
    }
    let expected = (
        Body::Link("arm".to_owned()),
        Body::Fixed("floor".to_owned()),
    );
    assert_eq!(collisions(&events), [expected]);
}

#[test]
fn an_arm_that_pushes_the_stack_moves_the_neighbours() {
    let (mut cell, id) = Cell::one_carton(12.0);
    let z = PALLET_HEIGHT + 0.15;
    let mut side = Cell::new(
        std::mem::replace(&mut cell.world, World::new(&spec())),
        [-0.8, 0.0, z],
    );
    side.go([-0.4, 0.0, z], 0.3, 2.0, &CLOSED);
    let moved = side.events.iter().filter(|event| {
        matches!(event, WorldEvent::NeighbourMoved { carton, distance } if *carton == id && *distance > 0.01)
    });
    assert_eq!(moved.count(), 1, "{:?}", side.events);
}

#[test]
fn every_solid_is_visible_at_its_place() {
    let (mut cell, id) = Cell::one_carton(12.0);
    cell.grip(&MIDDLE);
    cell.go([0.3, 0.0, 1.0], 0.5, 2.0, &MIDDLE);
    let shapes = cell.world.visible_shapes();
    let kinds: Vec<_> = shapes.iter().map(|shape| shape.kind).collect();
    assert_eq!(
        kinds,
        [
            VisibleKind::Carton(id),
            VisibleKind::Fixed(0),
            VisibleKind::Fixed(1),
            VisibleKind::Conveyor(0),
            VisibleKind::Tool,
            VisibleKind::Tool,
        ]
    );
    // The plate's centre is 50 mm above the cup plane, the carton's centre half a carton below.
    assert!((shapes[4].shape.pose.translation.z - 1.05).abs() < 1e-5);
    let carton = shapes[0].shape.pose.translation.vector;
    assert!(
        (carton - Vector::new(0.3, 0.0, 1.0 - 0.125)).norm() < 0.005,
        "{carton}"
    );
}
