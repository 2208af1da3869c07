//! A camera on the flange: what it sees depends on where the arm is, and what comes of it on what the robot tells.

use depal_cell::cell::EndState;
use depal_cell::event::FailureReason;
use depal_cell::spec::CellSpec;
use depal_frames::nalgebra::Quaternion;
use depal_frames::{EulerConvention, Point, Pose, Rotation, Vector};
use depal_interface::CalibrationPose;
use serde_json::Value as Json;

use crate::runner::{root, run_scene, scene};
use crate::talk::Talk;

/// Where `scenes/eye_in_hand.mod` looks from: the flange above the pallet, X along its long side, Z down.
fn base_from_look() -> Pose {
    Pose::from_parts(
        Vector::new(1.38, 0.0, 2.05).into(),
        Rotation::new_normalize(Quaternion::new(0.0, 1.0, 1.0, 0.0)),
    )
}

/// Mean error over the corners of the pallet volume up to `height` metres above the deck, seen from where pictures
/// are taken, mm.
fn corner_error_mm(spec: &CellSpec, flange_from_camera: &Pose, height: f64) -> f64 {
    let truth = spec.true_carrier_from_camera();
    let corners = (0..8).map(|k| {
        let side = |bit: usize| if k & bit == 0 { -0.5 } else { 0.5 };
        let up = 0.144 + height * (side(4) + 0.5);
        let corner = Point::new(1.7 + 0.8 * side(1), 1.2 * side(2), up);
        let in_flange = base_from_look().inverse() * corner;
        (flange_from_camera * truth.inverse_transform_point(&in_flange) - in_flange).norm() * 1e3
    });
    corners.sum::<f64>() / 8.0
}

fn logged_pose(logged: &Json) -> Pose {
    let xyz_mm: [f64; 3] = serde_json::from_value(logged["xyz_mm"].clone()).unwrap();
    let [w, x, y, z]: [f64; 4] = serde_json::from_value(logged["quat_wxyz"].clone()).unwrap();
    Pose::from_parts(
        (Vector::from(xyz_mm) * 1e-3).into(),
        Rotation::new_normalize(Quaternion::new(w, x, y, z)),
    )
}

#[test]
fn picks_succeed_after_the_calibration() {
    let scene = scene("eye_in_hand_calibration", &[], None);
    let finished = run_scene(&scene);
    assert_eq!(finished.delivered(), 16, "{}", finished.outcome.end_detail);
    assert_eq!(finished.outcome.score.false_picks, 0);
    let calibrated = finished.events("calibrated");
    let [event] = calibrated.as_slice() else {
        panic!("{calibrated:?}");
    };
    assert_eq!((&event["used"], &event["taken"]), (&15.into(), &15.into()));
    assert!(event.get("base_from_camera").is_none(), "it has none");
    let found = logged_pose(&event["flange_from_camera"]);
    let spec = scene.cell_spec().unwrap();
    let error = corner_error_mm(&spec, &found, 1.5);
    println!("corners {error:.3} mm, {event}");
    assert!(error < 0.5, "{error} mm at the corners");
    let before = corner_error_mm(&spec, &spec.carrier_from_camera, 1.5);
    assert!(before > 50.0, "{before} mm before the calibration");
}

/// Seeds 1 to 5, the calibration alone; behind `DEPAL_SLOW=1`.
#[test]
fn the_calibration_holds_for_five_seeds() {
    if std::env::var_os("DEPAL_SLOW").is_none() {
        return;
    }
    let program = root().join("tests/programs/calibrate_by_poses.mod");
    for seed in 1..=5 {
        let overrides = [
            ("robot.program", &*program.to_string_lossy()),
            ("run.may_leave_cartons", "true"),
        ];
        let scene = scene("eye_in_hand_calibration", &overrides, Some(seed));
        let finished = run_scene(&scene);
        let calibrated = finished.events("calibrated");
        let found = logged_pose(&calibrated[0]["flange_from_camera"]);
        let spec = scene.cell_spec().unwrap();
        let error = [1.5, 0.5].map(|height| corner_error_mm(&spec, &found, height));
        println!(
            "seed {seed}: {:.3} mm over the pallet volume, {:.3} mm over two layers, {}",
            error[0], error[1], calibrated[0]
        );
        assert!(error.iter().all(|e| *e < 0.5), "seed {seed}: {error:?} mm");
    }
}

#[test]
fn without_the_calibration_picks_fail() {
    // The same cell; the program does not call MM_Calib.
    let program = root().join("scenes/eye_in_hand.mod");
    let overrides = [("robot.program", &*program.to_string_lossy())];
    let finished = run_scene(&scene("eye_in_hand_calibration", &overrides, None));
    let count = finished.delivered();
    println!(
        "{count} delivered, {:?}",
        finished.outcome.score.failures_by_reason()
    );
    assert!(finished.events("calibrated").is_empty());
    assert!(count < 8, "{count} delivered");
    assert!(finished.outcome.score.false_picks > 0);
}

#[test]
fn a_robot_that_does_not_tell_where_it_is_gets_no_picture() {
    // It sends the joints that its path shall start from, as programs for a camera on a stand do.
    let program = root().join("scenes/demo.mod");
    let overrides = [("robot.program", &*program.to_string_lossy())];
    let finished = run_scene(&scene("eye_in_hand", &overrides, None));
    assert_eq!(finished.outcome.score.statuses.get(&2013), Some(&1));
    assert!(finished.events("exposure").is_empty());
    assert!(finished.outcome.score.picks.is_empty());
    assert_eq!(finished.delivered(), 0);
    assert_ne!(finished.outcome.end, EndState::Finished);
    let reasons = finished.outcome.score.failures_by_reason();
    assert_eq!(
        reasons.into_keys().collect::<Vec<_>>(),
        [FailureReason::ProtocolError]
    );
}

#[test]
fn a_robot_that_moves_on_was_not_where_it_said() {
    let program = root().join("tests/programs/moves_while_looking.mod");
    let overrides = [
        ("robot.program", &*program.to_string_lossy()),
        ("run.may_leave_cartons", "true"),
    ];
    let moved = run_scene(&scene("eye_in_hand", &overrides, None));
    let seen = moved.events("vision");
    let [frame] = seen.as_slice() else {
        panic!("{seen:?}");
    };
    // Every carton is found, and every one 100 mm beside its place: nearer to none than 20 mm.
    let detections = frame["detections"].as_array().unwrap();
    assert!(detections.len() >= 6, "{}", detections.len());
    assert_eq!(
        moved.outcome.score.false_picks,
        detections.len() as u64,
        "{frame}"
    );
    // The camera went 100 mm along +Y and vision was not told: the places lie 100 mm along -Y.
    let spec = scene("eye_in_hand", &[], None).cell_spec().unwrap();
    for detection in detections {
        let at = logged_pose(&detection["world_from_box"]).translation.vector;
        let true_place = at + Vector::new(0.0, 0.1, 0.0);
        let nearest = spec
            .cartons
            .iter()
            .map(|carton| {
                let top = carton.world_from_centre * Pose::translation(0.0, 0.0, 0.125);
                (top.translation.vector - true_place).norm()
            })
            .fold(f64::INFINITY, f64::min);
        assert!(nearest < 0.006, "{nearest} m beside");
    }
}

#[test]
fn a_camera_behind_the_gripper_sees_the_gripper() {
    // At the flange, looking along the tool: the plate fills the picture, and what it hides is not found.
    let overrides = [
        ("camera.xyz_mm", "[0, 0, 0]"),
        ("camera.look_at_mm", "[0, 0, 1000]"),
        ("camera.near_mm", "100"),
        ("run.may_leave_cartons", "true"),
    ];
    let finished = run_scene(&scene("eye_in_hand", &overrides, None));
    let seen = finished.events("vision");
    assert_eq!(seen.len(), 1, "{seen:?}");
    assert_eq!(seen[0]["pickable"], 0);
    assert!(finished.outcome.score.picks.is_empty());
}

/// Positions of the vision points of project 1, mm.
fn points(talk: &mut Talk, robot_pose: &str) -> Vec<[f64; 3]> {
    assert_eq!(talk.ask(&format!("101,1,0,{robot_pose}"))[0], 1102.0);
    let cells = talk.ask("102,1");
    assert_eq!(cells[0], 1100.0, "{cells:?}");
    let points = cells[4..].chunks_exact(8);
    points.map(|p| [p[0], p[1], p[2]]).collect()
}

fn cells(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(f64::to_string).collect();
    values.join(",")
}

fn flange(base_from_flange: &Pose) -> String {
    cells(&EulerConvention::AbbZyx.mm_deg_from_pose(base_from_flange))
}

#[test]
fn points_go_through_the_flange_that_command_101_tells() {
    let ascii = [("interface.encoding", "ascii")];
    let spec = scene("eye_in_hand", &ascii, None).cell_spec().unwrap();
    let joints = spec
        .arm
        .inverse_nearest(&base_from_look(), &spec.controller.start)
        .unwrap();
    let joints = cells(&joints.to_degrees());
    let tops: Vec<[f64; 3]> = spec
        .cartons
        .iter()
        .map(|carton| {
            let top = carton.world_from_centre * Pose::translation(0.0, 0.0, 0.125);
            (top.translation.vector * 1e3).into()
        })
        .filter(|top: &[f64; 3]| top[2] > 500.0)
        .collect();
    let mut talk = Talk::new(spec);
    // Nothing, and the start of a path: neither says where the camera is. Nor do zeros or far-away places.
    assert_eq!(talk.ask("101,1,0,0,0,0,0,0,0,0")[0], 1006.0);
    assert_eq!(talk.ask(&format!("101,1,0,3,{joints}"))[0], 1006.0);
    assert_eq!(talk.ask("201,0,0,0,0,0,0,0")[0], 2013.0);
    assert_eq!(talk.ask(&format!("201,2,{joints}"))[0], 2013.0);
    assert_eq!(
        talk.ask(&format!("201,1,{joints},99999,0,0,0,0,0"))[0],
        2013.0
    );
    assert_eq!(talk.ask("102,1")[0], 1020.0, "none of them began a run");

    // From three places, told in three ways: the same cartons.
    let aside = base_from_look() * Pose::translation(0.06, -0.05, -0.2);
    let tilted = base_from_look()
        * Pose::from_parts(
            Vector::new(0.0, -0.25, 0.0).into(),
            Rotation::from_euler_angles(-0.12, 0.0, 0.2),
        );
    for told in [
        format!("2,{}", flange(&base_from_look())),
        format!("2,{}", flange(&aside)),
        format!("2,{}", flange(&tilted)),
        format!("1,{joints},{}", flange(&base_from_look())),
        format!("1,{joints},0,0,0,0,0,0"),
    ] {
        let points = points(&mut talk, &told);
        assert_eq!(points.len(), 8, "{told}");
        for point in points {
            let distance = |top: &[f64; 3]| {
                (0..3)
                    .map(|k| (top[k] - point[k]).powi(2))
                    .sum::<f64>()
                    .sqrt()
            };
            let nearest = tops.iter().map(distance).fold(f64::INFINITY, f64::min);
            assert!(nearest < 6.0, "{told}: {point:?} {nearest} mm beside");
        }
    }
}

/// What a calibration with these flange poses ends in.
fn calibrated_with(flanges: &[Pose]) -> Vec<String> {
    let overrides = [("interface.encoding", "ascii")];
    let scene = scene("eye_in_hand_calibration", &overrides, None);
    let mut spec = scene.cell_spec().unwrap();
    let joints = spec.controller.start;
    spec.interface.calibration = flanges
        .iter()
        .map(|base_from_flange| CalibrationPose {
            base_from_flange: *base_from_flange,
            joints,
        })
        .collect();
    let mut talk = Talk::new(spec);
    let joints = cells(&joints.to_degrees());
    let mut state = 0;
    for place in flanges.iter().chain(flanges.last()) {
        let reply = talk.ask(&format!("701,{state},{},{joints}", flange(place)));
        assert_eq!(reply[0], 7101.0);
        state = 1;
    }
    let mut said = Vec::new();
    talk.0.advance_waiting(talk.0.tick() + 10);
    while let Some((_, event)) = talk.0.poll_event() {
        said.push(serde_json::to_string(&event).unwrap());
    }
    said
}

#[test]
fn motions_that_leave_the_camera_open_are_refused() {
    // From `scenes/eye_in_hand_calibration.toml`: the board on the stack, the flange 1.2 m above it.
    let above = base_from_look();
    let shifts = [
        [0.0, 0.0, 0.0],
        [0.1, 0.0, 0.1],
        [-0.1, 0.1, 0.0],
        [0.0, -0.1, -0.1],
    ];
    let shifted: Vec<Pose> = shifts
        .map(|[x, y, z]| above * Pose::translation(x, y, z))
        .into();
    let turned: Vec<Pose> = shifts
        .iter()
        .enumerate()
        .map(|(n, [x, y, z])| {
            // About the middle of the board, and about the vertical only.
            let middle = Pose::translation(1.7, 0.0, 0.0);
            let turn = Rotation::from_euler_angles(0.0, 0.0, 0.3 * n as f64);
            let about = middle * Pose::from_parts(Vector::zeros().into(), turn) * middle.inverse();
            about * above * Pose::translation(*x, *y, *z)
        })
        .collect();
    let leaned: Vec<Pose> = turned
        .iter()
        .enumerate()
        .map(|(n, pose)| {
            let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
            let lean = Rotation::from_euler_angles(0.15 * sign, 0.1, 0.0);
            pose * Pose::from_parts(Vector::zeros().into(), lean)
        })
        .collect();
    let has = |said: &[String], text: &str| said.iter().any(|line| line.contains(text));
    let said = calibrated_with(&shifted);
    assert!(
        has(&said, "no calibration: the flange turned by 0.00"),
        "{said:#?}"
    );
    assert!(!has(&said, "\"calibrated\""));
    let said = calibrated_with(&turned);
    assert!(
        has(&said, "no calibration: all rotation axes are parallel to"),
        "{said:#?}"
    );
    assert!(!has(&said, "\"calibrated\""));
    // The same places with the tool leaned two ways are enough.
    let said = calibrated_with(&leaned);
    assert!(has(&said, "\"calibrated\""), "{said:#?}");
}
