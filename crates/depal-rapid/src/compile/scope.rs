use std::collections::BTreeMap;
use std::rc::Rc;

use depal_syntax::{Diagnostic, LineStarts, Span, nearest_name};
use depal_vm::{Op, Program, Value};

use super::types::{RecordType, SignalKind, Type};
use crate::builtins::Table;
use crate::syntax::tree::{Expression, Mode, Storage};

/// What a program may do with data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Access {
    Stored(Storage),
    Parameter(Mode),
    LoopVariable,
}

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
    pub(crate) access: Access,
    pub(crate) optional: bool,
    pub(crate) span: Span,
    /// Initial value of a constant, to compute array sizes.
    pub(crate) constant: Option<Rc<Expression>>,
}

#[derive(Debug, Clone)]
pub(crate) struct ParameterType {
    pub(crate) name: String,
    pub(crate) key: String,
    pub(crate) kind: Type,
    pub(crate) mode: Mode,
    pub(crate) optional: bool,
    pub(crate) group: usize,
}

/// Heading of a routine or built-in.
#[derive(Debug, Clone)]
pub(crate) struct Signature {
    pub(crate) name: String,
    pub(crate) parameters: Vec<ParameterType>,
    /// `None` for a procedure.
    pub(crate) result: Option<Type>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Callee {
    Routine(u32),
    Trap(u32),
    Builtin(u32),
    WaitUntil,
    ResetRetryCount,
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
    Routine(RoutineSymbol),
}

impl Symbol {
    pub(crate) fn span(&self) -> Span {
        match self {
            Self::Data(data) => data.span,
            Self::Routine(routine) => routine.span,
        }
    }

    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Data(data) => &data.name,
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
    pub(crate) in_handler: bool,
    pub(crate) labels: BTreeMap<String, (u32, Span)>,
    /// Position of the jump, label, place.
    pub(crate) gotos: Vec<(usize, String, Span)>,
}

/// Everything that is known while a program is made.
pub(crate) struct Compiler<'a> {
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) line_starts: LineStarts,
    pub(crate) records: Vec<RecordType>,
    /// Type names by key: with the module, or for all.
    pub(crate) types: BTreeMap<String, Type>,
    pub(crate) local_types: Vec<BTreeMap<String, Type>>,
    pub(crate) predefined: Scope,
    pub(crate) task: Scope,
    pub(crate) module_scopes: Vec<Scope>,
    pub(crate) module: usize,
    pub(crate) signals: BTreeMap<String, (String, SignalKind)>,
    /// Any name may be a signal.
    pub(crate) any_signal: bool,
    /// Names taken as signals although they are not known, with the kind that a use asked for.
    pub(crate) taken_signals: BTreeMap<String, (String, Option<SignalKind>)>,
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

    /// What is visible, the nearest first.
    fn scopes(&self) -> impl Iterator<Item = &Scope> {
        let module = self.module_scopes.get(self.module);
        let inner = std::iter::once(&self.body.scope).chain(module);
        inner.chain([&self.task, &self.predefined])
    }

    pub(crate) fn lookup(&self, key: &str) -> Option<&Symbol> {
        self.scopes().find_map(|scope| scope.get(key))
    }

    pub(crate) fn lookup_signal(&self, key: &str) -> Option<(String, SignalKind)> {
        self.signals.get(key).cloned()
    }

    pub(crate) fn type_name(&self, kind: &Type) -> String {
        kind.name(&self.records)
    }

    pub(crate) fn lookup_type(&self, key: &str) -> Option<Type> {
        self.local_types
            .get(self.module)
            .and_then(|types| types.get(key))
            .or_else(|| self.types.get(key))
            .cloned()
            .or_else(|| super::types::simple_type(key))
    }

    /// The visible name nearest to `wanted`, as it is spelled where it is declared.
    pub(crate) fn nearest(&self, wanted: &str, filter: impl Fn(&Symbol) -> bool) -> Option<String> {
        let symbols = self.scopes().flat_map(BTreeMap::values);
        let symbols = symbols.filter(|symbol| filter(symbol));
        let symbols = symbols.map(|symbol| symbol.name().to_owned());
        let signals = self.signals.values().map(|(name, _)| name.clone());
        nearest_name(wanted, symbols.chain(signals))
    }
}
