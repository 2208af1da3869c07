use depal_vm::execution::Step;
use depal_vm::system::{MoveKind, MoveZone};
use depal_wire::s7::Field;

use super::cell::{Cell, target};
use crate::{Fetch, PlcSettings, Source};

/// 901 and 501, then for each carton 201, 203, 210 four times (one waypoint each), 206; at last 201 and a
/// 210 without result.
#[test]
fn a_pallet_is_emptied() {
    let settings = PlcSettings {
        box_size_mm: Some([400.0, 300.0, 250.0]),
        branches: vec![(5, 2)],
        ..PlcSettings::default()
    };
    let mut cell = Cell::new(settings, 3);
    assert_eq!(cell.run(), Step::Finished);
    let mut expected = vec![901, 501];
    for _ in 0..3 {
        expected.extend([201, 203, 210, 210, 210, 210, 206]);
    }
    expected.extend([201, 203, 210]);
    assert_eq!(cell.commands, expected);
    assert_eq!(cell.statuses.last(), Some(&2037));
    assert!(
        cell.statuses[..cell.statuses.len() - 1]
            .iter()
            .all(|code| code % 1000 >= 100)
    );
    assert_eq!(cell.cabinet.log, ["Pallet empty, cartons moved: 3"]);

    // Home, then to the pick, to the place, up and home for each, and home once more.
    let moves: Vec<[f64; 2]> = cell
        .cabinet
        .moves
        .iter()
        .map(|(request, _)| target(request))
        .collect();
    let home = [90.0, -20.0];
    let mut expected = vec![home];
    for carton in [3.0, 2.0, 1.0] {
        let path = [1.0, 2.0, 3.0, 4.0].map(|place| [place, carton]);
        expected.extend(path);
        expected.extend([[4.0, carton], home]);
    }
    expected.push(home);
    assert_eq!(moves, expected);
    let kinds: Vec<MoveKind> = cell.cabinet.moves[1..6]
        .iter()
        .map(|(request, _)| request.kind)
        .collect();
    use MoveKind::{Joint, Linear};
    assert_eq!(kinds, [Joint, Linear, Joint, Joint, Linear]);
    let stops: Vec<bool> = cell.cabinet.moves[1..6]
        .iter()
        .map(|(request, _)| request.zone == MoveZone::Fine)
        .collect();
    assert_eq!(stops, [false, true, false, true, false]);
    // Outputs 1, 3 and 6 at each pick.
    let bits = 1 << 1 | 1 << 3 | 1 << 6;
    assert_eq!(cell.cabinet.outputs, [0, bits, 0, bits, 0, bits, 0]);
    // Flags are reset, and nothing of the command half is vision's.
    assert!(!cell.task.block().bool(Field::PoseSent));
    assert!(!cell.task.block().bool(Field::Trigger));
}

/// The other ways to a path: the same moves but for the kinds of them.
#[test]
fn other_ways_to_a_path() {
    let cases = [
        (Source::Viz, Fetch::Path, vec![901, 201, 205, 206, 201, 205]),
        (
            Source::Vision,
            Fetch::Path,
            vec![901, 101, 105, 106, 101, 105],
        ),
        (
            Source::Vision,
            Fetch::PlanData,
            vec![901, 101, 111, 111, 111, 111, 106, 101, 111],
        ),
    ];
    for (source, fetch, commands) in cases {
        let settings = PlcSettings {
            source,
            fetch,
            ..PlcSettings::default()
        };
        let mut cell = Cell::new(settings, 1);
        assert_eq!(cell.run(), Step::Finished, "{source:?} {fetch:?}");
        assert_eq!(cell.commands, commands, "{source:?} {fetch:?}");
        assert_eq!(cell.cabinet.log, ["Pallet empty, cartons moved: 1"]);
        let moves: Vec<[f64; 2]> = cell.cabinet.moves.iter().map(|(r, _)| target(r)).collect();
        assert_eq!(
            &moves[1..5],
            &[[1.0, 1.0], [2.0, 1.0], [3.0, 1.0], [4.0, 1.0]]
        );
    }
}

/// The same, twice: bit by bit.
#[test]
fn runs_repeat() {
    let run = || {
        let mut cell = Cell::new(PlcSettings::default(), 2);
        cell.run();
        let moves: Vec<_> = cell.cabinet.moves.clone();
        (moves, cell.cabinet.now, cell.task.block().clone())
    };
    assert!(run() == run());
}

/// Without vacuum the carton stays, the arm goes back the way it came, and after four picks it is enough.
#[test]
fn no_vacuum() {
    let mut cell = Cell::new(PlcSettings::default(), 9);
    cell.cabinet.good_picks = 1;
    let Step::Stopped(reason) = cell.run() else {
        panic!("it ended well");
    };
    assert_eq!(reason, "too many failed picks in a row: no vacuum");
    let attempts = cell
        .cabinet
        .log
        .iter()
        .filter(|text| text.starts_with("no vacuum"))
        .count();
    assert_eq!(attempts, 4);
    let moves: Vec<[f64; 2]> = cell.cabinet.moves.iter().map(|(r, _)| target(r)).collect();
    // The second carton: to the pick, and back.
    assert_eq!(
        &moves[7..11],
        &[[1.0, 8.0], [2.0, 8.0], [1.0, 8.0], [90.0, -20.0]]
    );
}

/// A status that the program does not expect stops it, by name and number.
#[test]
fn a_refusal_stops_the_program() {
    let settings = PlcSettings {
        branches: vec![(77, 1)],
        ..PlcSettings::default()
    };
    let mut cell = Cell::new(settings, 1);
    assert_eq!(
        cell.run(),
        Step::Stopped("ChooseBranch: vision answers with status 2024".to_owned())
    );
    assert_eq!(cell.cabinet.log[0], "motion stopped");
}

/// Vision is cut off in the middle of a path and comes back: the program goes on, and nothing is done twice.
#[test]
fn vision_comes_back() {
    let mut cell = Cell::new(PlcSettings::default(), 2);
    while cell
        .commands
        .iter()
        .filter(|command| **command == 201)
        .count()
        < 2
    {
        assert_eq!(cell.tick(), None);
    }
    cell.set_away(true);
    for _ in 0..500 {
        assert_eq!(cell.tick(), None);
    }
    cell.set_away(false);
    assert_eq!(cell.run(), Step::Finished);
    assert_eq!(cell.cabinet.log, ["Pallet empty, cartons moved: 2"]);
    assert_eq!(
        cell.commands
            .iter()
            .filter(|command| **command == 201)
            .count(),
        3
    );
}

/// Vision that never comes back: the call is given up, and the arm stands.
#[test]
fn vision_stays_away() {
    let mut cell = Cell::new(PlcSettings::default(), 2);
    while !cell.commands.contains(&206) {
        assert_eq!(cell.tick(), None);
    }
    cell.set_away(true);
    let Step::Stopped(reason) = cell.run() else {
        panic!("it ended well");
    };
    assert!(reason.starts_with("command 2"), "{reason}");
    assert!(reason.contains("did not come within"), "{reason}");
}
