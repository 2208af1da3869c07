//! The pallet of the demo, emptied by a Siemens controller's program over its data block.

use depal_cell::cell::{Cell, EndState};
use depal_cell::spec::PlcPort;
use depal_interface::plc_port;
use depal_plc::{Fetch, PlcSettings, PlcTask};
use depal_scene::Scene;
use depal_time::SimDuration;

use crate::runner::{Finished, Log};

/// The demo with so many cartons, its robot program replaced by a controller's.
fn run(cartons: u32, change: impl Fn(&mut PlcSettings)) -> Finished {
    let set = |key: &str, value: String| (key.to_owned(), value);
    let overrides = [
        set("cartons.count", cartons.to_string()),
        set("cartons.layers", cartons.div_ceil(8).to_string()),
        set("accept.delivered_min", "0".to_owned()),
    ];
    let scene = Scene::demo(&overrides, None).unwrap_or_else(|error| panic!("{error}"));
    let mut spec = scene.build().unwrap_or_else(|error| panic!("{error}")).spec;
    let mut settings = PlcSettings {
        box_size_mm: Some([400.0, 300.0, 250.0]),
        home: spec.controller.start,
        flange_from_tcp: spec.gripper.flange_from_tcp,
        ..PlcSettings::default()
    };
    change(&mut settings);
    spec.plc = Some(PlcPort {
        port: settings.port,
        db: 1,
        rack: 0,
        slot: 1,
        poll: SimDuration::from_millis(20),
    });
    spec.interface.ports = spec.interface.ports.iter().map(plc_port).collect();
    let task = Box::new(PlcTask::new(settings));
    let cell = Cell::new(spec, task, || 0.0).unwrap_or_else(|error| panic!("{error}"));
    let mut log = Log::default();
    let outcome = cell.run(&mut [&mut log], |_| {});
    Finished {
        outcome,
        log: log.0,
    }
}

#[test]
fn a_controller_empties_the_pallet() {
    let finished = run(24, |_| {});
    let score = &finished.outcome.score;
    assert_eq!(
        finished.outcome.end,
        EndState::Finished,
        "{}",
        finished.outcome.end_detail
    );
    assert_eq!(
        score.count(|fate| fate == depal_cell::score::CartonFate::Delivered),
        24
    );
    assert!(
        score.picks.iter().all(|(_, failure)| failure.is_none()),
        "{:?}",
        score.picks
    );
    for (command, least) in [(901, 1), (501, 1), (201, 25), (206, 24), (210, 24 * 4)] {
        let count = score.commands.get(&command).copied().unwrap_or(0);
        assert!(count >= least, "command {command}: {count} times");
    }
    let hours = finished.outcome.sim_time.as_secs_f64() / 3600.0;
    println!("{:.0} cartons/h", 24.0 / hours);
}

/// 205 instead of 210 does as well; and the same run again is the same.
#[test]
fn a_bare_path_is_enough_and_runs_repeat() {
    let run = || run(8, |settings| settings.fetch = Fetch::Path);
    let (first, second) = (run(), run());
    assert_eq!(
        first.outcome.end,
        EndState::Finished,
        "{}",
        first.outcome.end_detail
    );
    assert_eq!(
        first
            .outcome
            .score
            .count(|fate| fate == depal_cell::score::CartonFate::Delivered),
        8
    );
    assert_eq!(first.outcome.state_hash, second.outcome.state_hash);
    assert!(first.log == second.log, "the logs differ");
}

/// The program trusts what it is told: output numbers of another gripper, and nothing is picked.
#[test]
fn wrong_outputs_pick_nothing() {
    let finished = run(8, |settings| {
        settings.section_groups = vec!["goElsewhere".to_owned()];
    });
    assert_eq!(finished.outcome.end, EndState::Stopped);
    assert!(
        finished
            .outcome
            .end_detail
            .contains("there is no signal goElsewhere"),
        "{}",
        finished.outcome.end_detail
    );
}
