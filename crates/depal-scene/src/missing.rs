//! What to try instead of a file that cannot be read.

use std::io;

use crate::files::EMBEDDED;

/// Folder of the scenes and their programs in the source tree: looked into when a bare name is not found.
const SCENES: &str = "scenes";
/// What an editor reads and no command does.
const SCHEMA: &str = ".schema.json";
/// A longer list of names says nothing.
const MOST_NAMES: usize = 20;
/// From this likeness of two names on one is taken for a slip in writing the other.
const ALIKE: f64 = 0.75;

/// The error of reading `path`, with what to try where that is known: the nearest name in its folder, or what lies
/// there; for a bare name also in `scenes/`.
pub fn with_advice(path: &str, error: io::Error) -> io::Error {
    let advice = match error.kind() {
        _ if path.starts_with(EMBEDDED) => None,
        io::ErrorKind::NotFound => other_file(path),
        io::ErrorKind::IsADirectory => {
            let folder = path.trim_end_matches('/');
            let names = files_of(folder);
            listed(&names.iter().map(String::as_str).collect::<Vec<_>>())
                .map(|names| format!("name a file in it: {names}"))
        }
        _ => None,
    };
    match advice {
        Some(advice) => io::Error::new(error.kind(), format!("{error}; {advice}")),
        None => error,
    }
}

fn other_file(path: &str) -> Option<String> {
    let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
    if !folder.is_empty() && !std::path::Path::new(folder).is_dir() {
        return Some(format!("there is no folder {folder}"));
    }
    let folders: &[&str] = if path == name {
        &["", SCENES]
    } else {
        &[folder]
    };
    let (stem, ending) = split(name);
    let like_it = |found: &&String| ending.is_none() || split(file_name(found)).1 == ending;
    let found: Vec<String> = folders.iter().flat_map(|folder| files_of(folder)).collect();
    let mut found: Vec<&String> = found.iter().filter(like_it).collect();
    // A name without its ending is a scene's rather than a program's.
    found.sort_by_key(|path| split(file_name(path)).1 != Some("toml"));
    let likeness = |path: &str| strsim::jaro_winkler(stem, split(file_name(path)).0);
    // Of equals the first.
    let nearest = found.iter().rev().max_by(|a, b| {
        let (a, b) = (likeness(a), likeness(b));
        a.total_cmp(&b)
    });
    match nearest {
        Some(path) if likeness(path) >= ALIKE => Some(format!("did you mean {path:?}?")),
        _ => listed(&found.iter().map(|path| path.as_str()).collect::<Vec<_>>())
            .map(|names| format!("there are {names}")),
    }
}

/// Paths of the files in a folder, in order; none if it cannot be read. An empty name is the working folder.
fn files_of(folder: &str) -> Vec<String> {
    let place = if folder.is_empty() { "." } else { folder };
    let mut paths: Vec<String> = std::fs::read_dir(place)
        .into_iter()
        .flatten()
        .flatten()
        .filter(|entry| entry.file_type().is_ok_and(|kind| !kind.is_dir()))
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| !name.starts_with('.') && !name.ends_with(SCHEMA))
        .map(|name| match folder {
            "" => name,
            folder => format!("{folder}/{name}"),
        })
        .collect();
    paths.sort();
    paths
}

fn listed(paths: &[&str]) -> Option<String> {
    (1..=MOST_NAMES)
        .contains(&paths.len())
        .then(|| paths.join(", "))
}

fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

/// Name and ending.
fn split(name: &str) -> (&str, Option<&str>) {
    name.rsplit_once('.')
        .map_or((name, None), |(stem, ending)| (stem, Some(ending)))
}
