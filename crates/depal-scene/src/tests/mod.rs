//! Tests of scenes: what is refused and how it says so, overrides, the stack, the schema.

mod calibration;
mod documentation;
mod grippers;
mod interface;
mod layout;
mod loading;
mod mistakes;
mod sensor;
mod skin;

use std::io;

use crate::*;

pub(crate) const DEMO: &str = include_str!("../../../../scenes/demo.toml");

/// Stands for the files that the demo names, so that these tests need no other crate's files.
pub(crate) fn any_file(path: &str) -> io::Result<String> {
    if path.contains("missing") {
        return Err(io::Error::new(io::ErrorKind::NotFound, "no such file"));
    }
    Ok(format!("text of {path}"))
}

pub(crate) fn sets(pairs: &[(&str, &str)]) -> Vec<(String, String)> {
    pairs
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect()
}

/// The only line that touches the API.
pub(crate) fn load(text: &str, overrides: &[(&str, &str)]) -> Result<Scene, SceneErrors> {
    Scene::load(text, "scenes/demo.toml", &sets(overrides), None, &any_file)
}

pub(crate) fn demo(overrides: &[(&str, &str)]) -> Scene {
    load(DEMO, overrides).unwrap()
}
