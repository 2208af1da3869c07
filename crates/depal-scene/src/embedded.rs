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
        "assets/grippers/bellows_2x6.toml",
        include_str!("../../../assets/grippers/bellows_2x6.toml"),
    ),
    (
        "assets/grippers/foam_4_sections.toml",
        include_str!("../../../assets/grippers/foam_4_sections.toml"),
    ),
    (
        "assets/grippers/single_cup.toml",
        include_str!("../../../assets/grippers/single_cup.toml"),
    ),
    (
        "assets/krl/mm_module.src",
        include_str!("../../../assets/krl/mm_module.src"),
    ),
    (
        "assets/krl/mm_module.dat",
        include_str!("../../../assets/krl/mm_module.dat"),
    ),
    (
        "assets/krl/XML_Kuka_MMIND.xml",
        include_str!("../../../assets/krl/XML_Kuka_MMIND.xml"),
    ),
    (
        "urdf/abb_irb6700_150_320.urdf",
        include_str!("../../../urdf/abb_irb6700_150_320.urdf"),
    ),
];

/// Folder of the grippers that are known by name.
const GRIPPERS: &str = "assets/grippers/";

/// Path of the gripper of this name.
pub(crate) fn gripper_path(name: &str) -> String {
    format!("{GRIPPERS}{name}.toml")
}

/// Names of the embedded grippers.
pub(crate) fn gripper_names() -> Vec<&'static str> {
    let paths = FILES.iter().map(|(path, _)| *path);
    paths
        .filter_map(|path| path.strip_prefix(GRIPPERS)?.strip_suffix(".toml"))
        .collect()
}

/// The text of an embedded file.
pub(crate) fn text(path: &str) -> Option<&'static str> {
    FILES
        .iter()
        .find(|(name, _)| *name == path)
        .map(|(_, text)| *text)
}
