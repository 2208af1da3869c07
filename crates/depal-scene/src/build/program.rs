//! The robot program of a scene, with the interface module that it calls.

use depal_rapid::{SignalDefinition, SignalKind as RapidKind};
use depal_vm::execution::RobotTask;
use depal_vm::{Diagnostic, Machine, Severity, SourceFile};

use super::BuildError;
use crate::robot::{Robot, SignalKind};

/// A loaded program.
pub struct LoadedProgram {
    /// The task, at its entry.
    pub task: Box<dyn RobotTask>,
    /// Its texts.
    pub sources: Vec<SourceFile>,
    /// What is odd about it.
    pub warnings: Vec<Diagnostic>,
}

/// Loads the program files and the interface module as one RAPID task with the entry `main`.
///
/// # Errors
/// [`BuildError::Program`] with every diagnostic at once.
pub fn load_program(robot: &Robot) -> Result<LoadedProgram, BuildError> {
    let mut sources: Vec<SourceFile> = robot
        .program
        .iter()
        .map(|file| SourceFile::new(file.path.as_str(), file.text.as_str()))
        .collect();
    sources.push(SourceFile::new(
        robot.module.path.as_str(),
        robot.module.text.as_str(),
    ));
    let signals: Vec<SignalDefinition> = robot
        .signal
        .iter()
        .map(|signal| SignalDefinition {
            name: signal.name.clone(),
            kind: match signal.kind {
                SignalKind::DigitalInput => RapidKind::Di,
                SignalKind::DigitalOutput => RapidKind::Do,
                SignalKind::GroupInput => RapidKind::Gi,
                SignalKind::GroupOutput => RapidKind::Go,
            },
        })
        .collect();
    let loaded = depal_rapid::load(&sources, &signals, "main");
    let failed = |diagnostics| BuildError::Program {
        diagnostics,
        sources: sources.clone(),
    };
    let Some(program) = loaded.program else {
        return Err(failed(loaded.diagnostics));
    };
    if loaded
        .diagnostics
        .iter()
        .any(|diagnostic| diagnostic.severity == Severity::Error)
    {
        return Err(failed(loaded.diagnostics));
    }
    Ok(LoadedProgram {
        task: Box::new(Machine::new(program, "T_ROB1")),
        warnings: loaded.diagnostics,
        sources,
    })
}
