use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use depal_syntax::{Diagnostic, LineStarts, Span, nearest_name};
use depal_vm::{Op, Program, Value};

use super::system::Live;
use super::types::{Type, Types};
use crate::builtins::Table;
use crate::syntax::tree::Mode;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Slot {
    Global(u32),
    Local(u32),
}

/// Data that a name means.
#[derive(Debug, Clone)]
pub(crate) struct DataSymbol {
    pub(crate) name: String,
    pub(crate) slot: Slot,
    pub(crate) kind: Type,
    pub(crate) constant: bool,
    pub(crate) span: Span,
}

/// One or several signals of the cabinet under a name.
#[derive(Debug, Clone)]
pub(crate) struct SignalSymbol {
    pub(crate) name: String,
    /// `$IN`, `$OUT`, `$ANIN`, `$ANOUT`.
    pub(crate) array: &'static str,
    pub(crate) from: i64,
    /// The last one, of a group.
    pub(crate) to: Option<i64>,
    pub(crate) span: Span,
}

#[derive(Debug, Clone)]
pub(crate) struct ParameterType {
    pub(crate) name: String,
    pub(crate) kind: Type,
    pub(crate) mode: Mode,
    pub(crate) optional: bool,
}

/// Heading of a routine or built-in.
#[derive(Debug, Clone)]
pub(crate) struct Signature {
    pub(crate) name: String,
    pub(crate) parameters: Vec<ParameterType>,
    /// More arguments of any type may follow, in this mode.
    pub(crate) more: Option<Mode>,
    /// `None` for a subprogram.
    pub(crate) result: Option<Type>,
    /// Waits for the arm before it begins.
    pub(crate) stops_advance: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Callee {
    Routine(u32),
    Builtin(u32),
}

#[derive(Debug, Clone)]
pub(crate) struct RoutineSymbol {
    pub(crate) signature: Rc<Signature>,
    pub(crate) callee: Callee,
    pub(crate) span: Span,
}

#[derive(Debug, Clone)]
pub(crate) enum Symbol {
    Data(DataSymbol),
    Signal(SignalSymbol),
    Live(&'static Live),
    Routine(RoutineSymbol),
}

impl Symbol {
    pub(crate) fn span(&self) -> Span {
        match self {
            Self::Data(data) => data.span,
            Self::Signal(signal) => signal.span,
            Self::Live(_) => Span::new(u32::MAX, 0, 0),
            Self::Routine(routine) => routine.span,
        }
    }

    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Data(data) => &data.name,
            Self::Signal(signal) => &signal.name,
            Self::Live(live) => live.name,
            Self::Routine(routine) => &routine.signature.name,
        }
    }
}

pub(crate) type Scope = BTreeMap<String, Symbol>;

/// The routine being lowered.
#[derive(Debug, Default)]
pub(crate) struct Body {
    pub(crate) code: Vec<Op>,
    pub(crate) locals: Vec<Value>,
    pub(crate) scope: Scope,
    pub(crate) result: Option<Type>,
    pub(crate) is_function: bool,
    pub(crate) labels: BTreeMap<String, (u32, Span)>,
    /// Position of the jump, label, place.
    pub(crate) gotos: Vec<(usize, String, Span)>,
    /// For each loop being lowered the jumps to its end.
    pub(crate) exits: Vec<Vec<usize>>,
    /// The statement runs ahead of the arm: CONTINUE stands before it, or it is part of a wait.
    pub(crate) ahead: bool,
    /// The statement already waits for the arm.
    pub(crate) waited: bool,
}

/// Everything that is known while a program is made.
pub(crate) struct Compiler<'a> {
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) line_starts: LineStarts,
    pub(crate) types: Types,
    /// Type names by key, for all modules and for each.
    pub(crate) type_names: BTreeMap<String, (Type, Span)>,
    pub(crate) module_types: Vec<BTreeMap<String, (Type, Span)>>,
    pub(crate) predefined: Scope,
    pub(crate) global: Scope,
    pub(crate) module_scopes: Vec<Scope>,
    pub(crate) module: usize,
    pub(crate) module_name: String,
    /// Signals of the cabinet, in lower case; `None`: any.
    pub(crate) signals: Option<BTreeSet<String>>,
    /// Signals that the cabinet lacks and that were reported, each once.
    pub(crate) missing_signals: BTreeSet<String>,
    pub(crate) table: &'a Table,
    pub(crate) program: Program,
    pub(crate) body: Body,
}

impl Compiler<'_> {
    pub(crate) fn error(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    pub(crate) fn line(&self, span: Span) -> u32 {
        self.line_starts.line(span)
    }

    pub(crate) fn emit(&mut self, op: Op) -> usize {
        self.body.code.push(op);
        self.body.code.len() - 1
    }

    /// Calls a built-in that has no heading.
    pub(crate) fn emit_builtin(&mut self, name: &'static str, arguments: u32, result: bool) {
        let builtin = self.table.operator(name);
        self.emit(Op::CallBuiltin {
            builtin,
            arguments,
            result,
        });
    }

    /// The arm must stand before the rest of the statement runs, unless CONTINUE stands before it.
    pub(crate) fn stop_advance(&mut self) {
        if !self.body.ahead && !self.body.waited {
            self.emit_builtin("advance stop", 0, false);
            self.body.waited = true;
        }
    }

    pub(crate) fn here(&self) -> u32 {
        self.body.code.len() as u32
    }

    /// Sets the target of a jump emitted before.
    pub(crate) fn patch(&mut self, at: usize, to: u32) {
        self.body.code[at].set_target(to);
    }

    pub(crate) fn patch_here(&mut self, at: usize) {
        let here = self.here();
        self.patch(at, here);
    }

    pub(crate) fn new_local(&mut self, value: Value) -> u32 {
        self.body.locals.push(value);
        self.body.locals.len() as u32 - 1
    }

    pub(crate) fn new_global(&mut self, name: &str, value: Value) -> u32 {
        self.program.globals.push(value);
        self.program.global_names.push(name.to_owned());
        self.program.globals.len() as u32 - 1
    }

    /// What is visible, the nearest first.
    fn scopes(&self) -> impl Iterator<Item = &Scope> {
        let module = self.module_scopes.get(self.module);
        let inner = std::iter::once(&self.body.scope).chain(module);
        inner.chain([&self.global, &self.predefined])
    }

    pub(crate) fn lookup(&self, key: &str) -> Option<&Symbol> {
        self.scopes().find_map(|scope| scope.get(key))
    }

    pub(crate) fn type_name(&self, kind: &Type) -> String {
        self.types.name(kind)
    }

    pub(crate) fn lookup_type(&self, key: &str) -> Option<Type> {
        let own = self.module_types.get(self.module);
        let found = own.and_then(|types| types.get(key));
        let found = found.or_else(|| self.type_names.get(key));
        let found = found.map(|(kind, _)| kind.clone());
        found.or_else(|| super::types::simple_type(key))
    }

    /// The visible name nearest to `wanted`, as it is spelled where it is declared.
    pub(crate) fn nearest(&self, wanted: &str, filter: impl Fn(&Symbol) -> bool) -> Option<String> {
        let symbols = self.scopes().flat_map(BTreeMap::values);
        let symbols = symbols.filter(|symbol| filter(symbol));
        nearest_name(wanted, symbols.map(|symbol| symbol.name().to_owned()))
    }

    /// Declares a name in a scope that has each only once.
    pub(crate) fn declare_once(&mut self, earlier: Option<Span>, name: &str, span: Span) {
        if let Some(first) = earlier {
            self.error(
                Diagnostic::error("KRL0110", span, format!("{name} is declared twice"))
                    .secondary(first, "first declared here"),
            );
        }
    }
}
