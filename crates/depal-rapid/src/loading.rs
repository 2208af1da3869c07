use std::collections::BTreeMap;
use std::sync::Arc;

use depal_vm::{Diagnostic, Program, Severity, SourceFile};

use crate::SignalKind;
use crate::builtins::Table;
use crate::compile::compile;
use crate::syntax::parser::parse;

/// Most messages that are worth reading at once.
const DIAGNOSTIC_LIMIT: usize = 200;

/// A signal that programs may use by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SignalDefinition {
    /// As configured; programs may spell it in any case.
    pub name: String,
    /// Direction and width.
    pub kind: SignalKind,
}

/// What came of loading the modules of a task.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The program, unless there are errors.
    pub program: Option<Arc<Program>>,
    /// Errors and warnings, by file and place.
    pub diagnostics: Vec<Diagnostic>,
}

impl Loaded {
    /// Whether there is an error.
    pub fn has_errors(&self) -> bool {
        self.program.is_none()
    }
}

/// Loads the modules of one task, in any order, to start at the procedure `entry`.
/// A name that is neither declared nor in `known_signals` is an error.
pub fn load(sources: &[SourceFile], known_signals: &[SignalDefinition], entry: &str) -> Loaded {
    let signals = known_signals
        .iter()
        .map(|signal| {
            (
                signal.name.to_lowercase(),
                (signal.name.clone(), signal.kind),
            )
        })
        .collect();
    load_with(sources, Some(signals), Some(entry))
}

/// Checks modules without a cabinet: an unknown name where a signal may stand is a warning,
/// and no entry procedure is needed.
pub fn check(sources: &[SourceFile]) -> Loaded {
    load_with(sources, None, None)
}

fn load_with(
    sources: &[SourceFile],
    signals: Option<BTreeMap<String, (String, SignalKind)>>,
    entry: Option<&str>,
) -> Loaded {
    let mut diagnostics = Vec::new();
    let mut modules = parse(u32::MAX, include_str!("predefined.mod"), &mut diagnostics);
    for (index, source) in sources.iter().enumerate() {
        modules.extend(parse(index as u32, &source.text, &mut diagnostics));
    }
    let table = Table::new();
    let (program, found) = compile(sources, &modules, signals, entry, &table);
    diagnostics.extend(found);
    diagnostics.sort_by_key(|d| (d.primary.span.file, d.primary.span.start, d.severity));
    diagnostics.dedup();
    let failed = diagnostics.iter().any(|d| d.severity == Severity::Error);
    if diagnostics.len() > DIAGNOSTIC_LIMIT {
        let more = diagnostics.len() - DIAGNOSTIC_LIMIT;
        let last = diagnostics[DIAGNOSTIC_LIMIT].primary.span;
        diagnostics.truncate(DIAGNOSTIC_LIMIT);
        diagnostics.push(Diagnostic::error(
            "RAPID0999",
            last,
            format!("{more} more messages from here on are not shown"),
        ));
    }
    Loaded {
        program: (!failed).then(|| Arc::new(program)),
        diagnostics,
    }
}
