//! The pallet of the Siemens scene, emptied by a controller's program over its data block.

use depal_cell::cell::{Cell, EndState};
use depal_plc::{PlcSettings, PlcTask};
use depal_scene::Scene;

use crate::runner::{Finished, run_scene};

/// `scenes/siemens.toml` with so many cartons and other keys changed.
fn scene(cartons: u32, changes: &[(&str, &str)]) -> Scene {
    let (count, layers) = (cartons.to_string(), cartons.div_ceil(8).to_string());
    let mut overrides = vec![
        ("cartons.count", count.as_str()),
        ("cartons.layers", layers.as_str()),
        ("accept.delivered_min", "0"),
    ];
    overrides.extend(changes);
    crate::runner::scene("siemens", &overrides, None)
}

fn run(cartons: u32, changes: &[(&str, &str)]) -> Finished {
    run_scene(&scene(cartons, changes))
}

#[test]
fn every_function_of_the_sequence_is_counted() {
    let finished = run(8, &[]);
    let score = &finished.outcome.score;
    assert_eq!(finished.delivered(), 8, "{}", finished.outcome.end_detail);
    for (command, least) in [(901, 1), (501, 1), (201, 9), (206, 8), (210, 8 * 4)] {
        let count = score.commands.get(&command).copied().unwrap_or(0);
        assert!(count >= least, "command {command}: {count} times");
    }
}

/// 205 instead of 210 does as well; and the same run again is the same.
#[test]
fn a_bare_path_is_enough_and_runs_repeat() {
    let run = || run(8, &[("plc.fetch", "path")]);
    let (first, second) = (run(), run());
    assert_eq!(
        first.outcome.end,
        EndState::Finished,
        "{}",
        first.outcome.end_detail
    );
    assert_eq!(first.delivered(), 8);
    assert_eq!(first.outcome.state_hash, second.outcome.state_hash);
    assert!(first.log == second.log, "the logs differ");
}

/// With the pump off the program stops with its reason after its own number of failures.
#[test]
fn without_vacuum_nothing_is_lifted() {
    let finished = run(8, &[("gripper.vacuum_kpa", "0")]);
    assert_eq!(finished.delivered(), 0);
    assert_eq!(finished.outcome.end, EndState::Stopped);
    let detail = &finished.outcome.end_detail;
    assert!(detail.contains("no vacuum"), "{detail}");
}

/// A server that speaks another encoding never writes the block.
#[test]
fn without_a_polling_server_the_program_says_so() {
    let finished = run(8, &[("interface.encoding", "hex-be")]);
    assert_eq!(finished.delivered(), 0);
    assert_eq!(finished.outcome.end, EndState::Stopped);
    let detail = &finished.outcome.end_detail;
    assert!(
        detail.contains("no heartbeat of vision within 30 s"),
        "{detail}"
    );
}

/// The program trusts what it is told: outputs of another gripper, and nothing is picked.
#[test]
fn wrong_outputs_pick_nothing() {
    let spec = scene(8, &[])
        .build()
        .unwrap_or_else(|error| panic!("{error}"))
        .spec;
    let task = PlcTask::new(PlcSettings {
        home: spec.controller.start,
        flange_from_tcp: spec.gripper.flange_from_tcp,
        section_groups: vec!["goElsewhere".to_owned()],
        ..PlcSettings::default()
    });
    let cell = Cell::new(spec, Box::new(task), || 0.0).unwrap_or_else(|error| panic!("{error}"));
    let outcome = cell.run(&mut [], |_| {});
    assert_eq!(outcome.end, EndState::Stopped);
    let detail = &outcome.end_detail;
    assert!(
        detail.contains("there is no signal goElsewhere"),
        "{detail}"
    );
}
