//! Each function by its registers.

use depal_wire::Status;
use depal_wire::s7::Field;

use super::bench::*;
use crate::*;

#[test]
fn every_function_succeeds_once() {
    let mut b = Bench::new();
    b.set(Field::Project, 1);
    assert_eq!(b.call(901), 1101);
    b.set(Field::Recipe, 2);
    assert_eq!(b.call(103), 1107);
    for (place, side) in [400.0, 300.0, 200.0].into_iter().enumerate() {
        b.block.set_real(Field::BoxSize, place, side);
    }
    assert_eq!(b.call(501), 1108);
    b.block.set_real(Field::OuterPose, 0, 1200.0);
    assert_eq!(b.call(502), 2107);
    assert_eq!(b.call(101), 1102);
    assert_eq!(b.call(102), 1100);
    b.set(Field::Project, 3);
    assert_eq!(b.call(101), 1102);
    assert_eq!(b.call(110), 1100);
    b.set(Field::Project, 2);
    assert_eq!(b.call(101), 1102);
    b.set(Field::PoseType, 1);
    assert_eq!(b.call(105), 1103);
    assert_eq!(b.call(206), 1106);
    b.set(Field::PoseType, 0);
    assert_eq!(b.call(101), 1102);
    b.set(Field::PoseType, 2);
    assert_eq!(b.call(210), 1103);
    b.set(Field::Project, 0);
    assert_eq!(b.call(201), 2103);
    b.set(Field::IndexStep, 4);
    b.set(Field::IndexCounter, 9);
    assert_eq!(b.call(204), 2106);
    b.set(Field::BranchStep, 2);
    b.set(Field::BranchExit, 3);
    assert_eq!(b.call(203), 2105);
    assert_eq!(b.call(205), 2100);
    assert_eq!(b.call(206), 2102);
    assert_eq!(b.call(202), 2104);
    assert_eq!(b.call(201), 2103);
    b.set(Field::PoseType, 4);
    assert_eq!(b.call(210), 2100);

    let size = b.jobs.iter().find_map(|job| match job {
        Job::RunVision {
            recipe, box_size, ..
        } => Some((*recipe, box_size.map(depal_frames::BoxSize::to_mm))),
        _ => None,
    });
    assert_eq!(size, Some((Some(2), Some([400.0, 300.0, 200.0]))));
    let exit = b.jobs.iter().any(|job| {
        matches!(
            job,
            Job::SetIndex {
                step: 4,
                index: 8,
                ..
            }
        )
    });
    assert!(exit, "{:?}", b.jobs);
}

#[test]
fn vision_points() {
    let mut b = Bench::new();
    b.set(Field::Project, 1);
    b.results.points = Ok(points(22));
    b.call(101);
    assert_eq!(b.call(102), 1100);
    assert!(b.is_set(Field::PoseSent));
    assert_eq!(
        (b.int(Field::PoseCount), b.int(Field::VisionMoveIndex)),
        (20, 0)
    );
    // The object's pose, turned by 180 degrees about its own X.
    assert_eq!(
        b.block.reals::<6>(Field::TargetPose),
        [100.0, 250.0, 500.0, 0.0, 0.0, 180.0]
    );
    assert_eq!(b.block.real(Field::TargetPose, 19 * 6), 2000.0);
    assert_eq!(b.block.int(Field::TargetLabel, 19), 20);
    // The rest with the next call; rows of the first one are cleared.
    assert_eq!(b.call(102), 1100);
    assert_eq!(b.int(Field::PoseCount), 2);
    assert_eq!(b.block.int(Field::TargetLabel, 1), 22);
    assert_eq!(b.block.int(Field::TargetLabel, 2), 0);
    assert_eq!(b.block.real(Field::TargetPose, 2 * 6), 0.0);
    // Nothing left: a status, and no new data.
    assert_eq!(b.call(102), 1002);
    assert!(!b.is_set(Field::PoseSent));
    assert_eq!(b.int(Field::PoseCount), 2);
}

#[test]
fn a_path_with_tools() {
    let mut b = Bench::new();
    b.results.path = Ok(path(5, 2));
    b.call(201);
    b.set(Field::PoseType, 1);
    assert_eq!(b.call(205), 2100);
    assert!(b.is_set(Field::PoseSent));
    assert_eq!(
        (b.int(Field::PoseCount), b.int(Field::VisionMoveIndex)),
        (5, 3)
    );
    assert_eq!(
        b.block.reals::<6>(Field::TargetPose),
        [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    );
    assert_eq!(b.block.int(Field::TargetLabel, 2), 7);
    assert_eq!(b.block.int(Field::TargetTool, 4), 1);
    assert_eq!(b.block.int(Field::TargetTool, 5), 0);
    assert_eq!(b.call(206), 2102);
    let list: Vec<i16> = (0..5)
        .map(|i| b.block.int(Field::DigitalOutput, i))
        .collect();
    assert_eq!(list, [1, 3, 4, -1, -1]);
    assert_eq!(b.block.int(Field::DigitalOutput, 63), -1);
    assert!(!b.is_set(Field::PoseSent), "206 sends no pose");
}

#[test]
fn plan_data_in_one_call() {
    let mut b = Bench::new();
    b.results.path = Ok(path(3, 1));
    b.results.path.as_mut().expect("a path").custom_ports = vec![CustomPort {
        name: "c".to_owned(),
        rows: vec![(1..13).map(f64::from).collect()],
    }];
    b.call(201);
    b.set(Field::PoseType, 4);
    assert_eq!(b.call(210), 2100);
    assert!(b.is_set(Field::PoseSent));
    assert_eq!(
        (b.int(Field::PoseCount), b.int(Field::VisionMoveIndex)),
        (3, 2)
    );
    let row =
        |field: Field, n: usize| -> Vec<i16> { (0..n).map(|i| b.block.int(field, i)).collect() };
    assert_eq!(row(Field::IsVisionMove, 4), [0, 1, 0, 0]);
    assert_eq!(row(Field::MoveType, 4), [1, 2, 1, 0]);
    assert_eq!(row(Field::Speed, 4), [80, 80, 80, 0]);
    assert_eq!(row(Field::TargetLabel, 4), [0, 7, 0, 0]);
    assert_eq!(row(Field::TargetTool, 4), [1, 1, 1, 0]);
    assert_eq!(b.block.real(Field::TargetPose, 6), 200.0);
    let custom: Vec<f32> = (0..30)
        .map(|i| b.block.real(Field::CustomOutput, i))
        .collect();
    assert_eq!(&custom[..10], &[0.0; 10]);
    assert_eq!(
        &custom[10..20],
        &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0]
    );
    assert_eq!(&custom[20..], &[0.0; 10]);
    let plan: Vec<f32> = (0..120)
        .map(|i| b.block.real(Field::PlanResult, i))
        .collect();
    assert_eq!(
        &plan[40..61],
        &[
            7.0, 8.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 2.0, 1.0, 10.0, 0.0, 0.0, 0.0,
            1.0, 400.0, 300.0, 200.0
        ]
    );
    assert!(
        plan[..40]
            .iter()
            .chain(&plan[61..])
            .all(|value| *value == 0.0)
    );
    assert_eq!(b.call(210), 2022, "everything has been fetched");
    // Without plan data the labels are there all the same.
    b.set(Field::PoseType, 0);
    assert_eq!(b.call(201), 2103);
    b.set(Field::PoseType, 1);
    assert_eq!(b.call(210), 2100);
    assert_eq!(b.block.real(Field::TargetPose, 0), 1.0);
    assert_eq!(b.block.int(Field::TargetLabel, 1), 7);
    assert!((0..1600).all(|i| b.block.real(Field::PlanResult, i) == 0.0));
}

#[test]
fn custom_data_in_one_call() {
    let mut b = Bench::new();
    b.set(Field::Project, 3);
    b.call(101);
    assert_eq!(b.call(110), 1100);
    assert!(b.is_set(Field::PoseSent));
    assert_eq!(b.int(Field::PoseCount), 2);
    // Ports in alphabetical order.
    let custom: Vec<f32> = (0..20)
        .map(|i| b.block.real(Field::CustomOutput, i))
        .collect();
    assert_eq!(&custom[..4], &[-1.0, 0.5, 0.0, 0.0]);
    assert_eq!(&custom[10..14], &[-2.0, 0.5, 1.0, 0.0]);
    assert_eq!(b.block.int(Field::TargetLabel, 1), 2);
}

/// More waypoints than the cap: further calls get the rest.
#[test]
fn plan_data_of_a_long_path() {
    let mut b = Bench::new();
    b.results.path = Ok(path(45, 22));
    b.call(201);
    b.set(Field::PoseType, 3);
    for (count, vision_move) in [(20, 0), (20, 3), (5, 0)] {
        assert_eq!(b.call(210), 2100);
        assert_eq!(b.int(Field::PoseCount), count);
        assert_eq!(b.int(Field::VisionMoveIndex), vision_move);
    }
    assert_eq!(b.block.real(Field::TargetPose, 0), 41.0);
    assert_eq!(b.block.real(Field::TargetPose, 5 * 6), 0.0);
}

#[test]
fn messages() {
    let mut b = Bench::new();
    b.results.latency = ms(5_000);
    b.call(201);
    let Some(Job::StartViz { job_id, .. }) = b.jobs.last().cloned() else {
        panic!("{:?}", b.jobs);
    };
    b.server.notify(b.now, job_id, 1001);
    b.set(Field::Command, 601);
    b.trigger(true);
    b.run_until("the message", |b| b.int(Field::Notify) != 0);
    assert_eq!(b.int(Field::Notify), 1001);
    assert!(b.is_set(Field::Acknowledge));
    b.trigger(false);
    b.run(ms(100));
    assert_eq!(b.int(Field::Status), 0, "a message has no status");
    assert!(!b.is_set(Field::PoseSent));
    // None in time: 0.
    b.set(Field::Notify, 0x55);
    b.trigger(true);
    let waited = b.run_until("no message", |b| b.int(Field::Notify) == 0);
    assert!(waited >= ms(2_000) && waited < ms(2_100), "{waited:?}");
}

/// What is refused, and how.
#[test]
fn refusals() {
    type Change = fn(&mut Bench);
    let cases: [(i16, i16, Change); 22] = [
        (0, 3001, |_| ()),
        (-5, 3001, |_| ()),
        (999, 3001, |_| ()),
        (106, 3001, |_| ()),
        (701, 3001, |_| ()),
        (101, 1011, |b| b.set(Field::Project, 9)),
        (101, 1018, |b| b.set(Field::PoseNumber, -2)),
        (101, 1005, |b| b.set(Field::PoseType, 9)),
        (101, 1006, |b| {
            b.set(Field::PoseType, 2);
            b.block.set_real(Field::Flange, 0, f32::NAN);
        }),
        (101, 1006, |b| {
            b.set(Field::PoseType, 1);
            b.block.set_real(Field::Joints, 5, f32::INFINITY);
        }),
        (101, 1006, |b| {
            b.set(Field::PoseType, 2);
            b.block.set_real(Field::Flange, 1, 1e38);
        }),
        (201, 2013, |b| {
            b.set(Field::PoseType, 2);
            b.block.set_real(Field::Joints, 0, f32::NEG_INFINITY);
        }),
        (502, 2013, |b| {
            b.block.set_real(Field::OuterPose, 3, f32::NAN);
        }),
        (501, 1022, |b| b.block.set_real(Field::BoxSize, 0, f32::NAN)),
        (501, 1022, |_| ()),
        (102, 1020, |_| ()),
        (205, 2012, |b| b.set(Field::PoseType, 3)),
        (205, 2022, |b| b.set(Field::PoseType, 2)),
        (206, 3002, |b| {
            b.set(Field::Project, 0);
            b.set(Field::Sections, 65);
        }),
        (206, 2011, |b| b.set(Field::Project, 0)),
        (203, 2024, |b| b.set(Field::BranchStep, 77)),
        (210, 1026, |b| {
            b.set(Field::Project, 2);
            b.set(Field::PoseType, 3);
        }),
    ];
    for (command, status, change) in cases {
        let mut b = Bench::new();
        b.set(Field::Project, 1);
        change(&mut b);
        assert_eq!(b.call(command), status, "command {command}");
        assert!(!b.is_set(Field::PoseSent), "command {command}");
        assert_eq!(b.call(901), 1101, "after command {command}");
    }
}

/// Reals of registers that a pose type does not use may hold anything.
#[test]
fn unused_registers_do_not_matter() {
    let mut b = Bench::new();
    b.set(Field::Project, 1);
    b.block.set_real(Field::Joints, 0, f32::NAN);
    b.block.set_real(Field::Flange, 0, f32::NAN);
    assert_eq!(b.call(101), 1102);
}

#[test]
fn labels_that_do_not_fit() {
    let mut b = Bench::new();
    b.set(Field::Project, 1);
    let label = |value| VisionResult {
        points: vec![point(0.1, value)],
        ..VisionResult::default()
    };
    b.results.points = Ok(label(32_767));
    b.call(101);
    assert_eq!(b.call(102), 1100);
    assert_eq!(b.block.int(Field::TargetLabel, 0), 32_767);
    b.results.points = Ok(label(32_768));
    b.call(101);
    assert_eq!(b.call(102), 1017);
    assert!(!b.is_set(Field::PoseSent));
}

/// A fault of the run is a status like any other.
#[test]
fn faults_of_a_run() {
    let mut b = Bench::new();
    b.results.path = Err(Status::VizCollision);
    b.call(201);
    b.set(Field::PoseType, 2);
    assert_eq!(b.call(205), 2031);
    b.results.points = Ok(VisionResult::default());
    b.set(Field::Project, 1);
    b.call(101);
    b.call(101);
    assert_eq!(b.call(102), 1002);
    // A run that is too slow.
    b.results.latency = ms(3_000);
    b.set(Field::PoseType, 0);
    b.call(101);
    assert_eq!(b.call(102), 1019);
}
