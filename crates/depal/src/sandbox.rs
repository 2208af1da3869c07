//! The folder of a program's files: read before it runs, written after.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// Larger files are left where they are, and all of them together may not be larger than ten of these.
const LARGEST: u64 = 16 << 20;
/// Folders deeper than this are not looked into.
const DEEPEST: usize = 8;

/// What was there before the program ran.
#[derive(Debug, Default)]
pub struct Sandbox {
    folder: Option<PathBuf>,
    files: BTreeMap<String, Vec<u8>>,
}

impl Sandbox {
    /// Files of a folder, or those of a backup's HOME.
    pub fn read(folder: Option<&Path>, home: &[(String, PathBuf)]) -> Result<Self, Failure> {
        let mut sandbox = Self {
            folder: folder.map(Path::to_owned),
            files: BTreeMap::new(),
        };
        match folder {
            Some(folder) => sandbox.gather(folder, "", 0)?,
            None => {
                for (name, path) in home {
                    sandbox.take(name, path)?;
                }
            }
        }
        Ok(sandbox)
    }

    /// By their path in the folder.
    pub fn files(&self) -> &BTreeMap<String, Vec<u8>> {
        &self.files
    }

    fn take(&mut self, name: &str, path: &Path) -> Result<(), Failure> {
        let failed = |error| Failure::unread(path, error);
        let size = std::fs::metadata(path).map_err(failed)?.len();
        let held: u64 = self.files.values().map(|bytes| bytes.len() as u64).sum();
        if size > LARGEST || held + size > 10 * LARGEST {
            tell!(
                "warning: {} is too large for the program's folder, it is left out",
                path.display()
            );
            return Ok(());
        }
        let bytes = std::fs::read(path).map_err(failed)?;
        self.files.insert(name.to_owned(), bytes);
        Ok(())
    }

    fn gather(&mut self, folder: &Path, below: &str, depth: usize) -> Result<(), Failure> {
        let failed = |error: std::io::Error| {
            Failure::Input(format!(
                "cannot read the folder {}: {error}",
                folder.display()
            ))
        };
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            let Some(name) = path
                .file_name()
                .map(|name| name.to_string_lossy().into_owned())
            else {
                continue;
            };
            let name = format!("{below}{name}");
            // A link could lead out of the folder.
            if path.is_symlink() {
                continue;
            }
            if path.is_dir() {
                if depth < DEEPEST {
                    self.gather(&path, &format!("{name}/"), depth + 1)?;
                }
            } else {
                self.take(&name, &path)?;
            }
        }
        Ok(())
    }

    /// Writes what the program changed, and removes what it removed. Without a folder nothing is written.
    pub fn write(&self, after: &BTreeMap<String, Vec<u8>>) -> Result<(), Failure> {
        let Some(folder) = &self.folder else {
            return Ok(());
        };
        let failed = |path: &Path, error: std::io::Error| {
            Failure::Environment(format!("cannot write {}: {error}", path.display()))
        };
        for (name, bytes) in after {
            // The names were made by the program's own rules: no part leads upwards.
            let path = folder.join(name);
            let mut part = folder.clone();
            for component in Path::new(name) {
                part.push(component);
                if part.is_symlink() {
                    return Err(Failure::Environment(format!(
                        "{} is a link; the program's files stay in {}",
                        part.display(),
                        folder.display()
                    )));
                }
            }
            if name.ends_with('/') {
                std::fs::create_dir_all(&path).map_err(|error| failed(&path, error))?;
            } else if self.files.get(name) != Some(bytes) {
                if let Some(parent) = path.parent() {
                    std::fs::create_dir_all(parent).map_err(|error| failed(parent, error))?;
                }
                std::fs::write(&path, bytes).map_err(|error| failed(&path, error))?;
            }
        }
        for name in self.files.keys().filter(|name| !after.contains_key(*name)) {
            let path = folder.join(name);
            std::fs::remove_file(&path).map_err(|error| failed(&path, error))?;
        }
        Ok(())
    }
}
