//! Files that travel inside the program, named by their path in the source tree.

/// One row per file: path, text.
const FILES: &[(&str, &str)] = &[
    (
        "scenes/demo.toml",
        include_str!("../../../scenes/demo.toml"),
    ),
    ("scenes/demo.mod", include_str!("../../../scenes/demo.mod")),
    (
        "assets/rapid/MM_Module.mod",
        include_str!("../../../assets/rapid/MM_Module.mod"),
    ),
    (
        "assets/rapid/MM_Module_1_7.mod",
        include_str!("../../../assets/rapid/MM_Module_1_7.mod"),
    ),
    (
        "assets/rapid/MM_Module_2_x.mod",
        include_str!("../../../assets/rapid/MM_Module_2_x.mod"),
    ),
    (
        "urdf/abb_irb6700_150_320.urdf",
        include_str!("../../../urdf/abb_irb6700_150_320.urdf"),
    ),
];

/// The text of an embedded file.
pub(crate) fn text(path: &str) -> Option<&'static str> {
    FILES
        .iter()
        .find(|(name, _)| *name == path)
        .map(|(_, text)| *text)
}
