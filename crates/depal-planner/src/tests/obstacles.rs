use depal_frames::{JointPositions, PlacedShape, Point, Pose, Rotation, Vector};
use nalgebra::Translation3;

use super::{Cell, assert_consistent, assert_free, cuboid, dense, pallet, seen, visible};
use crate::{Obstacle, Refusal, RejectReason, Stage, bodies::Robot, contact::Check, world::World};

#[test]
fn refusals_say_why_for_every_box() {
    let cell = Cell::new();
    assert_eq!(cell.plan(&[]), Err(Refusal::NoBoxes));

    // Out of reach, and under a table top that leaves 100 mm of air.
    let boxes = [seen(4.0, 0.0, 1.0, 0.0), seen(1.7, 0.0, 0.9, 0.0)];
    let mut tabled = Cell::new();
    tabled.known.push(cuboid(1.7, 0.0, 1.02, 0.9, 0.9, 0.04));
    let Err(Refusal::NothingFits(rejected)) = tabled.plan(&boxes) else {
        panic!("a plan through the table");
    };
    assert_eq!(rejected.len(), 2);
    let reason = |i| &rejected.iter().find(|r| r.box_index == i).unwrap().reason;
    assert!(
        matches!(
            reason(0),
            RejectReason::Unreachable {
                stage: Stage::Pick,
                ..
            }
        ),
        "{}",
        reason(0)
    );
    assert!(
        matches!(reason(1), RejectReason::Collision { touch, .. } if touch.obstacle == Obstacle::Known(5)),
        "{}",
        reason(1)
    );
    let words = Refusal::NothingFits(rejected.clone()).to_string();
    assert!(
        words.contains("ik_unreachable") && words.contains("known obstacle 5"),
        "{words}"
    );

    // The arm stands in a wall, or outside its limits.
    let mut walled = Cell::new();
    let flange = walled
        .arm
        .base_from_flange(&walled.start)
        .translation
        .vector;
    walled
        .known
        .push(cuboid(flange.x, flange.y, flange.z, 0.2, 0.2, 0.2));
    assert!(matches!(walled.plan(&boxes), Err(Refusal::StartTouches(_))));
    let mut beyond = Cell::new();
    beyond.start[1] = 2.0;
    let words = beyond.plan(&boxes).unwrap_err().to_string();
    assert_eq!(
        words,
        "joint 2 starts at 114.6 degrees, allowed are -65.0 to 85.0"
    );

    // The place is out of reach.
    let mut remote = Cell::new();
    remote.place.base_from_place = Pose::translation(0.4, 4.0, 0.7);
    let Err(Refusal::NothingFits(rejected)) = remote.plan(&boxes[1..]) else {
        panic!("a plan to nowhere");
    };
    assert!(matches!(
        rejected[0].reason,
        RejectReason::Unreachable {
            stage: Stage::Place,
            ..
        }
    ));
}

/// What stands in the way changes the way: once as a known post, once only as depth points.
#[test]
fn an_obstacle_on_the_path_changes_it() {
    let boxes = visible(&pallet(6));
    let free = Cell::new();
    let plan = free.plan(&boxes).unwrap();
    // The middle of the longest loaded joint move.
    let loaded = &plan.waypoints[plan.pick_index + 1..];
    let longest = loaded
        .windows(2)
        .max_by(|a, b| {
            a[0].joints
                .max_distance(&a[1].joints)
                .total_cmp(&b[0].joints.max_distance(&b[1].joints))
        })
        .unwrap();
    let middle = longest[0].joints.lerp(&longest[1].joints, 0.5);
    let tcp = free.arm.base_from_flange(&middle) * free.gripper.flange_from_tcp * plan.carried.pose;
    let at = tcp.translation.vector;

    let mut post = Cell::new();
    post.known
        .push(cuboid(at.x, at.y, at.z * 0.5, 0.06, 0.06, at.z));
    let mut cloud = Cell::new();
    cloud.points = (0..(at.z / 0.02) as usize)
        .map(|k| Point::new(at.x, at.y, at.z - 0.02 * k as f64))
        .collect();
    for cell in [post, cloud] {
        match cell.plan(&boxes) {
            Ok(other) => {
                assert_ne!(other.waypoints, plan.waypoints);
                assert_free(&cell, &boxes, &other);
            }
            Err(refusal) => assert!(refusal.to_string().contains("meets"), "{refusal}"),
        }
        // The old way does touch it: the check can fail.
        let request = cell.request(&boxes);
        let world = World::new(&request, 0.0);
        let robot = Robot::new(&cell.arm, &cell.gripper);
        let carton = robot.carton(&plan.carried, 0.0);
        let check = Check {
            robot: &robot,
            world: &world,
            carton: Some(&carton),
            without: &plan.box_indices,
            stage: Stage::Certificate,
        };
        assert!(check.touch(&middle).is_some());
    }
}

/// A wall with a beam above it across the sweep of axis 1: every template meets one of them, the search finds the window.
#[test]
fn a_window_needs_the_search() {
    let boxes = [seen(1.7, 0.0, 0.9, 0.0)];
    let turned = |x: f64, z: f64, size: Vector| {
        let heading = Rotation::from_axis_angle(&Vector::z_axis(), 0.75);
        let pose =
            Pose::from_parts(Translation3::identity(), heading) * Pose::translation(x, 0.0, z);
        PlacedShape::cuboid(pose, size)
    };
    let mut cell = Cell::new();
    cell.start = JointPositions::from_degrees(&[0.0, -15.0, 10.0, 0.0, 95.0, 0.0]);
    cell.known
        .push(turned(1.85, 0.6, Vector::new(1.8, 0.05, 1.2)));
    cell.known
        .push(turned(2.0, 2.8, Vector::new(2.0, 0.05, 1.0)));
    let plan = cell.plan(&boxes).unwrap();
    assert_free(&cell, &boxes, &plan);
    assert_consistent(&cell, &boxes, &plan);
    assert!(
        plan.waypoints.len() <= 9 && plan.min_clearance > 0.005,
        "{plan:?}"
    );
    assert_eq!(cell.plan(&boxes), Ok(plan), "the seed is fixed");
    // While the carton hangs, the tool never leans more than allowed.
    let plan = cell.plan(&boxes).unwrap();
    for (i, q) in dense(&cell, &plan, 0.01) {
        let tool = cell.arm.base_from_flange(&q) * cell.gripper.flange_from_tcp;
        let lean = (tool.rotation * -Vector::z()).z.clamp(-1.0, 1.0).acos();
        assert!(
            i <= plan.pick_index || lean <= cell.settings.max_carry_tilt + 1e-3,
            "{lean}"
        );
    }

    cell.settings.search_attempts = 0;
    let refusal = cell.plan(&boxes).unwrap_err().to_string();
    assert!(
        refusal.contains("known obstacle 5 on the way to the place"),
        "{refusal}"
    );

    // Bricked up, the window is refused even with the search.
    cell.settings.search_attempts = 3;
    cell.known
        .push(turned(1.85, 1.8, Vector::new(2.4, 0.05, 1.3)));
    assert!(matches!(cell.plan(&boxes), Err(Refusal::NothingFits(_))));
}

/// Points at the rim of a box are part of it; the same points 60 mm above a face are something that stands there.
#[test]
fn rim_points_belong_to_their_box() {
    let boxes = visible(&pallet(3));
    let mut cell = Cell::new();
    let clean = cell.plan(&boxes).unwrap();
    let rim = |height: f64| -> Vec<Point> {
        let corners = [(0.205, 0.1), (-0.195, -0.155), (0.0, 0.15)];
        let target = boxes[clean.box_index].base_from_box;
        corners
            .iter()
            .map(|&(x, y)| target * Point::new(x, y, height))
            .collect()
    };
    cell.points = rim(0.008);
    assert_eq!(cell.plan(&boxes).unwrap(), clean);
    cell.points = rim(0.06);
    match cell.plan(&boxes) {
        Ok(other) => assert_ne!(other.box_index, clean.box_index),
        Err(refusal) => panic!("{refusal}"),
    }
}
