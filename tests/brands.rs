//! What must go wrong in the KUKA and FANUC cells goes wrong, and says so.

use depal_cell::cell::EndState;
use depal_cell::score::CartonFate;
use depal_scene::Scene;

use crate::runner::{Finished, root, run_scene};

/// One layer of the scene's pallet with a key changed.
fn layer(name: &str, change: (&str, &str)) -> Finished {
    let set = |key: &str, value: &str| (key.to_owned(), value.to_owned());
    let overrides = [
        set("cartons.count", "8"),
        set("cartons.layers", "1"),
        set("accept.delivered_min", "0"),
        set(change.0, change.1),
    ];
    let file = root().join(format!("scenes/{name}.toml"));
    let scene = Scene::load_file(&file.to_string_lossy(), &overrides, None)
        .unwrap_or_else(|errors| panic!("{errors}"));
    run_scene(&scene)
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
