//! What belongs to a task: its modules and the configuration of its controller, out of files and folders.

use std::path::{Path, PathBuf};

use depal_controller::{
    ConfigurationError, EioConfiguration, SioConfiguration, SysConfiguration, configuration_domain,
};
use depal_vm::SourceFile;

use crate::failure::Failure;

/// Folders deeper than this are not looked into.
const DEEPEST: usize = 12;

/// The files of a task, found but not read.
#[derive(Debug, Default)]
pub struct TaskFiles {
    /// Modules, in the order given or by name, without those that a program list leaves out.
    pub modules: Vec<PathBuf>,
    /// Configuration files (.cfg).
    pub configurations: Vec<PathBuf>,
    /// Program lists (.pgf).
    pub lists: Vec<PathBuf>,
    /// Files that are none of these and were named themselves.
    pub others: Vec<PathBuf>,
    /// Files of the robot's HOME folder, with their path in it.
    pub home: Vec<(String, PathBuf)>,
}

/// What a controller's configuration files say.
#[derive(Debug, Default)]
pub struct ControllerFiles {
    /// Signals and cross connections.
    pub io: EioConfiguration,
    /// Whether there was an I/O configuration.
    pub has_io: bool,
    /// Tasks and event routines.
    pub system: SysConfiguration,
}

pub fn extension(path: &Path) -> String {
    path.extension()
        .map(|extension| extension.to_string_lossy().to_lowercase())
        .unwrap_or_default()
}

pub fn is_module(path: &Path) -> bool {
    matches!(
        extension(path).as_str(),
        "mod" | "sys" | "prg" | "modx" | "sysx"
    )
}

fn is_system_module(path: &Path) -> bool {
    matches!(extension(path).as_str(), "sys" | "sysx")
}

fn named(path: &Path, name: &str) -> bool {
    path.file_name()
        .is_some_and(|found| found.to_string_lossy().eq_ignore_ascii_case(name))
}

pub fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path)
        .map_err(|error| Failure::Input(format!("cannot read {}: {error}", path.display())))
}

fn text(path: &Path) -> Result<String, Failure> {
    Ok(depal_rapid::decode(&read(path)?))
}

impl TaskFiles {
    /// From files and folders as given. A folder is a task: a program list in it names the program modules,
    /// system modules come in any case; in a controller backup the modules lie below RAPID/TASKn, and the
    /// files below HOME are those of the program.
    pub fn find(paths: &[PathBuf], task: usize) -> Result<Self, Failure> {
        let mut found = Self::default();
        for path in paths {
            if path.is_dir() {
                found.add_folder(path, task)?;
            } else if is_module(path) {
                found.modules.push(path.clone());
            } else if extension(path) == "pgf" {
                found.add_list(path)?;
            } else if extension(path) == "cfg" {
                found.configurations.push(path.clone());
            } else {
                found.others.push(path.clone());
            }
        }
        Ok(found)
    }

    fn add_list(&mut self, path: &Path) -> Result<(), Failure> {
        let folder = path.parent().unwrap_or(Path::new(""));
        for name in depal_rapid::program_list(&text(path)?) {
            let listed = folder.join(name);
            if !self.modules.contains(&listed) {
                self.modules.push(listed);
            }
        }
        self.lists.push(path.to_owned());
        Ok(())
    }

    fn add_folder(&mut self, folder: &Path, task: usize) -> Result<(), Failure> {
        let mut files = Vec::new();
        gather(folder, 0, &mut files)?;
        let below = |path: &Path, names: &[&str]| {
            let rest = path.strip_prefix(folder).unwrap_or(path);
            rest.components().zip(names).all(|(found, name)| {
                found
                    .as_os_str()
                    .to_string_lossy()
                    .eq_ignore_ascii_case(name)
            }) && rest.components().count() > names.len()
        };
        let is_backup = files.iter().any(|path| below(path, &["RAPID"]));
        let own = format!("TASK{task}");
        if is_backup {
            for path in &files {
                if below(path, &["HOME"]) {
                    let home = path.components().skip(folder.components().count() + 1);
                    let name: Vec<_> = home
                        .map(|c| c.as_os_str().to_string_lossy().into_owned())
                        .collect();
                    self.home.push((name.join("/"), path.clone()));
                }
            }
            files.retain(|path| {
                below(path, &["RAPID", &own])
                    || (extension(path) == "cfg" && !below(path, &["HOME"]))
            });
        }
        let lists: Vec<_> = files
            .iter()
            .filter(|path| extension(path) == "pgf")
            .cloned()
            .collect();
        for list in &lists {
            self.add_list(list)?;
        }
        for path in files {
            if extension(&path) == "cfg" {
                self.configurations.push(path);
            } else if is_module(&path)
                && (lists.is_empty() || is_system_module(&path))
                && !self.modules.contains(&path)
            {
                self.modules.push(path);
            }
        }
        if self.modules.is_empty() && self.configurations.is_empty() {
            return Err(Failure::Input(format!(
                "{}: no modules (.mod, .sys, .prg, .modx, .sysx), program lists (.pgf) or configurations (.cfg) in this folder",
                folder.display()
            )));
        }
        Ok(())
    }

    /// The modules with their text.
    pub fn sources(&self) -> Result<Vec<SourceFile>, Failure> {
        self.modules
            .iter()
            .map(|path| Ok(SourceFile::new(path.to_string_lossy(), text(path)?)))
            .collect()
    }
}

/// All files below a folder, by name.
fn gather(folder: &Path, depth: usize, files: &mut Vec<PathBuf>) -> Result<(), Failure> {
    let failed = |error: std::io::Error| {
        Failure::Input(format!(
            "cannot read the folder {}: {error}",
            folder.display()
        ))
    };
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        paths.push(entry.map_err(failed)?.path());
    }
    paths.sort();
    for path in paths {
        // Links are not followed: a folder could hold itself.
        if path.is_symlink() {
            continue;
        }
        if path.is_dir() {
            if depth < DEEPEST {
                gather(&path, depth + 1, files)?;
            }
        } else {
            files.push(path);
        }
    }
    Ok(())
}

/// What is wrong in a configuration file, as `path:line: message`.
pub fn told(path: &Path, errors: &[ConfigurationError]) -> Vec<String> {
    errors
        .iter()
        .map(|e| format!("{}:{}: {}", path.display(), e.line, e.message))
        .collect()
}

/// What one configuration file holds, in a few words.
///
/// # Errors
/// What is wrong in it, by line.
pub fn read_configuration(
    path: &Path,
    text: &str,
    into: &mut ControllerFiles,
) -> Result<String, Vec<ConfigurationError>> {
    let domain = configuration_domain(text).unwrap_or_else(|| {
        // Without a head the name tells.
        let name = ["EIO", "SYS", "SIO"]
            .into_iter()
            .find(|name| named(path, &format!("{name}.cfg")));
        name.unwrap_or("EIO").to_owned()
    });
    match domain.as_str() {
        "EIO" => {
            let read = EioConfiguration::parse(text)?;
            let summary = format!(
                "good: {} signals, {} cross connections",
                read.signals.len(),
                read.connections.len()
            );
            into.io.signals.extend(read.signals);
            into.io.connections.extend(read.connections);
            into.has_io = true;
            Ok(summary)
        }
        "SYS" => {
            let read = SysConfiguration::parse(text)?;
            let summary = format!(
                "good: {} tasks, {} modules, {} event routines",
                read.tasks.len(),
                read.modules.len(),
                read.events.len()
            );
            into.system = read;
            Ok(summary)
        }
        "SIO" => {
            let read = SioConfiguration::parse(text)?;
            Ok(format!("good: {} channels", read.channels.len()))
        }
        other => Ok(format!(
            "good: the configuration of {other} is not needed here"
        )),
    }
}

impl ControllerFiles {
    /// Reads all of them.
    pub fn read(paths: &[PathBuf]) -> Result<Self, Failure> {
        let mut all = Self::default();
        let mut wrong = Vec::new();
        for path in paths {
            if let Err(errors) = read_configuration(path, &text(path)?, &mut all) {
                wrong.extend(told(path, &errors));
            }
        }
        if wrong.is_empty() {
            Ok(all)
        } else {
            Err(Failure::Input(wrong.join("\n")))
        }
    }
}
