//! A recording is whole or it does not bear its name.

use std::path::PathBuf;

use depal_cell::event::{Event, EventKind, FailureReason};
use depal_cell::observer::{CartonView, CartonViewState, Observer, Snapshot};
use depal_frames::{Intrinsics, JointPositions, PlacedShape, Pose, Vector};
use depal_time::{SimDuration, SimTime};

use crate::{JsonLines, RecordError, Recording, RecordingSetup};

fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("depal-record-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&path).expect("a writable folder");
    path
}

fn message(text: &str) -> Event {
    Event {
        time: SimTime::ZERO + SimDuration::from_millis(4),
        kind: EventKind::Message { text: text.into() },
    }
}

fn setup() -> RecordingSetup {
    RecordingSetup {
        title: "test".into(),
        readme: String::new(),
        arm_links: vec![("base".into(), Vec::new())],
        joint_names: vec!["joint_1".into()],
        gripper_bodies: vec![PlacedShape::cuboid(
            Pose::identity(),
            Vector::new(0.6, 0.4, 0.1),
        )],
        section_areas: vec![[-0.1, 0.1, -0.1, 0.1]],
        fixed: Vec::new(),
        intrinsics: Intrinsics {
            width: 4,
            height: 4,
            fx: 4.0,
            fy: 4.0,
            cx: 1.5,
            cy: 1.5,
        },
        world_from_camera: Some(Pose::identity()),
    }
}

fn snapshot(millis: u64, z: f64) -> Snapshot {
    Snapshot {
        time: SimTime::ZERO + SimDuration::from_millis(millis),
        joints: JointPositions::zeros(1),
        world_from_links: vec![Pose::identity()],
        world_from_tcp: Pose::translation(0.0, 0.0, z),
        section_vacuum: vec![30_000.0],
        valves: vec![true],
        cartons: vec![CartonView {
            id: 1,
            world_from_centre: Pose::translation(0.0, 0.0, z),
            size: [0.4, 0.3, 0.25],
            state: CartonViewState::Gripped,
        }],
    }
}

#[test]
fn json_lines_take_their_name_when_they_are_whole() {
    let path = folder("lines").join("events.jsonl");
    let _ = std::fs::remove_file(&path);
    let mut lines = JsonLines::create(&path).expect("a writable folder");
    lines.on_event(&message("one"));
    lines.on_event(&message("two"));
    assert!(!path.exists(), "the file has its name before it is whole");
    lines.finish().expect("a writable folder");
    let text = std::fs::read_to_string(&path).expect("the file");
    assert_eq!(
        text,
        "{\"t_ns\":4000000,\"event\":\"message\",\"text\":\"one\"}\n\
         {\"t_ns\":4000000,\"event\":\"message\",\"text\":\"two\"}\n"
    );
}

#[test]
fn a_recording_takes_its_name_when_it_is_whole() {
    let path = folder("rrd").join("run.rrd");
    let _ = std::fs::remove_file(&path);
    let mut recording = Recording::create(&path, setup()).expect("a writable folder");
    recording.on_snapshot(&snapshot(0, 1.0));
    recording.on_snapshot(&snapshot(40, 1.1));
    recording.on_event(&Event {
        time: SimTime::ZERO + SimDuration::from_millis(44),
        kind: EventKind::PickFinished {
            pick: 1,
            carton: Some(1),
            cartons: vec![1],
            reason: Some(FailureReason::Dropped),
            detail: "load 300 N, the sealed cups hold 200 N".into(),
            cycle_s: 5.0,
        },
    });
    assert!(!path.exists(), "the file has its name before it is whole");
    recording.finish().expect("a writable folder");
    let bytes = std::fs::read(&path).expect("the file");
    assert!(bytes.starts_with(b"RRF"), "not a recording");
    assert!(bytes.len() > 2000, "{} bytes hold no tracks", bytes.len());
}

#[test]
fn a_folder_that_is_not_there_is_named() {
    let path = folder("missing").join("nowhere/events.jsonl");
    let error = JsonLines::create(&path).expect_err("no such folder");
    assert!(matches!(error, RecordError::Write { .. }));
    assert!(error.to_string().contains("nowhere"), "{error}");
}
