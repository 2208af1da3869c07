//! How a command fails: one message for people, one exit code for scripts.

use std::path::Path;
use std::process::ExitCode;

/// Why a command did not do what it was asked to.
#[derive(Debug)]
pub enum Failure {
    /// The run is over and missed a threshold of `[accept]`: exit code 1. The report has been shown.
    NotAccepted,
    /// A robot program stopped on a run-time error, or the input was wrong: all was said already.
    Told(u8),
    /// The scene, a program or an argument is wrong: exit code 2.
    Input(String),
    /// The machine does not let us: exit code 3.
    Environment(String),
    /// The run's time limit passed: exit code 4. The report has been shown.
    TimeLimit,
}

/// What to say of a file that cannot be read, and what to try instead.
pub fn cannot_read(path: &Path, error: std::io::Error) -> String {
    let path = path.to_string_lossy();
    let error = depal_scene::with_advice(&path, error);
    format!("cannot read {path}: {error}")
}

impl Failure {
    /// A file that cannot be read.
    pub fn unread(path: &Path, error: std::io::Error) -> Self {
        Self::Input(cannot_read(path, error))
    }

    /// Prints the message, if one is left to print, and gives the exit code.
    pub fn report(&self) -> ExitCode {
        match self {
            Self::NotAccepted => ExitCode::from(1),
            Self::Told(code) => ExitCode::from(*code),
            Self::Input(message) => {
                tell!("error: {message}");
                ExitCode::from(2)
            }
            Self::Environment(message) => {
                tell!("error: {message}");
                ExitCode::from(3)
            }
            Self::TimeLimit => ExitCode::from(4),
        }
    }
}
