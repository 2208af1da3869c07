//! Files that travel inside the program, named by their path in the source tree.

/// One row per file: path, text.
const FILES: &[(&str, &str)] = &[(
    "scenes/demo.toml",
    include_str!("../../../scenes/demo.toml"),
)];

/// The text of an embedded file.
pub(crate) fn text(path: &str) -> Option<&'static str> {
    FILES
        .iter()
        .find(|(name, _)| *name == path)
        .map(|(_, text)| *text)
}
