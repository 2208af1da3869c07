//! `depal check`: everything that is wrong with a set of files, at once, without running them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use depal_arm::{Arm, ArmWarning, Place};
use depal_scene::{Language, Scene};
use depal_vm::{Diagnostic, Program, Severity, SourceFile, sharing_conflicts};

use crate::check_language::{self, is_channel, language_of};
use crate::diagnostics::{draw, tell_all};
use crate::failure::{Failure, cannot_read};
use crate::robot_files::mesh_files;
use crate::run::explain;
use crate::task_folder::{ControllerFiles, TaskFiles, extension, read_configuration, told};

/// Accelerations with which a bare URDF is checked, rad/s2; the value does not matter.
const NOMINAL_ACCELERATION: f64 = 1.0;

/// What was found in one file.
struct Verdict {
    path: String,
    summary: String,
    findings: Vec<Finding>,
}

/// One message with its place, both from 1.
struct Finding {
    code: String,
    severity: Severity,
    line: u32,
    column: u32,
    message: String,
}

impl Finding {
    /// A problem of a whole file.
    fn of_file(code: &str, message: String) -> Self {
        Self {
            code: code.to_owned(),
            severity: Severity::Error,
            line: 1,
            column: 1,
            message,
        }
    }
}

impl Verdict {
    fn errors(&self) -> usize {
        let is_error = |finding: &&Finding| finding.severity == Severity::Error;
        self.findings.iter().filter(is_error).count()
    }
}

/// Checks every file; programs of one language given together are one task, unless only their syntax is asked for.
pub fn check(files: &[PathBuf], json: bool, syntax_only: bool) -> Result<(), Failure> {
    let mut verdicts = Vec::new();
    // One list for each task: the modules with their places among the verdicts.
    let mut tasks: Vec<Vec<(usize, &PathBuf)>> = Vec::new();
    let mut others: BTreeMap<Language, Vec<(usize, &PathBuf)>> = BTreeMap::new();
    let mut controller = ControllerFiles::default();
    let found = TaskFiles::find(files, None)?;
    let plain = found.others.iter().chain(&found.configurations);
    let lists = found.tasks.iter().flat_map(|task| &task.lists);
    let plain = found.lists.iter().chain(lists).chain(plain);
    let programs = found.tasks.iter().map(|task| &task.modules);
    let programs = std::iter::once(&found.modules).chain(programs);
    let with_task = programs
        .enumerate()
        .flat_map(|(task, modules)| modules.iter().map(move |module| (module, task)));
    for (path, task) in plain.map(|path| (path, 0)).chain(with_task) {
        let name = path.to_string_lossy().into_owned();
        let (code, verdict) = match extension(path).as_str() {
            "toml" => ("SCENE", check_scene(path).map_err(of_file)),
            "urdf" => ("URDF", check_arm(path)),
            "cfg" => ("CFG", check_configuration(path, &mut controller)),
            "pgf" => ("PGF", Ok("good".to_owned())),
            other => match language_of(path) {
                Some(Language::Rapid) => {
                    if tasks.len() <= task {
                        tasks.resize(task + 1, Vec::new());
                    }
                    tasks[task].push((verdicts.len(), path));
                    ("RAPID", Ok("good".to_owned()))
                }
                Some(language) => {
                    let same = others.entry(language).or_default();
                    same.push((verdicts.len(), path));
                    (language.name(), Ok("good".to_owned()))
                }
                None => (
                    "FILE",
                    Err(of_file(vec![format!(
                        "{name}: no check for files of type {other:?}; expected .toml, .urdf, .cfg, RAPID (.mod, .sys, \
                         .prg, .modx, .sysx, .pgf), KRL (.src, .dat, .sub, or .xml of a channel) or TP (.ls)"
                    )])),
                ),
            },
        };
        let (summary, findings) = match verdict {
            Ok(summary) => (summary, Vec::new()),
            Err(messages) => {
                let findings = messages.into_iter().map(|(line, message)| {
                    tell!("error: {message}");
                    Finding {
                        line,
                        ..Finding::of_file(code, message)
                    }
                });
                (String::new(), findings.collect())
            }
        };
        verdicts.push(Verdict {
            path: name,
            summary,
            findings,
        });
    }
    // The order of the arguments; what came out of folders stands behind.
    let place = |path: &str| {
        files
            .iter()
            .position(|given| given.to_string_lossy() == path)
    };
    let signals = controller.has_io.then_some(&controller.io);
    let mut programs = Vec::new();
    for (index, modules) in tasks.iter().enumerate() {
        let program = check_programs(Language::Rapid, modules, &mut verdicts, |sources| {
            check_language::check(Language::Rapid, sources, signals, syntax_only)
        });
        let number = index
            .checked_sub(1)
            .map_or(0, |task| found.tasks[task].number);
        let name = found.task_names.get(&number).cloned();
        let name = name.unwrap_or_else(|| format!("TASK{number}"));
        programs.extend(program.map(|program| (name, program)));
    }
    let programs: Vec<_> = programs
        .iter()
        .map(|(name, program)| (name.as_str(), program.as_ref()))
        .collect();
    for conflict in sharing_conflicts(&programs) {
        tell!("warning: {conflict}");
    }
    for (language, files) in &mut others {
        files.sort_by_key(|(_, path)| is_channel(path));
        check_programs(*language, files, &mut verdicts, |sources| {
            check_language::check(*language, sources, signals, syntax_only)
        });
    }
    verdicts.sort_by_key(|verdict| place(&verdict.path).unwrap_or(usize::MAX));
    let errors: usize = verdicts.iter().map(Verdict::errors).sum();
    if json {
        say!("{}", document(&verdicts));
    } else {
        for verdict in &verdicts {
            match verdict.errors() {
                0 => say!("{}: {}", verdict.path, verdict.summary),
                _ if verdict.summary.is_empty() => {}
                count => say!("{}: {count} error(s)", verdict.path),
            }
        }
    }
    if errors == 0 {
        Ok(())
    } else {
        Err(Failure::Input(format!("{errors} problem(s) found")))
    }
}

fn document(verdicts: &[Verdict]) -> serde_json::Value {
    let files: Vec<_> = verdicts
        .iter()
        .map(|verdict| {
            let diagnostics: Vec<_> = verdict
                .findings
                .iter()
                .map(|finding| {
                    serde_json::json!({
                        "code": finding.code,
                        "severity": finding.severity.name(),
                        "line": finding.line,
                        "column": finding.column,
                        "message": finding.message,
                    })
                })
                .collect();
            serde_json::json!({
                "path": verdict.path,
                "ok": verdict.errors() == 0,
                "diagnostics": diagnostics,
            })
        })
        .collect();
    serde_json::json!({ "files": files })
}

/// A scene with everything that it names: arm, program, planning project.
fn check_scene(path: &Path) -> Result<String, Vec<String>> {
    let scene = Scene::load_file(&path.to_string_lossy(), &[], None).map_err(|errors| {
        errors
            .problems
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
    })?;
    let built = scene
        .build()
        .map_err(|error| vec![format!("{}: {}", path.display(), explain(&error))])?;
    for warning in &built.warnings {
        tell!("{}", draw(warning, &built.sources));
    }
    let projects: Vec<i32> = built.spec.projects.keys().copied().collect();
    let paths = built.spec.projects.values().filter_map(|p| p.path.as_ref());
    let faults: Vec<String> = paths
        .chain([&built.spec.workflow])
        .flat_map(|workflow| workflow.check(&projects))
        .map(|fault| format!("{}: {fault}", path.display()))
        .collect();
    if !faults.is_empty() {
        return Err(faults);
    }
    let program = match &scene.plc {
        Some(plc) => format!("run by a controller with data block {}", plc.db),
        None => format!("{} program file(s)", built.sources.len()),
    };
    Ok(format!(
        "good: {} cartons, {}, {program}; the Viz project:\n{}",
        built.spec.cartons.len(),
        built.spec.arm.name(),
        built.spec.workflow.to_string().trim_end()
    ))
}

/// A bare arm: its file, and the meshes that it collides with.
fn check_arm(path: &Path) -> Result<String, Vec<(u32, String)>> {
    let text =
        std::fs::read_to_string(path).map_err(|error| of_file(vec![cannot_read(path, error)]))?;
    let files = mesh_files(path);
    let meshes = |mesh: &str| files.bytes(mesh);
    let name = path.to_string_lossy();
    let in_line = |place: &Place, message: String| (place.line.unwrap_or(1) as u32, message);
    let arm = Arm::from_urdf_uniform_with_meshes(&text, &name, NOMINAL_ACCELERATION, &meshes)
        .map_err(|error| vec![in_line(error.place(), error.to_string())])?;
    let (lost, others): (Vec<&ArmWarning>, Vec<&ArmWarning>) = arm
        .warnings()
        .iter()
        .partition(|warning| matches!(warning, ArmWarning::MeshUnread { .. }));
    for warning in others {
        tell!("warning: {warning}");
    }
    if !lost.is_empty() {
        let told = |warning: &&ArmWarning| in_line(warning.place(), warning.to_string());
        return Err(lost.iter().map(told).collect());
    }
    Ok(format!(
        "good: {} with {} joints and {} links",
        arm.name(),
        arm.joint_count(),
        arm.links().len()
    ))
}

/// Messages without a line of their own.
fn of_file(messages: Vec<String>) -> Vec<(u32, String)> {
    messages.into_iter().map(|message| (1, message)).collect()
}

/// A configuration file of a controller, with what it says taken over.
fn check_configuration(
    path: &Path,
    controller: &mut ControllerFiles,
) -> Result<String, Vec<(u32, String)>> {
    let bytes = std::fs::read(path).map_err(|error| of_file(vec![cannot_read(path, error)]))?;
    let text = depal_rapid::decode(&bytes);
    read_configuration(path, &text, controller).map_err(|errors| {
        let lines = errors.iter().map(|e| e.line as u32);
        lines.zip(told(path, &errors)).collect()
    })
}

/// Robot programs of one language into the verdicts at the given places. The program, if it is good.
fn check_programs(
    language: Language,
    files: &[(usize, &PathBuf)],
    verdicts: &mut [Verdict],
    check: impl Fn(&[SourceFile]) -> (Option<Arc<Program>>, Vec<Diagnostic>),
) -> Option<Arc<Program>> {
    let mut sources = Vec::new();
    let mut places = Vec::new();
    for (place, path) in files {
        match std::fs::read(path) {
            Ok(bytes) => {
                let text = check_language::decode(language, &bytes);
                sources.push(SourceFile::new(path.to_string_lossy(), text));
                places.push(*place);
            }
            Err(error) => {
                let message = cannot_read(path, error);
                tell!("error: {message}");
                let verdict = &mut verdicts[*place];
                verdict.summary.clear();
                verdict.findings.push(Finding::of_file("FILE", message));
            }
        }
    }
    if sources.is_empty() {
        return None;
    }
    let (program, diagnostics) = check(&sources);
    tell_all(&diagnostics, &sources);
    for diagnostic in &diagnostics {
        let span = diagnostic.primary.span;
        let index = (span.file as usize).min(sources.len() - 1);
        let at = sources[index].line_column(span.start);
        verdicts[places[index]].findings.push(Finding {
            code: diagnostic.code.to_owned(),
            severity: diagnostic.severity,
            line: at.line,
            column: at.column,
            message: diagnostic.message.clone(),
        });
    }
    if language == Language::Rapid
        && let Some(first) = diagnostics.first()
    {
        tell!(
            "`depal explain {}` tells more about the first message",
            first.code
        );
    }
    program
}
