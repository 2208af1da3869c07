use depal_time::SimDuration;

use super::cell::*;
use crate::{CartonSpec, World, WorldEvent};

#[test]
fn full_pallet_settles_within_a_millimetre_and_stays() {
    let mut world = World::new(&spec());
    let placed = full_pallet(&mut world);
    world.settle(SimDuration::from_millis(2000));
    let worst = |world: &World| {
        let off = placed.iter().map(|(id, nominal)| {
            let state = world.carton(*id).expect("in the world");
            let turn = state.world_from_centre.rotation.angle_to(&nominal.rotation);
            let way = state.world_from_centre.translation.vector - nominal.translation.vector;
            (way.z.abs(), way.xy().norm(), turn)
        });
        off.fold((0.0f64, 0.0f64, 0.0f64), |a, b| {
            (a.0.max(b.0), a.1.max(b.1), a.2.max(b.2))
        })
    };
    let (sag, drift, turn) = worst(&world);
    assert!(
        sag < 0.001 && drift < 0.0005 && turn < 0.001,
        "{sag} {drift} {turn}"
    );
    let mut events = Vec::new();
    for _ in 0..500 {
        events.extend(world.step(&[]));
    }
    assert_eq!(events, []);
    let (sag, drift, turn) = worst(&world);
    assert!(
        sag < 0.001 && drift < 0.001 && turn < 0.001,
        "{sag} {drift} {turn}"
    );
}

#[test]
fn soft_contacts_would_sag_so_that_the_settings_matter() {
    let mut soft = spec();
    soft.contact_frequency = 30.0;
    soft.fixed_contact_frequency = 60.0;
    let mut world = World::new(&soft);
    let placed = full_pallet(&mut world);
    world.settle(SimDuration::from_millis(2000));
    let (id, nominal) = placed.last().expect("48 cartons");
    let state = world.carton(*id).expect("in the world");
    assert!(nominal.translation.z - state.world_from_centre.translation.z > 0.003);
}

#[test]
fn a_belt_carries_a_carton_to_its_end() {
    let mut world = World::new(&spec());
    let id = world.add_carton(&carton(-1.0, 3.0, 0.7, 12.0));
    world.settle(SimDuration::from_millis(20));
    let start = world
        .carton(id)
        .expect("in the world")
        .world_from_centre
        .translation
        .x;
    let mut events = Vec::new();
    for _ in 0..500 {
        events.extend(world.step(&[]));
    }
    let state = world.carton(id).expect("in the world");
    assert!(
        (state.linear_velocity.x - 0.4).abs() < 0.01,
        "{}",
        state.linear_velocity
    );
    let way = state.world_from_centre.translation.x - start;
    assert!((0.7..0.82).contains(&way), "2 s at 0.4 m/s: {way} m");
    assert!(matches!(&events[..], [WorldEvent::CartonTouchedBelt { carton, .. }] if *carton == id));
    for _ in 0..1000 {
        events.extend(world.step(&[]));
        if let Some(WorldEvent::CartonDelivered { carton, conveyor }) = events.last() {
            assert_eq!((*carton, conveyor.as_str()), (id, "outfeed"));
            assert!(world.remove_carton(id) && !world.remove_carton(id));
            assert!(world.cartons().is_empty());
            return;
        }
    }
    panic!("never delivered: {events:?}");
}

#[test]
fn the_belt_runs_in_its_own_direction() {
    let mut turned = spec();
    turned.conveyors[0].direction = -depal_frames::Vector::x();
    let mut world = World::new(&turned);
    let id = world.add_carton(&carton(0.0, 3.0, 0.7, 12.0));
    for _ in 0..250 {
        world.step(&[]);
    }
    let state = world.carton(id).expect("in the world");
    assert!(
        (state.linear_velocity.x + 0.4).abs() < 0.01,
        "{}",
        state.linear_velocity
    );
}

#[test]
fn a_carton_on_the_floor_is_reported_once() {
    let mut world = World::new(&spec());
    let id = world.add_carton(&carton(2.0, 0.0, 0.3, 12.0));
    let mut events = Vec::new();
    for _ in 0..500 {
        events.extend(world.step(&[]));
    }
    let lost = events
        .iter()
        .filter(|e| **e == WorldEvent::CartonOnFloor { carton: id });
    assert_eq!(lost.count(), 1);
}

#[test]
fn two_runs_are_bit_equal_and_a_micrometre_makes_them_differ() {
    let run = |shift: f64| {
        let mut world = World::new(&spec());
        full_pallet(&mut world);
        let spec = carton(2.0 + shift, 0.0, 0.3, 12.0);
        world.add_carton(&CartonSpec { ..spec });
        world.settle(SimDuration::from_millis(100));
        let top = PALLET_HEIGHT + 6.0 * SIZE.height;
        let mut cell = Cell::new(world, [0.152, 0.201, top + 0.05]);
        cell.grip(&MIDDLE);
        cell.push(0.3, [0.5, 0.0, 2.0], 0.5, &MIDDLE);
        cell.world.state_hash()
    };
    assert_eq!(run(0.0), run(0.0));
    assert_ne!(run(0.0), run(1e-6));
}
