//! The samples in `assets/rapid/samples`: each passes the check without a remark, and runs to its end.

use depal_controller::{
    Controller, ControllerSpec, ControllerState, CrossConnection, SignalKind, SignalSpec,
};
use depal_frames::JointPositions;
use depal_rapid::SignalDefinition;
use depal_vm::{Machine, SourceFile};

use crate::harness::{Told, arm, drive_on};
use crate::vision_peer::VisionPeer;

const MODULE: &str = include_str!("../../../../assets/rapid/MM_Module.mod");
const CELL: &str = include_str!("../../../../assets/rapid/samples/cell.mod");

macro_rules! sample {
    ($name:literal) => {
        include_str!(concat!("../../../../assets/rapid/samples/", $name))
    };
}

fn run(sample: &str, peer: &mut VisionPeer) -> Told {
    let sources = [
        SourceFile::new("MM_Module.mod", MODULE),
        SourceFile::new("cell.mod", CELL),
        SourceFile::new("sample.mod", sample),
    ];
    let known = [
        ("goVacuum", depal_rapid::SignalKind::Go),
        ("diVacuumOk", depal_rapid::SignalKind::Di),
    ]
    .map(|(name, kind)| SignalDefinition {
        name: name.to_owned(),
        kind,
    });
    let loaded = depal_rapid::load(&sources, &known, "main");
    let shown: Vec<_> = loaded
        .diagnostics
        .iter()
        .map(|d| d.plain(&sources))
        .collect();
    assert!(shown.is_empty(), "{}", shown.join("\n"));
    let checked = depal_rapid::check(&sources);
    assert!(!checked.has_errors());
    let home = JointPositions::from_degrees(&[90.0, -20.0, 20.0, 0.0, 90.0, 0.0]);
    let mut spec = ControllerSpec::new("rob1", arm(), home);
    spec.signals = vec![
        SignalSpec::new("goVacuum", SignalKind::GroupOutput { bits: 16 }),
        SignalSpec::new("diVacuumOk", SignalKind::DigitalInput),
    ];
    // Every section that is switched on holds at once.
    spec.connections = vec![CrossConnection {
        result: "diVacuumOk".to_owned(),
        actors: vec![("goVacuum".to_owned(), false)],
        any: Vec::new(),
    }];
    let mut controller = Controller::new(spec).expect("a cabinet");
    let program = loaded.program.expect("no errors");
    controller.set_task(Box::new(Machine::new(program, "T_ROB1").single_cycle()));
    drive_on(controller, &[], peer, 300.0)
}

#[track_caller]
fn check(sample: &str, peer: &mut VisionPeer, lines: &[&str], requests: &[i32]) -> Told {
    let told = run(sample, peer);
    assert_eq!(
        told.state,
        ControllerState::Finished,
        "{:?} {:?}",
        told.lines,
        peer.requests
    );
    let said: Vec<_> = told.lines.iter().map(String::as_str).collect();
    assert_eq!(said, lines);
    assert_eq!(peer.requests, requests);
    told
}

#[test]
fn vision_points_with_own_moves() {
    let mut peer = VisionPeer::new(9);
    let told = check(
        sample!("s01_vision_points.mod"),
        &mut peer,
        &["Points: 3", "Moved: 3", "Finished: vision points"],
        &[901, 103, 501, 101, 102],
    );
    // On and off for every carton.
    assert_eq!(told.edges("goVacuum").len(), 6);
}

#[test]
fn the_path_of_a_viz_project() {
    let mut peer = VisionPeer::new(9);
    // Replies come in pieces: the module gathers them.
    peer.piece = 100;
    let lines = ["Waypoints: 4", "Vision Move at: 2", "Finished: Viz path"];
    check(
        sample!("s02_viz_path.mod"),
        &mut peer,
        &lines,
        &[901, 201, 205],
    );
}

#[test]
fn the_do_list_of_a_gripper_with_sections() {
    let mut peer = VisionPeer::new(9);
    let lines = [
        "Picked at once: 2",
        "Length: 600",
        "Width: 400",
        "Outputs: 10",
        "Finished: DO list",
    ];
    let requests = [901, 201, 210, 210, 210, 210, 206];
    check(sample!("s03_do_list.mod"), &mut peer, &lines, &requests);
}

#[test]
fn branch_and_index() {
    let mut peer = VisionPeer::new(9);
    let lines = [
        "Place 1, waypoints: 4",
        "Place 2, waypoints: 4",
        "Place 3, waypoints: 4",
        "Finished: branch and index",
    ];
    let round = [201, 204, 203, 205];
    let requests: Vec<i32> = [901, 202]
        .into_iter()
        .chain(round)
        .chain(round)
        .chain(round)
        .collect();
    check(
        sample!("s04_branch_and_index.mod"),
        &mut peer,
        &lines,
        &requests,
    );
    let (exits, indexes) = peer.chosen();
    assert_eq!(indexes, [0, 1, 2]);
    // Exits are latched until the project asks, which this one never does.
    assert!(exits.iter().all(|exit| *exit < 2));
}

#[test]
fn lite_commands() {
    let mut peer = VisionPeer::new(9);
    let lines = ["Points: 3", "Waypoints: 4", "Finished: Lite commands"];
    check(
        sample!("s05_lite_commands.mod"),
        &mut peer,
        &lines,
        &[901, 100, 200],
    );
}

/// Two cartons, then nothing three times; the connection breaks in between, and is opened again.
#[test]
fn errors_and_retries() {
    let mut peer = VisionPeer::new(2);
    peer.breaks_after = Some(3);
    let told = run(sample!("s06_error_handling.mod"), &mut peer);
    assert_eq!(told.state, ControllerState::Finished, "{:?}", told.lines);
    assert_eq!(
        told.lines,
        [
            "MM: command refused, status 3097",
            "Connection lost, attempt 1",
            "Nothing found, capture 1",
            "Nothing found, capture 2",
            "Nothing found, capture 3",
            "Moved: 2",
            "Finished: error handling"
        ]
        .map(str::to_owned)
    );
}

/// Vision that does not answer is a time-out of the server, not of the robot.
#[test]
fn a_slow_vision_system_is_told() {
    let mut peer = VisionPeer::new(1);
    peer.silent = 1;
    let told = run(sample!("s06_error_handling.mod"), &mut peer);
    assert!(
        told.lines[0].starts_with("Vision took too long") || told.lines[0].starts_with("Stopped"),
        "{:?}",
        told.lines
    );
}

/// Longest time that the arm stands between the first pick and the last release.
fn longest_stand(told: &Told) -> f64 {
    let edges = told.edges("goVacuum");
    let tick = |index: usize| (edges[index].0 / 0.004) as usize;
    let (mut longest, mut stand) = (0, 0);
    for pair in told.joints[tick(0)..tick(edges.len() - 1)].windows(2) {
        stand = if pair[0] == pair[1] { stand + 1 } else { 0 };
        longest = longest.max(stand);
    }
    f64::from(longest) * 0.004
}

/// The next round is planned while the arm returns: it never stands for it. Started late, it does.
#[test]
fn plan_ahead() {
    let mut peer = VisionPeer::new(9);
    let lines = [
        "Round 1",
        "Round 2",
        "Round 3",
        "Rounds: 3",
        "Finished: plan ahead",
    ];
    let told = run(sample!("s07_plan_ahead.mod"), &mut peer);
    assert_eq!(told.state, ControllerState::Finished, "{:?}", told.lines);
    assert_eq!(told.lines, lines.map(str::to_owned));
    let ahead = longest_stand(&told);
    assert!(ahead < 0.1, "{ahead} s");
    let late = sample!("s07_plan_ahead.mod")
        .replace("IF nRounds<nMaxRounds MM_Start_Viz 2,jHome;", "")
        .replace(
            "MM_get_plandata 0,1",
            "IF nRounds>0 MM_Start_Viz 2,jHome;\nMM_get_plandata 0,1",
        )
        .replace("jHome\\NoEOffs,v1000,z50", "jHome\\NoEOffs,v1000,fine");
    let told = run(&late, &mut VisionPeer::new(9));
    assert_eq!(told.lines, lines.map(str::to_owned));
    let waiting = longest_stand(&told);
    assert!(waiting > 0.35, "{waiting} s");
}
