//! One pick planned out of a full layer: choice of carton, grasp, way there and to the conveyor, certificate;
//! and all cartons of a picture.
#![allow(missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use depal_arm::Arm;
use depal_frames::{BoxSize, JointPositions, PlacedShape, Pose, Vector};
use depal_gripper::GripperSpec;
use depal_planner::{PlaceSpec, PlanRequest, PlannerSettings, SeenBox, plan_pick};

const ACCELERATIONS: [f64; 6] = [3.0, 3.0, 3.0, 7.0, 7.0, 8.7];

fn layer(top: f64) -> Vec<SeenBox> {
    cartons(top, 2)
}

/// `columns` of four, side by side.
fn cartons(top: f64, columns: u32) -> Vec<SeenBox> {
    let size = BoxSize {
        length: 0.4,
        width: 0.3,
        height: 0.25,
    };
    let mut boxes = Vec::new();
    for column in 0..columns {
        for row in 0..4 {
            let x = 1.7 + (f64::from(column) - f64::from(columns - 1) * 0.5) * 0.404;
            let y = (f64::from(row) - 1.5) * 0.304;
            boxes.push(SeenBox {
                base_from_box: Pose::translation(x, y, top),
                size,
                confidence: 0.95,
            });
        }
    }
    boxes
}

fn bench_plan(criterion: &mut Criterion) {
    let urdf = include_str!("../../../urdf/abb_irb6700_150_320.urdf");
    let arm = Arm::from_urdf(urdf, "irb6700", &ACCELERATIONS).expect("our own URDF");
    let gripper = GripperSpec::four_sections();
    let block =
        |x, y, z, a, b, c| PlacedShape::cuboid(Pose::translation(x, y, z), Vector::new(a, b, c));
    let known = [
        block(0.0, 0.0, -0.05, 12.0, 12.0, 0.1),
        block(1.7, 0.0, 0.072, 0.8, 1.2, 0.144),
        block(-0.4, 1.8, 0.325, 3.0, 0.6, 0.65),
    ];
    let place = PlaceSpec {
        base_from_place: Pose::translation(0.5, 1.8, 0.65),
        yaws: vec![0.0, std::f64::consts::PI],
    };
    let settings = PlannerSettings::default();
    for (name, top) in [("top layer", 1.644), ("bottom layer", 0.394)] {
        let boxes = layer(top);
        let request = PlanRequest {
            arm: &arm,
            gripper: &gripper,
            boxes: &boxes,
            known_obstacles: &known,
            obstacle_points: &[],
            start: JointPositions::from_degrees(&[90.0, -20.0, 20.0, 0.0, 90.0, 0.0]),
            place: &place,
            settings: &settings,
        };
        plan_pick(&request).unwrap_or_else(|refusal| panic!("{name}: {refusal}"));
        criterion.bench_function(&format!("plan a pick, {name}"), |bencher| {
            bencher.iter(|| plan_pick(&request));
        });
    }
    bench_picture(criterion, &arm, &gripper, &known, &place);
}

/// One picture, carton after carton: what is picked is gone for the next. By one thread, and by all;
/// and a picture of which nothing can be had, where every candidate is tried to its end.
fn bench_picture(
    criterion: &mut Criterion,
    arm: &Arm,
    gripper: &GripperSpec,
    known: &[PlacedShape],
    place: &PlaceSpec,
) {
    let settings = PlannerSettings::default();
    let seen = cartons(1.1, 4);
    let home = JointPositions::from_degrees(&[90.0, -20.0, 20.0, 0.0, 90.0, 0.0]);
    let request = |boxes: &[SeenBox], known_obstacles: &[PlacedShape], start: JointPositions| {
        let request = PlanRequest {
            arm,
            gripper,
            boxes,
            known_obstacles,
            obstacle_points: &[],
            start,
            place,
            settings: &settings,
        };
        plan_pick(&request)
    };
    let picture = || {
        let (mut left, mut start) = (seen.clone(), home);
        while !left.is_empty() {
            let plan = request(&left, known, start).unwrap_or_else(|refusal| panic!("{refusal}"));
            start = plan.waypoints[plan.waypoints.len() - 1].joints;
            left.remove(plan.box_index);
        }
    };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let one = one.expect("a thread");
    let name = "plan a picture of 16 cartons, one after another";
    criterion.bench_function(&format!("{name}, one thread"), |bencher| {
        one.install(|| bencher.iter(picture));
    });
    criterion.bench_function(name, |bencher| bencher.iter(picture));
    let roof = Pose::translation(1.7, 0.0, 1.25);
    let mut roofed = known.to_vec();
    roofed.push(PlacedShape::cuboid(roof, Vector::new(2.0, 2.0, 0.1)));
    assert!(request(&seen, &roofed, home).is_err());
    for (threads, pool) in [("one thread", Some(&one)), ("all threads", None)] {
        let name = format!("refuse 16 cartons under a roof, {threads}");
        criterion.bench_function(&name, |bencher| {
            let mut refuse = || bencher.iter(|| request(&seen, &roofed, home));
            match pool {
                Some(pool) => pool.install(refuse),
                None => refuse(),
            }
        });
    }
}

criterion_group!(benches, bench_plan);
criterion_main!(benches);
