//! What belongs to a task: its modules and the configuration of its controller, out of files and folders.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use depal_controller::{
    ConfigurationData, ConfigurationError, EioConfiguration, SioConfiguration, SysConfiguration,
    configuration_domain,
};
use depal_vm::SourceFile;

use crate::failure::Failure;

/// Folders deeper than this are not looked into.
const DEEPEST: usize = 12;

/// The modules of one task in a controller backup.
#[derive(Debug, Default)]
pub struct BackupTask {
    /// N of its folder RAPID/TASKn.
    pub number: usize,
    /// Modules by name, without those that a program list leaves out.
    pub modules: Vec<PathBuf>,
    /// Program lists (.pgf).
    pub lists: Vec<PathBuf>,
}

/// The files of a task, found but not read; of all tasks if a controller backup is among them.
#[derive(Debug, Default)]
pub struct TaskFiles {
    /// Modules, in the order given or by name, without those that a program list leaves out.
    pub modules: Vec<PathBuf>,
    /// The tasks of a backup, by number; their modules are not among `modules`.
    pub tasks: Vec<BackupTask>,
    /// Names of the tasks of a backup, by number, as far as it tells them.
    pub task_names: BTreeMap<usize, String>,
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
    /// Every attribute of all files, for programs that ask.
    pub data: ConfigurationData,
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
    std::fs::read(path).map_err(|error| Failure::unread(path, error))
}

fn text(path: &Path) -> Result<String, Failure> {
    Ok(depal_rapid::decode(&read(path)?))
}

impl TaskFiles {
    /// From files and folders as given. A folder is a task: a program list in it names the program modules,
    /// system modules come in any case; in a controller backup the modules lie below RAPID/TASKn, and the
    /// files below HOME are those of the program. `task`: only the one of this number.
    pub fn find(paths: &[PathBuf], task: Option<usize>) -> Result<Self, Failure> {
        let mut found = Self::default();
        for path in paths {
            if path.is_dir() {
                found.add_folder(path, task)?;
            } else if is_module(path) {
                found.modules.push(path.clone());
            } else if extension(path) == "pgf" {
                found.modules.extend(listed(path)?);
                found.lists.push(path.clone());
            } else if extension(path) == "cfg" {
                found.configurations.push(path.clone());
            } else {
                found.others.push(path.clone());
            }
        }
        Ok(found)
    }

    fn add_folder(&mut self, folder: &Path, task: Option<usize>) -> Result<(), Failure> {
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
        let mut programs: BTreeMap<usize, Vec<PathBuf>> = BTreeMap::new();
        if is_backup {
            for path in &files {
                if below(path, &["HOME"]) {
                    let home = path.components().skip(folder.components().count() + 1);
                    let name: Vec<_> = home
                        .map(|c| c.as_os_str().to_string_lossy().into_owned())
                        .collect();
                    self.home.push((name.join("/"), path.clone()));
                }
                if below(path, &["RAPID"])
                    && let Some(number) = task_number(path.strip_prefix(folder).unwrap_or(path))
                    && task.is_none_or(|task| task == number)
                {
                    programs.entry(number).or_default().push(path.clone());
                }
                if named(path, "backinfo.txt") {
                    self.task_names.extend(task_names(&text(path)?));
                }
            }
            files.retain(|path| {
                extension(path) == "cfg" && !below(path, &["HOME"]) && !below(path, &["RAPID"])
            });
        }
        for (number, files) in programs {
            let (modules, lists) = task_modules(&files)?;
            if !modules.is_empty() {
                self.tasks.push(BackupTask {
                    number,
                    modules,
                    lists,
                });
            }
        }
        let (modules, lists) = task_modules(&files)?;
        self.lists.extend(lists);
        for module in modules {
            if !self.modules.contains(&module) {
                self.modules.push(module);
            }
        }
        let is_configuration = |path: &PathBuf| extension(path) == "cfg";
        self.configurations
            .extend(files.into_iter().filter(is_configuration));
        if self.modules.is_empty() && self.tasks.is_empty() && self.configurations.is_empty() {
            return Err(Failure::Input(format!(
                "{}: no modules (.mod, .sys, .prg, .modx, .sysx), program lists (.pgf) or configurations (.cfg) in this folder",
                folder.display()
            )));
        }
        Ok(())
    }
}

/// Modules with their text.
pub fn sources(modules: &[PathBuf]) -> Result<Vec<SourceFile>, Failure> {
    modules
        .iter()
        .map(|path| Ok(SourceFile::new(path.to_string_lossy(), text(path)?)))
        .collect()
}

/// The modules that a program list names.
fn listed(list: &Path) -> Result<Vec<PathBuf>, Failure> {
    let folder = list.parent().unwrap_or(Path::new(""));
    let names = depal_rapid::program_list(&text(list)?);
    Ok(names.into_iter().map(|name| folder.join(name)).collect())
}

/// Modules and program lists among the files of a task: with a list its modules and the system modules, else all.
fn task_modules(files: &[PathBuf]) -> Result<(Vec<PathBuf>, Vec<PathBuf>), Failure> {
    let is_list = |path: &&PathBuf| extension(path) == "pgf";
    let lists: Vec<_> = files.iter().filter(is_list).cloned().collect();
    let mut modules = Vec::new();
    for list in &lists {
        for module in listed(list)? {
            if !modules.contains(&module) {
                modules.push(module);
            }
        }
    }
    for path in files {
        if is_module(path)
            && (lists.is_empty() || is_system_module(path))
            && !modules.contains(path)
        {
            modules.push(path.clone());
        }
    }
    Ok((modules, lists))
}

/// N of a path RAPID/TASKn/..
fn task_number(path: &Path) -> Option<usize> {
    let name = path.components().nth(1)?.as_os_str().to_string_lossy();
    name.to_uppercase().strip_prefix("TASK")?.parse().ok()
}

/// Names of tasks in the list of contents of a backup: lines as `>>TASK1: (T_ROB1,,)`.
fn task_names(text: &str) -> Vec<(usize, String)> {
    let name = |line: &str| {
        let (number, rest) = line.trim().strip_prefix(">>TASK")?.split_once(':')?;
        let name = rest.trim().strip_prefix('(')?.split([',', ')']).next()?;
        Some((number.trim().parse().ok()?, name.trim().to_owned()))
    };
    text.lines().filter_map(name).collect()
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
    into.data.read(&domain, text)?;
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
