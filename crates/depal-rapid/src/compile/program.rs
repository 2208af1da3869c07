use std::collections::BTreeMap;

use depal_syntax::{Diagnostic, LineStarts, SourceFile};
use depal_vm::{LanguageRules, Program};

use super::scope::*;
use super::types::SignalKind;
use super::unused::Homes;
use crate::TaskEntry;
use crate::builtins::Table;
use crate::syntax::tree::*;

/// Checks the modules and lowers them. `modules[0]` holds the predefined data.
pub(crate) fn compile(
    files: &[SourceFile],
    modules: &[Module],
    signals: Option<BTreeMap<String, (String, SignalKind)>>,
    entry: Option<&TaskEntry<'_>>,
    table: &Table,
) -> (Program, Vec<Diagnostic>) {
    let any_signal = signals.is_none();
    let compiler = run(
        files,
        modules,
        (signals.unwrap_or_default(), any_signal),
        entry,
        table,
    );
    (compiler.program, compiler.diagnostics)
}

/// Names that are used as signals and are not known, with the kind that their use asks for.
pub(crate) fn undefined_signals(
    files: &[SourceFile],
    modules: &[Module],
    signals: BTreeMap<String, (String, SignalKind)>,
    table: &Table,
) -> Vec<(String, SignalKind)> {
    let compiler = run(files, modules, (signals, true), None, table);
    compiler
        .taken_signals
        .into_values()
        .map(|(name, kind)| (name, kind.unwrap_or(SignalKind::Di)))
        .collect()
}

fn run<'a>(
    files: &[SourceFile],
    modules: &[Module],
    (signals, any_signal): (BTreeMap<String, (String, SignalKind)>, bool),
    entry: Option<&TaskEntry<'_>>,
    table: &'a Table,
) -> Compiler<'a> {
    let mut compiler = Compiler {
        diagnostics: Vec::new(),
        line_starts: LineStarts::new(files),
        records: Vec::new(),
        types: BTreeMap::new(),
        local_types: vec![BTreeMap::new(); modules.len()],
        predefined: Scope::new(),
        task: Scope::new(),
        module_scopes: vec![Scope::new(); modules.len()],
        module: 0,
        signals,
        any_signal,
        taken_signals: BTreeMap::new(),
        table,
        program: Program {
            builtins: table.builtins(),
            rules: LanguageRules {
                raise: crate::errors::raise,
                error_name: crate::errors::error_name,
                string_limit: 80,
                retry_limit: 4,
                recursion_limit: 200,
                for_counts_down: crate::rules::FOR_COUNTS_DOWN,
                ..LanguageRules::default()
            },
            ..Program::default()
        },
        body: Body::default(),
    };
    compiler.records(modules);
    compiler.builtins();
    let data = compiler.module_data(modules);
    let routines = compiler.headings(modules);
    compiler.initial_values(&data);
    let homes = Homes {
        globals: data.iter().map(|item| item.module).collect(),
        routines: routines.iter().map(|(module, ..)| *module).collect(),
    };
    for (module, routine, index) in routines {
        compiler.module = module;
        compiler.routine(routine, index, &modules[module].name.text);
    }
    if let Some(entry) = entry {
        compiler.entries(entry);
    }
    compiler.unused_modules(modules, &homes, entry.map_or("main", |entry| entry.main));
    compiler
}
