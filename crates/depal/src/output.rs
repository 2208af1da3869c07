//! The folder of a run's results.

use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// A folder that exists and takes files. Results of an earlier run in it are removed first, so that what
/// lies there in the end belongs together.
pub struct OutFolder {
    path: PathBuf,
}

impl OutFolder {
    /// Makes the folder.
    pub fn open(path: PathBuf) -> Result<Self, Failure> {
        let failed = |error: std::io::Error| {
            Failure::Environment(format!(
                "cannot write results to {}: {error}\nhelp: name another folder with --out DIR",
                path.display()
            ))
        };
        std::fs::create_dir_all(&path).map_err(failed)?;
        for name in ["report.json", "events.jsonl", "run.rrd"] {
            match std::fs::remove_file(path.join(name)) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                    return Err(failed(error));
                }
                _ => {}
            }
        }
        Ok(Self { path })
    }

    /// Path of a file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Writes a whole file: first under another name, then renamed.
    pub fn write(&self, name: &str, text: &str) -> Result<(), Failure> {
        let (partial, path) = (self.file(&format!("{name}.partial")), self.file(name));
        std::fs::write(&partial, text)
            .and_then(|()| std::fs::rename(&partial, &path))
            .map_err(|error| {
                Failure::Environment(format!("cannot write {}: {error}", path.display()))
            })
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder.
    pub fn into_path(self) -> PathBuf {
        self.path
    }
}
