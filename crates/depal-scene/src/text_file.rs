//! Text files that a scene names.

use serde::Serialize;
use serde_json::Value as Json;

use crate::document::Node;
use crate::files::beside;
use crate::reader::{Reader, Rule};
use crate::rules::Text;

/// A text file that a scene names, already read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextFile {
    /// Where it was read from: relative to the working directory, or `embedded:PATH`.
    pub path: String,
    /// Its whole text.
    pub text: String,
}

impl Serialize for TextFile {
    /// Only the path: the text is not a part of the scene.
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.path.serialize(serializer)
    }
}

/// The path of a text file: beside the scene file, or from the working directory in an override.
pub(crate) struct File;

impl Rule for File {
    type Output = TextFile;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<TextFile> {
        let written = Text.read(node, key, reader)?;
        let source = &reader.sources[node.place.source];
        let path = if source.override_value.is_some() {
            written
        } else {
            beside(&source.name, &written)
        };
        match (reader.resolver)(&path) {
            Ok(text) => Some(TextFile { path, text }),
            Err(error) => {
                let message = format!("cannot read {path}: {error}");
                reader.problem(&node.place, key, message, None);
                None
            }
        }
    }

    fn schema(&self) -> Json {
        Text.schema()
    }
}
