//! Command 701 from a RAPID program to the last picture: a camera that hangs elsewhere than believed.

use std::sync::Arc;

use depal_cell::event::EventKind;
use depal_cell::score::CartonFate;
use depal_cell::station::{Errand, Station};
use depal_frames::nalgebra::Quaternion;
use depal_frames::{EulerConvention, Point, Pose, Rotation, Vector};
use depal_interface::{ConnectionId, PortId};
use depal_scene::Scene;
use serde_json::Value as Json;

use crate::runner::{Finished, root, run_scene};

fn scene(overrides: &[(&str, &str)]) -> Scene {
    scene_of("calibration", overrides)
}

fn scene_of(name: &str, overrides: &[(&str, &str)]) -> Scene {
    let overrides: Vec<(String, String)> = overrides
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    let path = root().join(format!("scenes/{name}.toml"));
    Scene::load_file(&path.to_string_lossy(), &overrides, None)
        .unwrap_or_else(|errors| panic!("{errors}"))
}

fn delivered(finished: &Finished) -> usize {
    finished
        .outcome
        .score
        .count(|fate| fate == CartonFate::Delivered)
}

fn events(finished: &Finished, name: &str) -> Vec<Json> {
    let parsed = finished
        .log
        .iter()
        .map(|line| serde_json::from_str::<Json>(line).expect("the log is JSON"));
    parsed.filter(|event| event["event"] == name).collect()
}

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
    let scene = scene(&[]);
    let finished = run_scene(&scene);
    assert_eq!(delivered(&finished), 16);
    assert_eq!(finished.outcome.score.false_picks, 0);
    let calibrated = events(&finished, "calibrated");
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
    let replies: Vec<String> = events(&finished, "protocol")
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
    let finished = run_scene(&scene(&[("robot.program", &program.to_string_lossy())]));
    println!(
        "{} delivered, {:?}",
        delivered(&finished),
        finished.outcome.score.failures_by_reason()
    );
    assert!(events(&finished, "calibrated").is_empty());
    assert!(
        delivered(&finished) < 8,
        "{} delivered",
        delivered(&finished)
    );
    assert!(finished.outcome.score.false_picks > 0);
}

#[test]
fn flange_poses_serve_as_well_as_joints() {
    let program = root().join("tests/programs/calibrate_by_poses.mod");
    let finished = run_scene(&scene(&[
        ("robot.program", &program.to_string_lossy()),
        ("run.may_leave_cartons", "true"),
    ]));
    let calibrated = events(&finished, "calibrated");
    assert_eq!(calibrated.len(), 1, "{}", finished.outcome.end_detail);
    let error = calibrated[0]["error_mm"].as_f64().unwrap();
    assert!(error < 0.5, "{error} mm");
    let messages = events(&finished, "message");
    assert!(messages.iter().any(|m| m["text"] == "back again"));
}

#[test]
fn without_pictures_the_old_pose_stays() {
    let finished = run_scene(&scene(&[("camera.blackout", "true")]));
    assert!(events(&finished, "calibrated").is_empty());
    let messages = events(&finished, "message");
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
        client_calibrates(&scene_of(name, &[("interface.encoding", "ascii")]));
    }
}

/// There is no board: the robot hears it at once, and the log says why.
#[test]
fn without_a_calibration_set_up_701_is_refused() {
    let spec = scene_of("demo", &[("interface.encoding", "ascii")])
        .cell_spec()
        .unwrap();
    let at_once = Arc::new(|errand: Errand| errand());
    let mut station = Station::new(spec, || 0.0, at_once).unwrap();
    let (port, client) = (PortId(0), ConnectionId(1));
    station.connect(port, client);
    let request = "701,0,1500,0,1500,180,0,180,0,-20,20,0,90,0\r";
    station.receive(port, client, request.as_bytes());
    station.advance_waiting(station.tick() + 10);
    let reply = station.poll_reply().expect("an answer");
    assert_eq!(reply.bytes, b"701,7001\r");
    let mut said = Vec::new();
    while let Some((_, event)) = station.poll_event() {
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
    let port = PortId(0);
    let poses = spec.interface.calibration.clone();
    let at_once = Arc::new(|errand: Errand| errand());
    let mut station = Station::new(spec, || 0.0, at_once).unwrap();
    let client = ConnectionId(1);
    station.connect(port, client);
    let mut place = (
        EulerConvention::AbbZyx.mm_deg_from_pose(&poses[0].base_from_flange),
        poses[0].joints.to_degrees(),
    );
    for state in 0..=poses.len() {
        let cells: Vec<String> = place.0.iter().chain(&place.1).map(f64::to_string).collect();
        let request = format!("701,{},{}\r", i32::from(state > 0), cells.join(","));
        station.receive(port, client, request.as_bytes());
        station.advance_waiting(station.tick() + 10);
        let reply = station.poll_reply().expect("an answer");
        let text = String::from_utf8(reply.bytes).unwrap();
        let cells: Vec<f64> = text.trim().split(',').map(|c| c.parse().unwrap()).collect();
        assert_eq!(cells[..2], [701.0, 7101.0], "{text}");
        assert_eq!(cells[2], f64::from(state == poses.len()));
        place = (cells[3..9].try_into().unwrap(), cells[9..15].to_vec());
    }
    let mut found = Vec::new();
    while let Some((_, event)) = station.poll_event() {
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
