//! Cost of one 4 ms step with a full pallet: asleep, awake, and with a carton at the cups.

// The macros below make public functions without documentation.
#![allow(missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use depal_frames::nalgebra::UnitQuaternion;
use depal_frames::{BoxSize, PlacedShape, Pose, Vector};
use depal_gripper::GripperSpec;
use depal_time::SimDuration;
use depal_world::{CartonSpec, FixedBody, World, WorldSpec};

const TOP: f64 = 0.144 + 6.0 * 0.25;

/// 48 cartons on a pallet, settled, and a tool high above.
fn pallet() -> World {
    let mut spec = WorldSpec::default();
    let wood = PlacedShape::cuboid(
        Pose::translation(0.0, 0.0, 0.072),
        Vector::new(1.2, 0.8, 0.144),
    );
    spec.fixed.push(FixedBody::standing("pallet", vec![wood]));
    let mut world = World::new(&spec);
    for index in 0..48 {
        let (layer, column, row) = (index / 8, index / 2 % 4, index % 2);
        world.add_carton(&CartonSpec {
            size: BoxSize {
                length: 0.396,
                width: 0.296,
                height: 0.25,
            },
            mass: 8.0 + f64::from(index % 13),
            world_from_centre: Pose::from_parts(
                Vector::new(
                    (f64::from(column) - 1.5) * 0.3,
                    (f64::from(row) - 0.5) * 0.4,
                    0.144 + 0.125 + f64::from(layer) * 0.25,
                )
                .into(),
                UnitQuaternion::from_axis_angle(&Vector::z_axis(), std::f64::consts::FRAC_PI_2),
            ),
            friction: 0.5,
        });
    }
    world.settle(SimDuration::from_millis(1000));
    world.add_arm(&[], &GripperSpec::four_sections());
    world
}

fn tool(world: &mut World, height: f64) {
    let down = UnitQuaternion::from_axis_angle(&Vector::x_axis(), std::f64::consts::PI);
    let place = Vector::new(0.15, 0.2, height);
    world.set_arm(&[], &Pose::from_parts(place.into(), down));
}

fn steps(criterion: &mut Criterion) {
    let mut asleep = pallet();
    tool(&mut asleep, 3.0);
    for _ in 0..1000 {
        asleep.step(&[]);
    }
    criterion.bench_function("step_48_asleep", |b| b.iter(|| asleep.step(&[])));
    let mut awake = pallet();
    criterion.bench_function("step_48_awake", |b| {
        b.iter(|| awake.settle(SimDuration::from_millis(4)));
    });
    let mut gripped = pallet();
    tool(&mut gripped, TOP);
    let valves = [false, true, true, false];
    criterion.bench_function("step_48_gripped", |b| b.iter(|| gripped.step(&valves)));
}

criterion_group! {
    name = tick;
    config = Criterion::default().sample_size(20);
    targets = steps
}
criterion_main!(tick);
