//! `depal replay`: opens a recording in the rerun viewer, or pictures it without a display.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::failure::Failure;

/// Viewer that belongs to the recording format; newer ones read it too.
const VIEWER: &str = "rerun-sdk==0.36.3";
/// The viewer's exit code when no graphics driver can be used.
const NO_GRAPHICS: i32 = 102;

/// Opens `recording`, or writes a picture of its last instant to `png`.
pub fn replay(recording: &Path, png: Option<&Path>) -> Result<(), Failure> {
    if !recording.is_file() {
        return Err(Failure::Input(format!(
            "no recording at {}\nhelp: `depal run` writes one to out/<scene>-<seed>/run.rrd",
            recording.display()
        )));
    }
    let viewer = find_viewer().ok_or_else(|| {
        Failure::Environment(format!(
            "the rerun viewer is not installed\nhelp: `pip install {VIEWER}` puts `rerun` on the path; then run this command again\n\
             help: the report beside the recording says the same in text"
        ))
    })?;
    let mut command = Command::new(&viewer);
    command.arg(recording).env("RUST_LOG", "error");
    if let Some(png) = png {
        command
            .args(["--headless", "--port", "auto", "--bind", "127.0.0.1"])
            .args(["--window-size", "1400x840", "--screenshot-to"])
            .arg(png);
    }
    let status = command.status().map_err(|error| {
        Failure::Environment(format!("cannot start {}: {error}", viewer.display()))
    })?;
    match status.code() {
        Some(0) if png.is_none_or(Path::is_file) => Ok(()),
        Some(NO_GRAPHICS) => Err(Failure::Environment(
            "the viewer found no graphics driver to draw with\n\
             help: a software driver is enough; on Debian: `apt-get install mesa-vulkan-drivers libvulkan1`"
                .into(),
        )),
        code => Err(Failure::Environment(format!(
            "the viewer ended with {}",
            code.map_or("a signal".into(), |code| format!("exit code {code}"))
        ))),
    }
}

/// `rerun` on the path.
fn find_viewer() -> Option<PathBuf> {
    let name = if cfg!(windows) { "rerun.exe" } else { "rerun" };
    std::env::split_paths(&std::env::var_os("PATH")?)
        .map(|folder| folder.join(name))
        .find(|candidate| candidate.is_file())
}
