//! Folders of the packages that a robot description speaks of.

use std::collections::BTreeMap;

use serde_json::{Value as Json, json};

use crate::document::{Node, Value};
use crate::files::beside;
use crate::reader::{Reader, Rule, join};
use crate::rules::Text;

/// Most packages of one description.
const MOST: usize = 64;

/// A table of folders by the names of packages: beside the scene file, or from the working directory in an override.
pub(crate) struct Packages;

impl Rule for Packages {
    type Output = BTreeMap<String, String>;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<Self::Output> {
        let table = match &node.value {
            Value::Table(table) if table.len() <= MOST => table,
            _ => {
                let expected = format!("a table of up to {MOST} folders by the names of packages");
                reader.unexpected(node, key, &expected);
                return None;
            }
        };
        let mut folders = BTreeMap::new();
        for (name, entry) in table {
            let written = Text.read(&entry.node, &join(key, name), reader)?;
            let source = &reader.sources[entry.node.place.source];
            let path = match source.override_value {
                Some(_) => written,
                None => beside(&source.name, &written),
            };
            folders.insert(name.clone(), path);
        }
        Some(folders)
    }

    fn schema(&self) -> Json {
        json!({"type": "object", "additionalProperties": Text.schema(), "maxProperties": MOST})
    }
}
