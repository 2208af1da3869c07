//! The demo with the interface modules of other versions.

use depal_cell::score::CartonFate;
use depal_scene::Scene;

use crate::runner::{root, run_scene};

fn delivered(overrides: &[(&str, String)]) -> usize {
    let overrides: Vec<(String, String)> = overrides
        .iter()
        .map(|(key, value)| ((*key).to_owned(), value.clone()))
        .collect();
    let scene = root().join("scenes/demo.toml");
    let scene = Scene::load_file(&scene.to_string_lossy(), &overrides, Some(1))
        .unwrap_or_else(|error| panic!("{error}"));
    let finished = run_scene(&scene);
    finished
        .outcome
        .score
        .count(|fate| fate == CartonFate::Delivered)
}

/// A layer is enough: eight cartons, all delivered.
const LAYER: [(&str, &str); 3] = [
    ("cartons.layers", "1"),
    ("cartons.count", "8"),
    ("accept.delivered_min", "8"),
];

/// A path from the root of the workspace, as a TOML string.
fn quoted(path: &str) -> String {
    format!("'{}'", root().join(path).display())
}

fn layer() -> Vec<(&'static str, String)> {
    LAYER.map(|(key, value)| (key, value.to_owned())).to_vec()
}

/// The program as it stands: 1.7 connects for every command.
#[test]
fn the_demo_runs_with_the_module_of_1_7() {
    let mut overrides = layer();
    let module = quoted("assets/rapid/MM_Module_1_7.mod");
    overrides.push(("robot.module", module));
    assert_eq!(delivered(&overrides), 8);
}

/// The same program with the calls of 2.x.
#[test]
fn the_demo_runs_with_the_module_of_2_x() {
    let mut overrides = layer();
    let module = quoted("assets/rapid/MM_Module_2_x.mod");
    overrides.push(("robot.module", module));
    let program = quoted("tests/programs/demo_2_x.mod");
    overrides.push(("robot.program", program));
    assert_eq!(delivered(&overrides), 8);
}

/// The scene that `init` writes beside the samples.
#[test]
fn the_sample_scene_delivers_its_cartons() {
    let scene = root().join("assets/rapid/samples/sample.toml");
    let module = (
        "robot.module".to_owned(),
        quoted("assets/rapid/MM_Module.mod"),
    );
    let scene = Scene::load_file(&scene.to_string_lossy(), &[module], None)
        .unwrap_or_else(|error| panic!("{error}"));
    let finished = run_scene(&scene);
    let score = &finished.outcome.score;
    let delivered = score.count(|fate| fate == CartonFate::Delivered);
    assert_eq!(delivered, 3, "{:?}", score.failures_by_reason());
}
