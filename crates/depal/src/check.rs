//! `depal check`: everything that is wrong with a set of files, at once, without running them.

use std::path::{Path, PathBuf};

use depal_arm::Arm;
use depal_controller::EioConfiguration;
use depal_scene::Scene;
use depal_vm::{Severity, SourceFile};

use crate::diagnostics::draw;
use crate::failure::Failure;
use crate::run::explain;

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

/// Checks every file; RAPID modules given together are one task, unless only their syntax is asked for.
pub fn check(files: &[PathBuf], json: bool, syntax_only: bool) -> Result<(), Failure> {
    let mut verdicts = Vec::new();
    let mut modules = Vec::new();
    for path in files {
        let name = path.to_string_lossy().into_owned();
        let (code, verdict) = match extension(path).as_str() {
            "toml" => ("SCENE", check_scene(path)),
            "urdf" => ("URDF", check_arm(path)),
            "cfg" => ("EIO", check_signals(path)),
            "mod" | "sys" | "prg" | "modx" | "sysx" => {
                modules.push((verdicts.len(), path));
                ("RAPID", Ok("good".to_owned()))
            }
            other => (
                "FILE",
                Err(vec![format!(
                    "{name}: no check for files of type {other:?}; expected .toml, .urdf, .cfg, .mod, .sys or .prg"
                )]),
            ),
        };
        let (summary, findings) = match verdict {
            Ok(summary) => (summary, Vec::new()),
            Err(messages) => {
                for message in &messages {
                    eprintln!("error: {message}");
                }
                let findings = messages.into_iter().map(|m| Finding::of_file(code, m));
                (String::new(), findings.collect())
            }
        };
        verdicts.push(Verdict {
            path: name,
            summary,
            findings,
        });
    }
    check_modules(&modules, &mut verdicts, syntax_only);
    let errors: usize = verdicts.iter().map(Verdict::errors).sum();
    if json {
        println!("{}", document(&verdicts));
    } else {
        for verdict in &verdicts {
            match verdict.errors() {
                0 => println!("{}: {}", verdict.path, verdict.summary),
                _ if verdict.summary.is_empty() => {}
                count => println!("{}: {count} error(s)", verdict.path),
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

fn extension(path: &Path) -> String {
    path.extension()
        .map(|extension| extension.to_string_lossy().to_lowercase())
        .unwrap_or_default()
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
        eprintln!("{}", draw(warning, &built.sources));
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
    Ok(format!(
        "good: {} cartons, {}, {} program file(s); the Viz project:\n{}",
        built.spec.cartons.len(),
        built.spec.arm.name(),
        built.sources.len(),
        built.spec.workflow.to_string().trim_end()
    ))
}

fn check_arm(path: &Path) -> Result<String, Vec<String>> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| vec![format!("cannot read {}: {error}", path.display())])?;
    let arm = Arm::from_urdf_uniform(&text, &path.to_string_lossy(), NOMINAL_ACCELERATION)
        .map_err(|error| vec![error.to_string()])?;
    for warning in arm.warnings() {
        eprintln!("warning: {}: {warning}", path.display());
    }
    Ok(format!(
        "good: {} with {} joints and {} links",
        arm.name(),
        arm.joint_count(),
        arm.links().len()
    ))
}

/// The signals of a controller.
fn check_signals(path: &Path) -> Result<String, Vec<String>> {
    let bytes = std::fs::read(path)
        .map_err(|error| vec![format!("cannot read {}: {error}", path.display())])?;
    let read = EioConfiguration::parse(&depal_rapid::decode(&bytes)).map_err(|errors| {
        let line = |e: &depal_controller::EioError| {
            format!("{}:{}: {}", path.display(), e.line, e.message)
        };
        errors.iter().map(line).collect::<Vec<_>>()
    })?;
    Ok(format!(
        "good: {} signals, {} cross connections",
        read.signals.len(),
        read.connections.len()
    ))
}

/// RAPID modules, as one task or each for itself, into the verdicts at the given places.
fn check_modules(modules: &[(usize, &PathBuf)], verdicts: &mut [Verdict], syntax_only: bool) {
    let mut sources = Vec::new();
    let mut places = Vec::new();
    for (place, path) in modules {
        match std::fs::read(path) {
            Ok(bytes) => {
                let text = depal_rapid::decode(&bytes);
                sources.push(SourceFile::new(path.to_string_lossy(), text));
                places.push(*place);
            }
            Err(error) => {
                let message = format!("cannot read {}: {error}", path.display());
                eprintln!("error: {message}");
                let verdict = &mut verdicts[*place];
                verdict.summary.clear();
                verdict.findings.push(Finding::of_file("FILE", message));
            }
        }
    }
    if sources.is_empty() {
        return;
    }
    let diagnostics = if syntax_only {
        depal_rapid::check_syntax(&sources)
    } else {
        depal_rapid::check(&sources).diagnostics
    };
    for diagnostic in &diagnostics {
        eprintln!("{}\n", draw(diagnostic, &sources));
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
    if let Some(first) = diagnostics.first() {
        eprintln!(
            "`depal explain {}` tells more about the first message",
            first.code
        );
    }
}
