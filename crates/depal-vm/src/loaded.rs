use std::sync::Arc;

use depal_syntax::{Diagnostic, Severity, in_order};

use crate::Program;

/// Most messages that are worth reading at once.
const DIAGNOSTIC_LIMIT: usize = 200;

/// What came of loading the files of a task, in whichever language.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The program, unless there are errors.
    pub program: Option<Arc<Program>>,
    /// Errors and warnings, by file and place.
    pub diagnostics: Vec<Diagnostic>,
}

impl Loaded {
    /// The program, unless one of the messages is an error, and the messages in order. Of very many only the
    /// first are kept; then the last one, with the code `more`, counts the others.
    pub fn new(program: Program, diagnostics: Vec<Diagnostic>, more: &'static str) -> Self {
        let mut diagnostics = in_order(diagnostics);
        let failed = diagnostics.iter().any(|d| d.severity == Severity::Error);
        if diagnostics.len() > DIAGNOSTIC_LIMIT {
            let others = diagnostics.len() - DIAGNOSTIC_LIMIT;
            let last = diagnostics[DIAGNOSTIC_LIMIT].primary.span;
            diagnostics.truncate(DIAGNOSTIC_LIMIT);
            diagnostics.push(Diagnostic::error(
                more,
                last,
                format!("{others} more messages from here on are not shown"),
            ));
        }
        Self {
            program: (!failed).then(|| Arc::new(program)),
            diagnostics,
        }
    }

    /// Whether there is an error.
    pub fn has_errors(&self) -> bool {
        self.program.is_none()
    }
}
