//! From text to a scene.

use crate::document::{Node, Place, Source, Table, Value, apply_override, merge, parse};
use crate::equip::equip;
use crate::error::{SceneErrors, SceneProblem};
use crate::files::{EMBEDDED, Resolver, beside, read_text};
use crate::language::Language;
use crate::reader::{Reader, Section as _};
use crate::scene::Scene;

/// Longest chain of `extends`.
const MAX_EXTENDS: usize = 8;

/// The embedded demo, named by its path in the source tree.
const DEMO: &str = "scenes/demo.toml";

impl Scene {
    /// Reads a scene.
    ///
    /// `source_name` is the path of the text: messages show it, and files that the scene names are
    /// looked for beside it. `overrides` are key and value in TOML (`camera.noise_mm`, `1.2`); a value
    /// that is not TOML is taken as text; later ones win; files that they name are looked for from the
    /// working directory. `seed` wins over the scene's own. `resolver` gives the text of the files that
    /// the scene names ([`read_text`] for real ones).
    ///
    /// # Errors
    /// Every problem of the text and the overrides at once, in the order of the text.
    pub fn load(
        text: &str,
        source_name: &str,
        overrides: &[(String, String)],
        seed: Option<u64>,
        resolver: Resolver<'_>,
    ) -> Result<Self, SceneErrors> {
        let mut problems = Vec::new();
        let mut sources = vec![Source {
            name: source_name.to_owned(),
            text: text.to_owned(),
            override_value: None,
        }];
        let Some(mut table) = chain(&mut sources, resolver, &mut problems) else {
            return Err(SceneErrors { problems });
        };
        for (key, value) in overrides {
            sources.push(Source {
                name: format!("--set {key}={value}"),
                text: String::new(),
                override_value: Some(value.clone()),
            });
            apply_override(&mut table, key, sources.len() - 1, &sources, &mut problems);
        }
        equip(&mut table, &mut sources, resolver, &mut problems);
        let mut reader = Reader {
            sources: &sources,
            resolver,
            problems,
        };
        let place = Place {
            source: 0,
            span: 0..0,
        };
        let scene = Self::read(&table, &place, "", &[], &mut reader);
        let mut problems = reader.problems;
        match scene {
            Some(mut scene) if problems.is_empty() => {
                if let Some(seed) = seed {
                    scene.seed = seed;
                }
                Ok(scene)
            }
            _ => {
                let order = |problem: &SceneProblem| {
                    let position = sources
                        .iter()
                        .position(|source| source.name == problem.source);
                    (position, problem.line, problem.column)
                };
                problems.sort_by_key(order);
                Err(SceneErrors { problems })
            }
        }
    }

    /// The scene inside the program: a full EUR pallet of 48 cartons.
    ///
    /// # Errors
    /// What is wrong with the overrides.
    pub fn demo(overrides: &[(String, String)], seed: Option<u64>) -> Result<Self, SceneErrors> {
        let name = format!("{EMBEDDED}{DEMO}");
        let text = read_text(&name).expect("the demo scene is in the table of embedded files");
        Self::load(&text, &name, overrides, seed, &read_text)
    }

    /// Reads a scene file.
    ///
    /// # Errors
    /// The file cannot be read, or as [`Scene::load`].
    pub fn load_file(
        path: &str,
        overrides: &[(String, String)],
        seed: Option<u64>,
    ) -> Result<Self, SceneErrors> {
        let refused = |message: String, hint: Option<String>| {
            Err(SceneErrors {
                problems: vec![SceneProblem {
                    source: path.to_owned(),
                    line: 0,
                    column: 0,
                    key: String::new(),
                    message,
                    hint,
                    source_line: String::new(),
                }],
            })
        };
        match (read_text(path), Language::of(path)) {
            (Err(error), _) => refused(format!("cannot read the scene: {error}"), None),
            (Ok(_), Some(language)) => refused(
                format!(
                    "expected a scene (.toml), found a {} program",
                    language.name()
                ),
                Some("name it in a scene as robot.program".to_owned()),
            ),
            (Ok(text), None) => Self::load(&text, path, overrides, seed, &read_text),
        }
    }
}

/// Parses the first source and everything that it extends, merged; `None` if a text is no TOML or
/// cannot be had.
fn chain(
    sources: &mut Vec<Source>,
    resolver: Resolver<'_>,
    problems: &mut Vec<SceneProblem>,
) -> Option<Table> {
    let mut layers = Vec::new();
    let mut at = 0;
    loop {
        let table = parse(sources, at, problems)?;
        let base = table.get("extends").map(|entry| entry.node.clone());
        layers.push(table);
        // Anything but a text is refused when the key is read.
        let Some(Node {
            value: Value::Text(written),
            place,
        }) = base
        else {
            break;
        };
        let path = beside(&sources[at].name, &written);
        let refusal = if sources.iter().any(|source| source.name == path) {
            Some(format!(
                "expected a file that does not extend itself, found {path} again"
            ))
        } else if sources.len() >= MAX_EXTENDS {
            Some(format!(
                "expected at most {MAX_EXTENDS} files in a chain, found more"
            ))
        } else {
            match resolver(&path) {
                Ok(text) => {
                    sources.push(Source {
                        name: path,
                        text,
                        override_value: None,
                    });
                    None
                }
                Err(error) => Some(format!("cannot read {path}: {error}")),
            }
        };
        if let Some(message) = refusal {
            problems.push(sources[at].problem(&place.span, "extends", message, None));
            return None;
        }
        at = sources.len() - 1;
    }
    let mut merged = Table::new();
    for layer in layers.into_iter().rev() {
        merge(&mut merged, layer);
    }
    Some(merged)
}
