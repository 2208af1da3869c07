use std::collections::{BTreeMap, BTreeSet};

use depal_syntax::{Diagnostic, LineStarts, SourceFile, Span, nearest_name};
use depal_vm::{LanguageRules, Op, Program, SharedDatum};

use super::scope::*;
use super::system::LIVE;
use super::types::Types;
use crate::builtins::{OWN_GLOBALS, Table};
use crate::syntax::tree::{File, FileKind};

/// A module: the routines and the data of one name.
#[derive(Debug)]
pub(crate) struct Unit {
    /// As the files spell it.
    pub(crate) name: String,
    /// Files, by their index.
    pub(crate) files: Vec<(u32, File)>,
}

impl Unit {
    /// Whether a file of it is one of the submit interpreter.
    fn has_submit(&self) -> bool {
        self.files
            .iter()
            .any(|(_, file)| file.kind == FileKind::Submit)
    }
}

/// Signals of the cabinet: names in lower case, or any.
pub(crate) type Signals = Option<BTreeSet<String>>;

/// Checks the modules and lowers them. The first holds the predefined data.
pub(crate) fn compile(
    files: &[SourceFile],
    units: &[Unit],
    signals: Signals,
    entry: Option<&str>,
    table: &Table,
) -> (Program, Vec<Diagnostic>) {
    let mut compiler = Compiler {
        diagnostics: Vec::new(),
        line_starts: LineStarts::new(files),
        types: Types::default(),
        type_names: BTreeMap::new(),
        module_types: vec![BTreeMap::new(); units.len()],
        predefined: Scope::new(),
        global: Scope::new(),
        module_scopes: vec![Scope::new(); units.len()],
        module: 0,
        module_name: String::new(),
        signals,
        missing_signals: BTreeSet::new(),
        table,
        program: Program {
            builtins: table.builtins(),
            rules: LanguageRules {
                raise: crate::errors::raise,
                recursion_limit: 200,
                for_counts_down: false,
                integers: (i64::from(i32::MIN), i64::from(i32::MAX)),
                ..LanguageRules::default()
            },
            ..Program::default()
        },
        body: Body::default(),
    };
    for (name, value) in crate::builtins::hidden_globals() {
        compiler.new_global(name, value);
    }
    for live in LIVE {
        let symbol = Symbol::Live(live);
        compiler.predefined.insert(live.name.to_lowercase(), symbol);
    }
    compiler.type_declarations(units);
    compiler.builtins();
    compiler.data(units);
    if units.iter().any(Unit::has_submit) {
        compiler.share();
    }
    let routines = compiler.headings(units);
    for (module, routine, index) in &routines {
        compiler.module = *module;
        compiler.module_name.clone_from(&units[*module].name);
        compiler.routine(routine, *index);
    }
    if let Some(entry) = entry {
        compiler.entry(entry, units);
    }
    (compiler.program, compiler.diagnostics)
}

impl Compiler<'_> {
    fn builtins(&mut self) {
        let span = Span::new(u32::MAX, 0, 0);
        for (index, heading) in self.table.headings().iter().enumerate() {
            let signature = heading.signature(self);
            let symbol = Symbol::Routine(RoutineSymbol {
                callee: Callee::Builtin(index as u32),
                span,
                signature: std::rc::Rc::new(signature),
            });
            let key = heading.name.to_lowercase();
            self.predefined.insert(key, symbol);
        }
    }

    /// The submit interpreter and the robot interpreter work on the same data. Programs of the same files have the
    /// same slots, so that the slot is the name.
    fn share(&mut self) {
        let names = self.program.global_names.iter().enumerate();
        let shared = names.skip(OWN_GLOBALS).map(|(slot, name)| SharedDatum {
            name: format!("{name}, datum {slot}"),
            kind: String::new(),
            global: slot as u32,
            has_value: true,
        });
        self.program.shared = shared.collect();
    }

    /// The routine that runs: as `entry`, but it waits for the arm at its end.
    fn entry(&mut self, entry: &str, units: &[Unit]) {
        self.module = self.module_scopes.len();
        let key = entry.to_lowercase();
        let own = self.module_scopes.iter().find_map(|scope| scope.get(&key));
        match self.global.get(&key).or(own) {
            Some(Symbol::Routine(RoutineSymbol {
                callee: Callee::Routine(index),
                signature,
                span,
            })) if signature.result.is_none() && signature.parameters.is_empty() => {
                let mut files = units.iter().flat_map(|unit| &unit.files);
                if files.any(|(file, f)| *file == span.file && f.kind == FileKind::Submit) {
                    crate::builtins::make_submit(&mut self.program.globals);
                }
                let mut made = self.program.routines[*index as usize].clone();
                let end = made.code.len() as u32;
                for op in &mut made.code {
                    if let Op::Return { value: false } = op {
                        *op = Op::Jump(end);
                    }
                }
                made.code.push(Op::CallBuiltin {
                    builtin: self.table.operator("advance stop"),
                    arguments: 0,
                    result: false,
                });
                made.code.push(Op::Return { value: false });
                self.program.entry = self.program.routines.len() as u32;
                self.program.routines.push(made);
            }
            Some(other) => {
                let span = other.span();
                self.error(Diagnostic::error(
                    "KRL0117",
                    span,
                    format!("{entry} cannot be started: it must be a DEF without parameters"),
                ));
            }
            None => {
                let names = self.global.values().filter_map(|symbol| match symbol {
                    Symbol::Routine(routine) => Some(routine.signature.name.clone()),
                    _ => None,
                });
                let near = nearest_name(entry, names);
                let mut diagnostic = Diagnostic::error(
                    "KRL0117",
                    Span::new(0, 0, 0),
                    format!("there is no program {entry} to start"),
                );
                if let Some(near) = near {
                    diagnostic = diagnostic.help(format!("did you mean {near}?"));
                }
                self.error(diagnostic);
            }
        }
    }
}
