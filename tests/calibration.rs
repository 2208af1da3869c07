//! Command 701 from a RAPID program to the last picture: a camera that hangs elsewhere than believed.

use depal_cell::event::EventKind;
use depal_frames::nalgebra::Quaternion;
use depal_frames::{EulerConvention, Point, Pose, Rotation, Vector};
use depal_scene::Scene;

use crate::runner::{root, run_scene, scene};
use crate::talk::Talk;

fn pose(xyz_mm: [f64; 3], [w, x, y, z]: [f64; 4]) -> Pose {
    Pose::from_parts(
        (Vector::from(xyz_mm) * 1e-3).into(),
        Rotation::new_normalize(Quaternion::new(w, x, y, z)),
    )
}

/// Mean error over the corners of the pallet volume, mm.
fn corner_error_mm(scene: &Scene, base_from_camera: &Pose) -> f64 {
    let spec = scene.cell_spec().expect("a sound scene");
    let truth = spec.true_carrier_from_camera();
    let corners = (0..8).map(|k| {
        let side = |bit: usize| if k & bit == 0 { -0.5 } else { 0.5 };
        let height = 0.144 + 1.5 * (side(4) + 0.5);
        Point::new(1.7 + 0.8 * side(1), 1.2 * side(2), height)
    });
    let errors =
        corners.map(|c| (base_from_camera * truth.inverse_transform_point(&c) - c).norm() * 1e3);
    errors.sum::<f64>() / 8.0
}

#[test]
fn picks_succeed_after_the_calibration() {
    let scene = scene("calibration", &[], None);
    let finished = run_scene(&scene);
    assert_eq!(finished.delivered(), 16);
    assert_eq!(finished.outcome.score.false_picks, 0);
    let calibrated = finished.events("calibrated");
    let [event] = calibrated.as_slice() else {
        panic!("{calibrated:?}");
    };
    assert_eq!((&event["used"], &event["taken"]), (&15.into(), &15.into()));
    let logged = &event["base_from_camera"];
    let found = pose(
        serde_json::from_value(logged["xyz_mm"].clone()).unwrap(),
        serde_json::from_value(logged["quat_wxyz"].clone()).unwrap(),
    );
    let error = corner_error_mm(&scene, &found);
    println!("corners {error:.3} mm, {event}");
    assert!(error < 0.5, "{error} mm at the corners");

    // The last reply sends the robot back to where it began.
    let replies: Vec<String> = finished
        .events("protocol")
        .iter()
        .filter(|e| e["command"] == 701 && e["from"] == "vision")
        .map(|e| e["text"].as_str().unwrap().to_owned())
        .collect();
    assert_eq!(replies.len(), 16);
    assert!(replies[..15].iter().all(|r| r.starts_with("701,7101,0,")));
    let last: Vec<f64> = replies[15]
        .split([',', ' '])
        .take(15)
        .map(|cell| cell.parse().unwrap())
        .collect();
    assert_eq!(last[..3], [701.0, 7101.0, 1.0]);
    let start = &scene.robot.start_joints_deg;
    assert!(
        last[9..]
            .iter()
            .zip(start)
            .all(|(a, b)| (a - b).abs() < 1e-3)
    );
}

#[test]
fn without_the_calibration_picks_fail() {
    // The same cell; the program does not call MM_Calib.
    let program = root().join("scenes/demo.mod");
    let overrides = [("robot.program", &*program.to_string_lossy())];
    let finished = run_scene(&scene("calibration", &overrides, None));
    println!(
        "{} delivered, {:?}",
        finished.delivered(),
        finished.outcome.score.failures_by_reason()
    );
    assert!(finished.events("calibrated").is_empty());
    assert!(
        finished.delivered() < 8,
        "{} delivered",
        finished.delivered()
    );
    assert!(finished.outcome.score.false_picks > 0);
}

#[test]
fn flange_poses_serve_as_well_as_joints() {
    let program = root().join("tests/programs/calibrate_by_poses.mod");
    let overrides = [
        ("robot.program", &*program.to_string_lossy()),
        ("run.may_leave_cartons", "true"),
    ];
    let finished = run_scene(&scene("calibration", &overrides, None));
    let calibrated = finished.events("calibrated");
    assert_eq!(calibrated.len(), 1, "{}", finished.outcome.end_detail);
    let error = calibrated[0]["error_mm"].as_f64().unwrap();
    assert!(error < 0.5, "{error} mm");
    let messages = finished.events("message");
    assert!(messages.iter().any(|m| m["text"] == "back again"));
}

#[test]
fn without_pictures_the_old_pose_stays() {
    let finished = run_scene(&scene("calibration", &[("camera.blackout", "true")], None));
    assert!(finished.events("calibrated").is_empty());
    let messages = finished.events("message");
    let said = |text: &str| {
        messages
            .iter()
            .filter(|e| e["text"].as_str().unwrap().contains(text))
            .count()
    };
    assert_eq!(said("no grid among them"), 15);
    assert_eq!(said("expected at least 3 usable captures, found 0"), 1);
}

/// A client without a robot: it claims to be where it is sent.
#[test]
fn a_client_of_the_station_calibrates_as_well() {
    for name in ["calibration", "interface"] {
        client_calibrates(&scene(name, &[("interface.encoding", "ascii")], None));
    }
}

/// There is no board: the robot hears it at once, and the log says why.
#[test]
fn without_a_calibration_set_up_701_is_refused() {
    let ascii = [("interface.encoding", "ascii")];
    let mut talk = Talk::new(scene("demo", &ascii, None).cell_spec().unwrap());
    talk.says("701,0,1500,0,1500,180,0,180,0,-20,20,0,90,0", 7001);
    let mut said = Vec::new();
    while let Some((_, event)) = talk.0.poll_event() {
        if let EventKind::Message { text } = event.kind {
            said.push(text);
        }
    }
    assert!(
        said.iter()
            .any(|text| text.contains("no calibration is set up")),
        "{said:?}"
    );
}

fn client_calibrates(scene: &Scene) {
    let spec = scene.cell_spec().unwrap();
    let poses = spec.interface.calibration.clone();
    let mut talk = Talk::new(spec);
    let mut place = (
        EulerConvention::AbbZyx.mm_deg_from_pose(&poses[0].base_from_flange),
        poses[0].joints.to_degrees(),
    );
    for state in 0..=poses.len() {
        let cells: Vec<String> = place.0.iter().chain(&place.1).map(f64::to_string).collect();
        let reply = talk.ask(&format!("701,{},{}", i32::from(state > 0), cells.join(",")));
        assert_eq!(reply[0], 7101.0);
        assert_eq!(reply[1], f64::from(state == poses.len()));
        place = (reply[2..8].try_into().unwrap(), reply[8..14].to_vec());
    }
    // The last picture is taken, and the pose found, after the reply.
    talk.0.advance_waiting(talk.0.tick() + 10);
    let mut found = Vec::new();
    while let Some((_, event)) = talk.0.poll_event() {
        if let EventKind::Calibrated {
            base_from_camera,
            error_mm,
            ..
        } = event.kind
        {
            let logged = base_from_camera.expect("a camera that stands still");
            let pose = pose(logged.xyz_mm, logged.quat_wxyz);
            found.push((corner_error_mm(scene, &pose), error_mm));
        }
    }
    assert_eq!(found.len(), 1);
    assert!(found[0].0 < 0.5, "{found:?} mm");
}
