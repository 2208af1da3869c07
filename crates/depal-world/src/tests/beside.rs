//! A held carton that is lowered close beside another one.

use depal_time::SimDuration;

use super::cell::*;
use crate::{World, WorldEvent};

/// Lowers a carton beside another one at the speed of a robot, leaving `gap` metres between them along the world's
/// X or Y. What happened on the way down, and how far the other one was moved, metres.
fn lower_beside(gap: f64, is_along_x: bool) -> (Vec<WorldEvent>, f64) {
    let mut world = World::new(&spec());
    let standing = if is_along_x {
        [-0.3, 0.0]
    } else {
        [-0.2, -0.2]
    };
    let placed = world.add_carton(&carton(standing[0], standing[1], PALLET_HEIGHT, 12.0));
    let from = [0.42, 0.15];
    world.add_carton(&carton(from[0], from[1], PALLET_HEIGHT, 12.0));
    world.settle(SimDuration::from_millis(200));
    let mut cell = Cell::new(
        world,
        [from[0], from[1], PALLET_HEIGHT + SIZE.height + 0.05],
    );
    cell.grip(&MIDDLE);
    let [_, _, gripped] = cell.tool;
    cell.go([from[0], from[1], gripped + 0.4], 1.0, 3.0, &MIDDLE);
    let to = if is_along_x {
        [standing[0] + SIZE.width + gap, standing[1]]
    } else {
        [standing[0], standing[1] + SIZE.length + gap]
    };
    cell.go([to[0], to[1], gripped + 0.4], 0.5, 2.0, &MIDDLE);
    cell.stay(0.5, &MIDDLE);
    cell.events.clear();
    let before = cell.place(placed);
    cell.go([to[0], to[1], gripped + 0.004], 1.0, 4.0, &MIDDLE);
    let moved = (cell.place(placed) - before).norm();
    (cell.events, moved)
}

#[test]
fn a_gap_of_millimetres_is_a_gap() {
    for is_along_x in [true, false] {
        for gap in [0.003, 0.005, 0.008, 0.015] {
            let (events, moved) = lower_beside(gap, is_along_x);
            assert_eq!(events, [], "gap {gap} m, along X: {is_along_x}");
            assert!(moved < 0.001, "gap {gap} m: moved by {moved} m");
        }
    }
}

#[test]
fn no_gap_is_none() {
    for is_along_x in [true, false] {
        let (events, _) = lower_beside(-0.005, is_along_x);
        assert!(!events.is_empty(), "along X: {is_along_x}");
    }
}
