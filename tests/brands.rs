//! What must go wrong in the cells of several makes goes wrong, and says so.

use depal_cell::cell::EndState;
use depal_cell::score::CartonFate;
use depal_scene::Scene;

use crate::runner::{Finished, Postures, root, run_scene, watch_scene};

/// One layer of the scene's pallet with a key changed.
fn layer(name: &str, change: (&str, &str)) -> Finished {
    run_scene(&layer_scene(name, change))
}

fn layer_scene(name: &str, change: (&str, &str)) -> Scene {
    let set = |key: &str, value: &str| (key.to_owned(), value.to_owned());
    let overrides = [
        set("cartons.count", "8"),
        set("cartons.layers", "1"),
        set("accept.delivered_min", "0"),
        set(change.0, change.1),
    ];
    let file = root().join(format!("scenes/{name}.toml"));
    Scene::load_file(&file.to_string_lossy(), &overrides, None)
        .unwrap_or_else(|errors| panic!("{errors}"))
}

#[track_caller]
fn assert_nothing_delivered(finished: &Finished) {
    let score = &finished.outcome.score;
    assert_eq!(score.count(|fate| fate == CartonFate::Delivered), 0);
    assert_eq!(finished.outcome.end, EndState::Stopped);
}

/// The programs pack their own bytes; a server that reads them the other way round understands nothing.
#[test]
fn in_the_wrong_byte_order_nothing_is_understood() {
    for (name, encoding) in [("kuka", "hex-be"), ("fanuc", "hex-le")] {
        let finished = layer(name, ("interface.encoding", encoding));
        assert_nothing_delivered(&finished);
        assert!(finished.outcome.score.picks.is_empty(), "{name}");
    }
    let finished = layer("fanuc", ("robot.hex_byte_order", "little"));
    assert_nothing_delivered(&finished);
}

#[test]
fn without_vacuum_nothing_is_lifted() {
    for name in ["kuka", "fanuc"] {
        let finished = layer(name, ("gripper.vacuum_kpa", "0"));
        assert_nothing_delivered(&finished);
        let picks = &finished.outcome.score.picks;
        assert!(!picks.is_empty(), "{name}");
        assert!(
            picks.iter().all(|(_, failure)| failure.is_some()),
            "{name}: {picks:?}"
        );
    }
}

/// Seconds at which the first line with these words was logged.
fn seconds_of(finished: &Finished, words: &str) -> f64 {
    let line = finished.log.iter().find(|line| line.contains(words));
    let line = line.unwrap_or_else(|| panic!("no {words} in the log"));
    let event: serde_json::Value = serde_json::from_str(line).expect("the log is JSON");
    event["t_ns"].as_f64().expect("a time") * 1e-9
}

/// Largest turn of any joint from one posture to the next within a span of time, radians.
fn turn(postures: &Postures, from: f64, to: f64) -> f64 {
    let within = postures.0.iter().filter(|(at, _)| (from..=to).contains(at));
    let within: Vec<&Vec<f64>> = within.map(|(_, joints)| joints).collect();
    assert!(
        within.len() > 2,
        "{from} to {to} s: {} postures",
        within.len()
    );
    let turns = within.windows(2).flat_map(|two| {
        let joints = two[0].iter().zip(two[1]);
        joints.map(|(a, b)| (a - b).abs())
    });
    turns.fold(0.0, f64::max)
}

/// While a path is being fetched the server is gone: the program stops and says so, and the arm comes to a halt and stays.
#[test]
fn a_connection_lost_in_mid_path_stops_program_and_arm() {
    for (name, said) in [
        ("demo", "no path, status 3097"),
        ("kuka", "no path, status 3097"),
        ("fanuc", "Stopped: see R 1, the status"),
    ] {
        let fault = ("interface.inject", "[\"drop_connection@reply=14\"]");
        let (finished, postures) = watch_scene(&layer_scene(name, fault));
        let outcome = &finished.outcome;
        assert_eq!(outcome.end, EndState::Stopped, "{name}");
        assert!(
            outcome.end_detail.contains(said),
            "{name}: {}",
            outcome.end_detail
        );
        // Some points of the path had come, the others never do.
        let lost = seconds_of(&finished, "[fault drop_connection@reply=14]");
        assert!(outcome.score.statuses.get(&2100).is_some_and(|n| *n > 0));
        // A second to notice and to brake; the first carton rides on to the belt's end meanwhile.
        let (still_from, end) = (lost + 1.0, outcome.sim_time.as_secs_f64());
        assert!(end - still_from > 2.0, "{name}: {lost} to {end} s");
        let moved = turn(&postures, still_from, end);
        assert!(moved == 0.0, "{name}: {moved} rad after the loss");
        // Without the fault it would move all that time.
        let (_, going_on) = watch_scene(&layer_scene(name, ("run.max_sim_s", "30")));
        let moves = turn(&going_on, still_from, end);
        assert!(moves > 0.01, "{name}: {moves} rad without it");
    }
}
