//! The gripper of a scene out of a file of its own.

use crate::document::{Entry, Source, Table, Value, merge, parse};
use crate::embedded::{gripper_names, gripper_path};
use crate::error::SceneProblem;
use crate::files::{EMBEDDED, Resolver, beside};
use crate::reader::nearest;

/// Lays the keys of `gripper` over those of the file that `gripper.model` or `gripper.file` names.
pub(crate) fn equip(
    scene: &mut Table,
    sources: &mut Vec<Source>,
    resolver: Resolver<'_>,
    problems: &mut Vec<SceneProblem>,
) {
    let Some(gripper) = scene.get_mut("gripper") else {
        return;
    };
    let Value::Table(own) = &mut gripper.node.value else {
        return;
    };
    // Anything but a text is refused when the key is read.
    let named = |key: &str| match own.get(key) {
        Some(Entry { node, .. }) => match &node.value {
            Value::Text(text) => Some((text.clone(), node.place.clone())),
            _ => None,
        },
        None => None,
    };
    let (key, written, place) = match (named("model"), named("file")) {
        (Some(_), Some((_, place))) => {
            let message = "expected either model or file, found both".to_owned();
            let source = &sources[place.source];
            problems.push(source.problem(&place.span, "gripper.file", message, None));
            return;
        }
        (Some((name, place)), None) => ("gripper.model", name, place),
        (None, Some((path, place))) => ("gripper.file", path, place),
        (None, None) => return,
    };
    let origin = &sources[place.source];
    let path = if key == "gripper.model" {
        let known = gripper_names();
        if !known.contains(&written.as_str()) {
            let message = format!("expected the name of a gripper, found {written:?}");
            let hint = Some(nearest(&written, &known));
            problems.push(origin.problem(&place.span, key, message, hint));
            return;
        }
        format!("{EMBEDDED}{}", gripper_path(&written))
    } else if origin.override_value.is_some() {
        written
    } else {
        beside(&origin.name, &written)
    };
    let text = match resolver(&path) {
        Ok(text) => text,
        Err(error) => {
            let message = format!("cannot read {path}: {error}");
            problems.push(origin.problem(&place.span, key, message, None));
            return;
        }
    };
    sources.push(Source {
        name: path,
        text,
        override_value: None,
    });
    let at = sources.len() - 1;
    let Some(mut table) = parse(sources, at, problems) else {
        return;
    };
    for key in ["model", "file"] {
        if let Some(entry) = table.remove(key) {
            let message = "expected a gripper that names no other one".to_owned();
            problems.push(sources[at].problem(&entry.key_place.span, key, message, None));
        }
    }
    merge(&mut table, std::mem::take(own));
    *own = table;
}
