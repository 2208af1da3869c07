//! The robot program of a scene, with the interface module that it calls.

mod krl;
mod rapid;
mod tp;

use std::sync::Arc;

use depal_cell::spec::CellSpec;
use depal_vm::execution::RobotTask;
use depal_vm::{Diagnostic, Program, Severity, SourceFile};

use super::BuildError;
use crate::files::read_text;
use crate::language::Language;
use crate::robot::Robot;

/// A loaded program.
pub(super) struct LoadedProgram {
    /// The task, at its entry.
    pub task: Box<dyn RobotTask>,
    /// Its texts.
    pub sources: Vec<SourceFile>,
    /// What is odd about it.
    pub warnings: Vec<Diagnostic>,
}

/// What a language makes of its texts.
struct Translated {
    program: Option<Arc<Program>>,
    diagnostics: Vec<Diagnostic>,
    /// Makes the task of the program.
    task: fn(Arc<Program>) -> Box<dyn RobotTask>,
}

/// Loads the program files and the interface module as one task. RAPID begins with `main`, the others with the
/// program that has the name of the first file.
///
/// # Errors
/// [`BuildError::Program`] with every diagnostic at once.
pub(super) fn load_program(robot: &Robot, spec: &CellSpec) -> Result<LoadedProgram, BuildError> {
    let language = robot.language();
    let mut sources: Vec<SourceFile> = robot
        .program
        .iter()
        .chain(&robot.module)
        .map(|file| SourceFile::new(file.path.as_str(), file.text.as_str()))
        .collect();
    if robot.module.is_empty() {
        sources.extend(language.embedded_module().iter().map(|path| {
            let text = read_text(path).expect("the modules are in the table of embedded files");
            SourceFile::new(*path, text)
        }));
    }
    let entry = entry(&robot.program[0].path);
    let translated = match language {
        Language::Rapid => rapid::load(&sources, robot),
        Language::Krl => krl::load(&mut sources, entry),
        Language::Tp => tp::load(&sources, robot, spec, entry),
    };
    let is_error = |diagnostic: &Diagnostic| diagnostic.severity == Severity::Error;
    match translated.program {
        Some(program) if !translated.diagnostics.iter().any(is_error) => Ok(LoadedProgram {
            task: (translated.task)(program),
            warnings: translated.diagnostics,
            sources,
        }),
        _ => Err(BuildError::Program {
            diagnostics: translated.diagnostics,
            sources,
        }),
    }
}

/// The name of a file without folder and extension.
fn entry(path: &str) -> &str {
    let name = path.rsplit(['/', '\\']).next().unwrap_or(path);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}
