//! Moves that were given: the free ones pass, and each with something in its way is refused by name.

use depal_frames::{JointPositions, PlacedShape, Pose, Vector};

use super::{Cell, cuboid, seen};
use crate::{GivenMove, Motion, MoveRefusal, Obstacle, SeenBox, check_moves};

/// Tool over the pallet and over the conveyor, looking down.
fn at(cell: &Cell, x: f64, y: f64, z: f64, near: &JointPositions) -> JointPositions {
    let down = Pose::rotation(Vector::x() * std::f64::consts::PI);
    let base_from_flange =
        Pose::translation(x, y, z) * down * cell.gripper.flange_from_tcp.inverse();
    cell.arm
        .inverse_nearest(&base_from_flange, near)
        .expect("in reach")
}

fn given(joints: JointPositions, motion: Motion) -> GivenMove {
    GivenMove {
        joints,
        motion,
        carried: None,
        is_beside_others: false,
        without: Vec::new(),
        stops: true,
        is_checked: true,
    }
}

fn check(cell: &Cell, boxes: &[SeenBox], moves: &[GivenMove]) -> Result<(), MoveRefusal> {
    check_moves(&cell.request(boxes), moves)
}

fn carton() -> PlacedShape {
    cuboid(0.0, 0.0, 0.125, 0.4, 0.3, 0.25)
}

/// Over the pallet at 1.3 m, down to a box at 0.9 m, up, and over to the conveyor.
fn pick(cell: &Cell) -> Vec<GivenMove> {
    let above = at(cell, 1.7, 0.0, 1.3, &cell.start);
    let on = at(cell, 1.7, 0.0, 0.9, &above);
    let over = at(cell, 0.4, 1.8, 1.3, &above);
    let held = |given: GivenMove| GivenMove {
        carried: Some(carton()),
        without: vec![0],
        ..given
    };
    vec![
        given(above, Motion::Joint),
        GivenMove {
            without: vec![0],
            ..given(on, Motion::Linear)
        },
        GivenMove {
            is_beside_others: true,
            ..held(given(above, Motion::Linear))
        },
        held(given(over, Motion::Joint)),
    ]
}

#[test]
fn a_free_way_passes_and_a_post_in_it_is_named() {
    let mut cell = Cell::new();
    let boxes = [seen(1.7, 0.0, 0.9, 0.0), seen(1.7, 0.304, 0.9, 0.0)];
    let moves = pick(&cell);
    cell.start = moves[0].joints;
    assert_eq!(check(&cell, &boxes, &moves), Ok(()));
    // Half way between pallet and conveyor, in the sweep of axis 1.
    let middle = cell
        .arm
        .base_from_flange(&moves[2].joints.lerp(&moves[3].joints, 0.5))
        .translation
        .vector;
    cell.known
        .push(cuboid(middle.x, middle.y, 1.0, 0.1, 0.1, 2.0));
    let Err(MoveRefusal::Touches { at, obstacle, .. }) = check(&cell, &boxes, &moves) else {
        panic!("through a post");
    };
    assert_eq!((at, obstacle), (3, Obstacle::Known(5)));
    // Not looked at, it does not matter.
    let mut unchecked = moves.clone();
    unchecked[3].is_checked = false;
    assert_eq!(check(&cell, &boxes, &unchecked), Ok(()));
}

#[test]
fn only_the_held_carton_meets_what_is_low() {
    let mut cell = Cell::new();
    let boxes = [seen(1.7, 0.0, 0.9, 0.0)];
    let mut moves = pick(&cell);
    // Gripper at 1.3 m, carton down to 1.05 m: a beam at 1.15 m is for the carton alone.
    let middle = cell
        .arm
        .base_from_flange(&moves[2].joints.lerp(&moves[3].joints, 0.5))
        .translation
        .vector;
    cell.known
        .push(cuboid(middle.x, middle.y, 1.12, 0.1, 0.1, 0.06));
    let refused = check(&cell, &boxes, &moves).expect_err("the carton hits the beam");
    assert_eq!(refused.to_string(), "carton meets known obstacle 5");
    moves[3].carried = None;
    assert_eq!(check(&cell, &boxes, &moves), Ok(()));
}

#[test]
fn seen_boxes_are_obstacles_unless_they_are_the_pick() {
    let cell = Cell::new();
    let boxes = [seen(1.7, 0.0, 0.9, 0.0), seen(1.7, 0.4, 1.4, 0.0)];
    let mut moves = pick(&cell);
    // The tall one beside it is in the gripper's way.
    let refused = check(&cell, &boxes, &moves).expect_err("a tall neighbour");
    let by_neighbour = |refusal: &MoveRefusal| {
        matches!(
            refusal,
            MoveRefusal::Touches {
                obstacle: Obstacle::Box(1),
                ..
            }
        )
    };
    assert!(by_neighbour(&refused), "{refused}");
    let words = refused.renumbered(&[4, 7]).to_string();
    assert!(words.ends_with("box 7"), "{words}");
    // A carton that leaves its stack is taken to be smaller; without that it would rub its neighbour's side.
    let close = [seen(1.7, 0.0, 0.9, 0.0), seen(1.7, 0.295, 0.9, 0.0)];
    assert_eq!(check(&cell, &close, &moves), Ok(()));
    moves[2].is_beside_others = false;
    assert!(check(&cell, &close, &moves).is_err_and(|refusal| refusal.at() == 2));
}

#[test]
fn a_straight_line_through_the_arm_s_own_foot_cannot_be_followed() {
    let cell = Cell::new();
    let right = at(&cell, 0.2, -1.5, 1.0, &cell.start);
    let left = at(&cell, 0.2, 1.5, 1.0, &cell.start);
    let over = [given(right, Motion::Joint), given(left, Motion::Linear)];
    let refused = check(&cell, &[], &over).expect_err("through the foot");
    assert_eq!(refused.at(), 1);
}

#[test]
fn a_corner_that_is_cut_is_looked_at() {
    let mut cell = Cell::new();
    let high = at(&cell, 1.7, 0.0, 1.3, &cell.start);
    let low = at(&cell, 1.7, 0.0, 1.0, &high);
    let aside = at(&cell, 1.7, 0.5, 1.0, &low);
    let mut moves = vec![
        given(high, Motion::Joint),
        given(low, Motion::Linear),
        given(aside, Motion::Linear),
    ];
    // Just inside the corner, clear of both lines: the plate reaches 0.2 m aside and lies 45 to 115 mm above the tool.
    cell.settings.corner_zone = 0.2;
    cell.known.push(cuboid(1.93, 0.25, 1.18, 0.02, 0.02, 0.02));
    let stopped = check(&cell, &[], &moves);
    moves[1].stops = false;
    let cut = check(&cell, &[], &moves);
    assert_eq!(stopped, Ok(()));
    assert!(cut.is_err_and(|refusal| refusal.at() == 1));
}
