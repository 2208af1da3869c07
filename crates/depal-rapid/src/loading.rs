use std::collections::BTreeMap;

use depal_syntax::{Diagnostic, Severity, SourceFile, in_order};
use depal_vm::Loaded;

use crate::SignalKind;
use crate::builtins::Table;
use crate::compile::{compile, undefined_signals};
use crate::syntax::parser::parse;
use crate::syntax::print::print;
use crate::syntax::tree::Module;

/// A signal that programs may use by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SignalDefinition {
    /// As configured; programs may spell it in any case.
    pub name: String,
    /// Direction and width.
    pub kind: SignalKind,
}

/// When an event routine runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TaskEvent {
    /// Before the entry (POWER_ON, RESET, START).
    BeforeStart,
    /// When the program has stopped itself (STOP).
    Stop,
    /// When it goes on after that (RESTART): for a cabinet that is told to, which no command does.
    Restart,
}

/// What a task starts with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskEntry<'a> {
    /// The procedure that it runs.
    pub main: &'a str,
    /// Event routines in their order, and whether a missing one is an error.
    pub events: Vec<(TaskEvent, &'a str, bool)>,
}

impl<'a> TaskEntry<'a> {
    /// A procedure without event routines.
    pub fn new(main: &'a str) -> Self {
        Self {
            main,
            events: Vec::new(),
        }
    }
}

/// Loads the modules of one task, in any order, to start at the procedure `entry`.
/// A name that is neither declared nor in `known_signals` is an error.
pub fn load(sources: &[SourceFile], known_signals: &[SignalDefinition], entry: &str) -> Loaded {
    load_task(sources, known_signals, &TaskEntry::new(entry))
}

/// As [`load`], with event routines.
pub fn load_task(
    sources: &[SourceFile],
    known_signals: &[SignalDefinition],
    entry: &TaskEntry<'_>,
) -> Loaded {
    load_with(sources, Some(keyed(known_signals)), Some(entry))
}

/// As [`load_task`], but a name that is used as a signal and defined nowhere becomes a signal of the kind that
/// its use asks for (a digital input where any kind would do). Gives back the signals so added.
pub fn load_with_auto_signals(
    sources: &[SourceFile],
    known_signals: &[SignalDefinition],
    entry: &TaskEntry<'_>,
) -> (Loaded, Vec<SignalDefinition>) {
    let mut ignored = Vec::new();
    let modules = parse_all(sources, &mut ignored);
    let table = Table::new();
    let found = undefined_signals(sources, &modules, keyed(known_signals), &table);
    let added: Vec<_> = found
        .into_iter()
        .map(|(name, kind)| SignalDefinition { name, kind })
        .collect();
    let all: Vec<_> = known_signals.iter().chain(&added).cloned().collect();
    (load_task(sources, &all, entry), added)
}

/// Reads files without looking at names and types, each for itself.
pub fn check_syntax(sources: &[SourceFile]) -> Vec<Diagnostic> {
    let mut diagnostics = Vec::new();
    parse_all(sources, &mut diagnostics);
    in_order(diagnostics)
}

/// The modules of a text in one normal form: layout, parentheses and numbers as we write them, without comments.
/// It reads as the same program. What is wrong with the text, if it does not read.
pub fn normal_form(source: &SourceFile) -> Result<String, Vec<Diagnostic>> {
    let mut diagnostics = Vec::new();
    let modules = parse(0, &source.text, &mut diagnostics);
    if diagnostics.is_empty() {
        Ok(print(&modules))
    } else {
        Err(in_order(diagnostics))
    }
}

/// The modules that a program list (.pgf) names, in its order: the text of its `<Module>` elements.
pub fn program_list(text: &str) -> Vec<String> {
    let lower = text.to_ascii_lowercase();
    let mut modules = Vec::new();
    let mut at = 0;
    while let Some(begin) = lower[at..].find("<module>") {
        let begin = at + begin + "<module>".len();
        let Some(length) = lower[begin..].find("</module>") else {
            break;
        };
        modules.push(text[begin..begin + length].trim().to_owned());
        at = begin + length;
    }
    modules
}

fn keyed(signals: &[SignalDefinition]) -> BTreeMap<String, (String, SignalKind)> {
    let key = |signal: &SignalDefinition| {
        let name = signal.name.to_lowercase();
        (name, (signal.name.clone(), signal.kind))
    };
    signals.iter().map(key).collect()
}

fn parse_all(sources: &[SourceFile], diagnostics: &mut Vec<Diagnostic>) -> Vec<Module> {
    let mut modules = parse(u32::MAX, include_str!("predefined.mod"), diagnostics);
    for (index, source) in sources.iter().enumerate() {
        modules.extend(parse(index as u32, &source.text, diagnostics));
    }
    modules
}

/// Checks modules without a cabinet: an unknown name where a signal may stand is a warning,
/// and no entry procedure is needed.
pub fn check(sources: &[SourceFile]) -> Loaded {
    load_with(sources, None, None)
}

/// As [`check`], but the signals of the cabinet are known: another name is an error.
pub fn check_with_signals(sources: &[SourceFile], known_signals: &[SignalDefinition]) -> Loaded {
    load_with(sources, Some(keyed(known_signals)), None)
}

fn load_with(
    sources: &[SourceFile],
    signals: Option<BTreeMap<String, (String, SignalKind)>>,
    entry: Option<&TaskEntry<'_>>,
) -> Loaded {
    let mut diagnostics = Vec::new();
    let modules = parse_all(sources, &mut diagnostics);
    let table = Table::new();
    let (program, found) = compile(sources, &modules, signals, entry, &table);
    diagnostics.extend(found);
    if diagnostics.iter().any(|d| d.severity == Severity::Error) {
        // What could not be read may be what uses the module.
        diagnostics.retain(|d| d.code != "RAPID0120");
    }
    Loaded::new(program, diagnostics, "RAPID0999")
}
