//! `depal check`: everything that is wrong with a set of files, at once, without running them.

use std::path::{Path, PathBuf};

use depal_arm::Arm;
use depal_scene::Scene;
use depal_vm::{Severity, SourceFile};

use crate::diagnostics::draw;
use crate::failure::Failure;
use crate::run::explain;

/// Accelerations with which a bare URDF is checked, rad/s2; the value does not matter.
const NOMINAL_ACCELERATION: f64 = 1.0;

/// Checks every file; RAPID modules given together are one task.
pub fn check(files: &[PathBuf]) -> Result<(), Failure> {
    let mut errors = 0;
    let mut modules = Vec::new();
    for path in files {
        let verdict = match extension(path).as_str() {
            "toml" => check_scene(path),
            "urdf" => check_arm(path),
            "mod" | "sys" | "prg" | "modx" | "sysx" => {
                modules.push(path);
                continue;
            }
            other => Err(vec![format!(
                "{}: no check for files of type {other:?}; expected .toml, .urdf, .mod, .sys or .prg",
                path.display()
            )]),
        };
        match verdict {
            Ok(summary) => println!("{}: {summary}", path.display()),
            Err(messages) => {
                errors += messages.len();
                messages
                    .iter()
                    .for_each(|message| eprintln!("error: {message}"));
            }
        }
    }
    if !modules.is_empty() {
        errors += check_modules(&modules);
    }
    if errors == 0 {
        Ok(())
    } else {
        Err(Failure::Input(format!("{errors} problem(s) found")))
    }
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
    Ok(format!(
        "good: {} cartons, {}, {} program file(s)",
        built.spec.cartons.len(),
        built.spec.arm.name(),
        built.sources.len()
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

/// RAPID modules as one task; returns the number of errors.
fn check_modules(paths: &[&PathBuf]) -> usize {
    let mut errors = 0;
    let mut sources = Vec::new();
    for path in paths {
        match depal_scene::read_text(&path.to_string_lossy()) {
            Ok(text) => sources.push(SourceFile::new(path.to_string_lossy(), text)),
            Err(error) => {
                errors += 1;
                eprintln!("error: cannot read {}: {error}", path.display());
            }
        }
    }
    let diagnostics = depal_rapid::check(&sources).diagnostics;
    for diagnostic in &diagnostics {
        eprintln!("{}\n", draw(diagnostic, &sources));
        errors += usize::from(diagnostic.severity == Severity::Error);
    }
    for (index, source) in sources.iter().enumerate() {
        let own = |d: &&depal_vm::Diagnostic| {
            d.severity == Severity::Error && d.primary.span.file as usize == index
        };
        let count = diagnostics.iter().filter(own).count();
        if count == 0 {
            println!("{}: good", source.name);
        } else {
            println!("{}: {count} error(s)", source.name);
        }
    }
    errors
}
