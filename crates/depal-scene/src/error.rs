use std::fmt;

/// One thing that is wrong in a scene file or an override.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneProblem {
    /// Where it stands: the name of the file, or the override as it was written (`--set key=value`).
    pub source: String,
    /// Line, counted from 1; 0 where there is no text to point into.
    pub line: usize,
    /// Column in characters, counted from 1; 0 where there is no text to point into.
    pub column: usize,
    /// Path of the key, such as `camera.noise_mm`; empty when the whole text is meant.
    pub key: String,
    /// What was expected and what was found.
    pub message: String,
    /// What to try next.
    pub hint: Option<String>,
    /// The line of the source, without its end; empty where there is none.
    pub source_line: String,
}

impl fmt::Display for SceneProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.source)?;
        if self.line > 0 {
            write!(f, ":{}:{}", self.line, self.column)?;
        }
        if !self.key.is_empty() {
            write!(f, ": {}", self.key)?;
        }
        write!(f, ": {}", self.message)?;
        if let Some(hint) = &self.hint {
            write!(f, "; {hint}")?;
        }
        Ok(())
    }
}

/// Everything that is wrong with a scene, in the order of the text.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", listed(problems))]
#[non_exhaustive]
pub struct SceneErrors {
    /// At least one problem.
    pub problems: Vec<SceneProblem>,
}

fn listed(problems: &[SceneProblem]) -> String {
    let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
    lines.join("\n")
}
