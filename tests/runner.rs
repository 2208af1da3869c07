//! Runs scenes in process, without a recording.

use std::path::{Path, PathBuf};

use depal_cell::cell::{Cell, RunOutcome};
use depal_cell::event::Event;
use depal_cell::observer::{CaptureView, Observer, Snapshot};
use depal_cell::score::CartonFate;
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

/// Where the arm stood: seconds and radians, 25 times a simulated second.
#[derive(Default)]
pub struct Postures(pub Vec<(f64, Vec<f64>)>);

impl Observer for Postures {
    fn on_event(&mut self, _: &Event) {}
    fn on_snapshot(&mut self, snapshot: &Snapshot) {
        let joints = snapshot.joints.iter().copied().collect();
        self.0.push((snapshot.time.as_secs_f64(), joints));
    }
    fn on_capture(&mut self, _: &CaptureView<'_>) {}
}

/// A finished run.
pub struct Finished {
    pub outcome: RunOutcome,
    pub log: Vec<String>,
}

impl Finished {
    /// Cartons that reached the belt, or their place.
    pub fn delivered(&self) -> usize {
        let score = &self.outcome.score;
        score.count(|fate| fate == CartonFate::Delivered)
    }

    /// All events of this name.
    pub fn events(&self, name: &str) -> Vec<serde_json::Value> {
        let parsed = self
            .log
            .iter()
            .map(|line| serde_json::from_str::<serde_json::Value>(line).expect("the log is JSON"));
        parsed.filter(|event| event["event"] == name).collect()
    }
}

/// The root of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("tests/ lies in the workspace")
        .to_owned()
}

/// One of the scenes of `scenes/` with some keys changed.
pub fn scene(name: &str, overrides: &[(&str, &str)], seed: Option<u64>) -> Scene {
    let path = root().join(format!("scenes/{name}.toml"));
    Scene::load_file(&path.to_string_lossy(), &owned(overrides), seed)
        .unwrap_or_else(|errors| panic!("{errors}"))
}

fn owned(overrides: &[(&str, &str)]) -> Vec<(String, String)> {
    let each = overrides.iter();
    each.map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect()
}

/// Runs a loaded scene to its end.
pub fn run_scene(scene: &Scene) -> Finished {
    watch_scene(scene).0
}

/// The same, with where the arm stood.
pub fn watch_scene(scene: &Scene) -> (Finished, Postures) {
    let built = scene.build().unwrap_or_else(|error| panic!("{error}"));
    let cell = Cell::new(built.spec, built.task, || 0.0).unwrap_or_else(|error| panic!("{error}"));
    let mut log = Log::default();
    let mut postures = Postures::default();
    let outcome = cell.run(&mut [&mut log, &mut postures], |_| {});
    let finished = Finished {
        outcome,
        log: log.0,
    };
    (finished, postures)
}

/// Runs the demo with some keys changed.
pub fn run_demo(seed: u64, overrides: &[(&str, &str)]) -> Finished {
    run_scene(&Scene::demo(&owned(overrides), Some(seed)).unwrap_or_else(|error| panic!("{error}")))
}
