//! `depal init`: a folder to begin in.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::failure::Failure;

/// Arguments of `depal init`.
#[derive(Args)]
pub struct InitArgs {
    /// The robot's language.
    #[arg(long, value_enum, default_value = "rapid")]
    lang: Language,
    /// Folder to write into; it is made if it is not there. Files that are there are kept.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Languages with samples.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Language {
    /// ABB RAPID.
    Rapid,
}

macro_rules! files {
    ($($name:literal = $path:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../../assets/rapid/", $path)))),*]
    };
}

const RAPID: [(&str, &str); 14] = files![
    "MM_Module.mod" = "MM_Module.mod",
    "other_versions/MM_Module_1_7.mod" = "MM_Module_1_7.mod",
    "other_versions/MM_Module_2_x.mod" = "MM_Module_2_x.mod",
    "MM_Auto_Calib.mod" = "MM_Auto_Calib.mod",
    "MM_Com_Test.mod" = "MM_Com_Test.mod",
    "cell.mod" = "samples/cell.mod",
    "s01_vision_points.mod" = "samples/s01_vision_points.mod",
    "s02_viz_path.mod" = "samples/s02_viz_path.mod",
    "s03_do_list.mod" = "samples/s03_do_list.mod",
    "s04_branch_and_index.mod" = "samples/s04_branch_and_index.mod",
    "s05_lite_commands.mod" = "samples/s05_lite_commands.mod",
    "s06_error_handling.mod" = "samples/s06_error_handling.mod",
    "s07_plan_ahead.mod" = "samples/s07_plan_ahead.mod",
    "sample.toml" = "samples/sample.toml",
];

/// Writes the samples.
pub fn init(args: &InitArgs) -> Result<(), Failure> {
    let Language::Rapid = args.lang;
    let failed = |path: &Path, error: std::io::Error| {
        Failure::Environment(format!("cannot write {}: {error}", path.display()))
    };
    for (name, text) in RAPID {
        let path = args.folder.join(name);
        if path.exists() {
            tell!("kept: {}", path.display());
            continue;
        }
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(|error| failed(parent, error))?;
        }
        std::fs::write(&path, text).map_err(|error| failed(&path, error))?;
        say!("{}", path.display());
    }
    let scene = args.folder.join("sample.toml");
    tell!("try: depal run {}", scene.display());
    Ok(())
}
