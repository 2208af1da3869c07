//! The rules of `crates/README.md` that manifests and files can break.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Rooms from the inside out; a crate may depend on crates of the rows before it only,
/// and within the fourth row on those named in `WITHIN_ROW`.
const ROWS: [&[&str]; 6] = [
    &["depal-frames", "depal-syntax", "depal-time"],
    &[
        "depal-vm",
        "depal-eki",
        "depal-arm",
        "depal-gripper",
        "depal-camera",
        "depal-vision",
        "depal-wire",
        "depal-motion",
    ],
    &[
        "depal-rapid",
        "depal-krl",
        "depal-tp",
        "depal-plc",
        "depal-controller",
        "depal-world",
        "depal-planner",
        "depal-workflow",
        "depal-interface",
    ],
    &["depal-cell"],
    &["depal-scene", "depal-record", "depal-report", "depal-net"],
    &["depal"],
];

/// Arrows inside a row.
const WITHIN_ROW: [(&str, &str); 1] = [("depal-motion", "depal-arm")];

/// What a room must never know, whatever the rows allow.
const FORBIDDEN: [(&str, &[&str]); 8] = [
    (
        "depal-vision",
        &["depal-world", "depal-camera", "depal-cell", "depal-gripper"],
    ),
    (
        "depal-planner",
        &["depal-world", "depal-camera", "depal-cell"],
    ),
    (
        "depal-interface",
        &["depal-world", "depal-camera", "depal-vision", "depal-cell"],
    ),
    (
        "depal-rapid",
        &[
            "depal-arm",
            "depal-motion",
            "depal-world",
            "depal-controller",
        ],
    ),
    (
        "depal-krl",
        &[
            "depal-arm",
            "depal-motion",
            "depal-world",
            "depal-controller",
        ],
    ),
    (
        "depal-tp",
        &[
            "depal-arm",
            "depal-motion",
            "depal-world",
            "depal-controller",
            "depal-interface",
        ],
    ),
    (
        "depal-plc",
        &[
            "depal-arm",
            "depal-motion",
            "depal-world",
            "depal-controller",
            "depal-interface",
        ],
    ),
    (
        "depal-vm",
        &[
            "depal-arm",
            "depal-motion",
            "depal-world",
            "depal-controller",
        ],
    ),
];

/// Large dependencies and the one crate that names each. The planner's collision checks share parry.
const OWNERS: [(&str, &[&str]); 5] = [
    ("rapier3d", &["depal-world"]),
    ("k", &["depal-arm"]),
    ("rerun", &["depal-record"]),
    ("parry3d", &["depal-planner"]),
    ("quick-xml", &["depal-arm", "depal-eki"]),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("tests/ lies in the workspace")
        .to_owned()
}

/// Names in `[dependencies]`, by crate.
fn dependencies() -> BTreeMap<String, Vec<String>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(root().join("crates")).expect("crates/ is there") {
        let folder = entry.expect("readable entry").path();
        let Ok(manifest) = fs::read_to_string(folder.join("Cargo.toml")) else {
            continue;
        };
        let name = folder
            .file_name()
            .expect("a folder name")
            .to_string_lossy()
            .into_owned();
        let names = manifest
            .lines()
            .skip_while(|line| line.trim() != "[dependencies]")
            .skip(1)
            .take_while(|line| !line.starts_with('['))
            .filter_map(|line| line.split(['.', ' ', '=']).next())
            .filter(|name| !name.is_empty())
            .map(str::to_owned)
            .collect();
        all.insert(name, names);
    }
    all
}

fn row(name: &str) -> Option<usize> {
    ROWS.iter().position(|row| row.contains(&name))
}

#[test]
fn arrows_point_inwards() {
    let all = dependencies();
    assert!(all.len() > 15, "found only {} crates", all.len());
    for (name, names) in &all {
        let own = row(name).unwrap_or_else(|| panic!("{name} stands in no row: add it to ROWS"));
        for dependency in names.iter().filter(|n| n.starts_with("depal-")) {
            let theirs = row(dependency).unwrap_or_else(|| panic!("{dependency} stands in no row"));
            let sideways = WITHIN_ROW.contains(&(name.as_str(), dependency.as_str()));
            assert!(
                theirs < own || sideways,
                "{name} depends on {dependency}, which is not further in"
            );
        }
    }
}

#[test]
fn rooms_know_only_what_they_may() {
    let all = dependencies();
    for (name, forbidden) in FORBIDDEN {
        for dependency in reachable(&all, name) {
            assert!(
                !forbidden.contains(&dependency.as_str()),
                "{name} reaches {dependency}"
            );
        }
    }
}

fn reachable(all: &BTreeMap<String, Vec<String>>, name: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut open = vec![name.to_owned()];
    while let Some(next) = open.pop() {
        for dependency in all.get(&next).into_iter().flatten() {
            if dependency.starts_with("depal-") && !found.contains(dependency) {
                found.push(dependency.clone());
                open.push(dependency.clone());
            }
        }
    }
    found
}

#[test]
fn one_crate_names_each_large_dependency() {
    for (name, names) in &dependencies() {
        for (large, owners) in OWNERS {
            assert!(
                !names.iter().any(|n| n == large) || owners.contains(&name.as_str()),
                "{name} names {large}, which belongs to {owners:?}"
            );
        }
    }
}

#[test]
fn every_scene_says_what_it_accepts() {
    let mut scenes = 0;
    for entry in fs::read_dir(root().join("scenes")).expect("scenes/ is there") {
        let path = entry.expect("readable entry").path();
        if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            scenes += 1;
            let text = fs::read_to_string(&path).expect("readable scene");
            assert!(
                text.contains("[accept]"),
                "{} has no [accept]",
                path.display()
            );
        }
    }
    assert!(scenes > 0, "no scenes found");
}

#[test]
fn no_absolute_paths_and_no_registry_hosts() {
    let needles = [
        ["/", "work/"].concat(),
        ["/", "root/"].concat(),
        ["index.", "crates.io"].concat(),
        ["static.", "crates.io"].concat(),
        ["pypi.", "org"].concat(),
    ];
    let mut open = vec![
        root().join("crates"),
        root().join("scenes"),
        root().join("assets"),
        root().join("urdf"),
    ];
    open.push(root().join("README.md"));
    let mut files = 0;
    while let Some(path) = open.pop() {
        if path.is_dir() {
            open.extend(
                fs::read_dir(&path)
                    .expect("readable folder")
                    .map(|e| e.expect("entry").path()),
            );
        } else if let Ok(text) = fs::read_to_string(&path) {
            files += 1;
            for needle in &needles {
                assert!(
                    !text.contains(needle.as_str()),
                    "{} names {needle}",
                    path.display()
                );
            }
        }
    }
    assert!(files > 50, "looked at only {files} files");
}
