//! Runs scenes in process, without a recording.

use std::path::{Path, PathBuf};

use depal_cell::cell::{Cell, RunOutcome};
use depal_cell::event::Event;
use depal_cell::observer::{CaptureView, Observer, Snapshot};
use depal_scene::Scene;

/// The event log as the run folder would hold it.
#[derive(Default)]
pub struct Log(pub Vec<String>);

impl Observer for Log {
    fn on_event(&mut self, event: &Event) {
        self.0
            .push(serde_json::to_string(event).expect("events are JSON"));
    }
    fn on_snapshot(&mut self, _: &Snapshot) {}
    fn on_capture(&mut self, _: &CaptureView<'_>) {}
}

/// A finished run.
pub struct Finished {
    pub outcome: RunOutcome,
    pub log: Vec<String>,
}

/// The root of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("tests/ lies in the workspace")
        .to_owned()
}

/// Runs a loaded scene to its end.
pub fn run_scene(scene: &Scene) -> Finished {
    let built = scene.build().unwrap_or_else(|error| panic!("{error}"));
    let cell = Cell::new(built.spec, built.task, || 0.0).unwrap_or_else(|error| panic!("{error}"));
    let mut log = Log::default();
    let outcome = cell.run(&mut [&mut log], |_| {});
    Finished {
        outcome,
        log: log.0,
    }
}

/// Runs the demo with some keys changed.
pub fn run_demo(seed: u64, overrides: &[(&str, &str)]) -> Finished {
    let overrides: Vec<(String, String)> = overrides
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    run_scene(&Scene::demo(&overrides, Some(seed)).unwrap_or_else(|error| panic!("{error}")))
}
