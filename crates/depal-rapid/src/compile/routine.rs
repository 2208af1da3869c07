use std::collections::BTreeMap;
use std::rc::Rc;

use depal_syntax::{Diagnostic, Span, nearest_name};
use depal_vm::{
    CallParameter, ErrorHandler, ErrorNumber, EventRoutines, Op, Routine as Lowered, Value,
};

use super::module_data::constant_of;
use super::scope::*;
use super::types::Type;
use crate::errors;
use crate::loading::{TaskEntry, TaskEvent};
use crate::syntax::tree::*;

impl Compiler<'_> {
    pub(super) fn headings<'x>(&mut self, modules: &'x [Module]) -> Vec<(usize, &'x Routine, u32)> {
        let mut routines = Vec::new();
        let mut names: BTreeMap<String, Span> = BTreeMap::new();
        for (module, tree) in modules.iter().enumerate() {
            self.module = module;
            if let Some(first) = names.insert(tree.name.key(), tree.name.span) {
                self.error(
                    Diagnostic::error(
                        "RAPID0110",
                        tree.name.span,
                        format!("there are two modules named {}", tree.name.text),
                    )
                    .secondary(first, "the first"),
                );
            }
            for routine in &tree.routines {
                let index = self.program.routines.len() as u32;
                self.program.routines.push(Lowered::default());
                let signature = Rc::new(self.signature(routine));
                let symbol = Symbol::Routine(RoutineSymbol {
                    signature,
                    callee: match routine.kind {
                        RoutineKind::Trap => Callee::Trap(index),
                        _ => Callee::Routine(index),
                    },
                    span: routine.name.span,
                });
                self.declare(module, routine.local, &routine.name, symbol);
                routines.push((module, routine, index));
            }
        }
        routines
    }

    pub(super) fn routine(&mut self, routine: &Routine, index: u32, module_name: &str) {
        let signature = self.signature_of(routine);
        self.body = Body {
            result: signature.result.clone(),
            ..Body::default()
        };
        for (parameter, tree) in signature.parameters.iter().zip(&routine.parameters) {
            let slot = self.new_local(Value::Absent);
            self.declare_local(
                &tree.name,
                DataSymbol {
                    name: tree.name.text.clone(),
                    slot: Slot::Local(slot),
                    kind: parameter.kind.clone(),
                    access: Access::Parameter(parameter.mode),
                    optional: parameter.optional,
                    span: tree.name.span,
                    constant: None,
                },
            );
        }
        for data in &routine.data {
            self.local_data(data);
        }
        self.statements(&routine.body);
        if signature.result.is_some() {
            self.emit(Op::MissingReturn);
        } else {
            self.emit(Op::Return { value: false });
        }
        let handler = routine.handler.as_ref().map(|handler| {
            let entry = self.here();
            self.body.in_handler = true;
            self.statements(&handler.body);
            self.emit(Op::Reraise);
            let numbers: Option<Vec<ErrorNumber>> = handler.numbers.as_ref().map(|numbers| {
                numbers
                    .iter()
                    .filter_map(|n| self.error_number(n))
                    .collect()
            });
            let all = ErrorNumber::Number(errors::error("LONG_JMP_ALL_ERR", "").number);
            ErrorHandler {
                entry,
                numbers: numbers.filter(|numbers| !numbers.contains(&all)),
            }
        });
        self.body.in_handler = false;
        if let RoutineKind::Function(_) = routine.kind {
            self.check_returns(routine);
        }
        let undo = routine.undo.as_ref().map(|body| {
            let entry = self.here();
            self.statements(body);
            self.emit(Op::EndUndo);
            entry
        });
        if let Some(body) = &routine.backward {
            // Checked like the rest; nothing jumps here.
            self.statements(body);
            self.emit(Op::Return { value: false });
        }
        let callable = (routine.kind == RoutineKind::Procedure).then(|| {
            let parameter = |p: &ParameterType| CallParameter {
                by_reference: p.mode != Mode::Value,
                optional: p.optional,
            };
            signature.parameters.iter().map(parameter).collect()
        });
        self.resolve_gotos();
        let body = std::mem::take(&mut self.body);
        self.program.routines[index as usize] = Lowered {
            name: routine.name.text.clone(),
            module: module_name.to_owned(),
            line: self.line(routine.name.span),
            locals: body.locals,
            code: body.code,
            handler,
            undo,
            callable,
        };
    }

    /// An error that a clause takes: a number, a constant, or data that hold the number when the error comes.
    fn error_number(&mut self, number: &Expression) -> Option<ErrorNumber> {
        if let Some(value) = self.constant(number, 0) {
            return Some(ErrorNumber::Number(value as i64));
        }
        if let ExpressionKind::Name(name) = &number.kind
            && let Some(Symbol::Data(data)) = self.lookup(&name.to_lowercase())
            && Type::Num.accepts(&data.kind)
            && !data.optional
        {
            return Some(match data.slot {
                Slot::Global(slot) => ErrorNumber::Global(slot),
                Slot::Local(slot) => ErrorNumber::Local(slot),
            });
        }
        self.error(Diagnostic::error(
            "RAPID0116",
            number.span,
            "an error number in ERROR(..) is a number, or data of type num or errnum",
        ));
        None
    }

    /// Warns if a function has no RETURN at all.
    fn check_returns(&mut self, routine: &Routine) {
        let gives_or_raises = |op: &Op| {
            matches!(
                op,
                Op::Return { value: true } | Op::Raise | Op::RaiseError(_)
            )
        };
        let statements = self.body.code.iter();
        let any = statements
            .clone()
            .any(|op| matches!(op, Op::Statement { .. }));
        if any && !self.body.code.iter().any(gives_or_raises) {
            self.error(
                Diagnostic::warning(
                    "RAPID0121",
                    routine.name.span,
                    format!("the function {} has no RETURN", routine.name.text),
                )
                .help("add RETURN and the value"),
            );
        }
    }

    /// The signature made with the headings; its errors were reported then.
    pub(super) fn signature_of(&mut self, routine: &Routine) -> Rc<Signature> {
        let found = self.module_scopes[self.module]
            .get(&routine.name.key())
            .or_else(|| self.task.get(&routine.name.key()));
        if let Some(Symbol::Routine(symbol)) = found
            && symbol.span == routine.name.span
        {
            return Rc::clone(&symbol.signature);
        }
        let reported = self.diagnostics.len();
        let signature = self.signature(routine);
        self.diagnostics.truncate(reported);
        Rc::new(signature)
    }

    pub(super) fn declare_local(&mut self, name: &Name, data: DataSymbol) {
        let previous = self.body.scope.insert(name.key(), Symbol::Data(data));
        if let Some(first) = previous {
            self.error(
                Diagnostic::error(
                    "RAPID0110",
                    name.span,
                    format!("{} is declared twice", name.text),
                )
                .secondary(first.span(), "first declared here"),
            );
        }
    }

    pub(super) fn local_data(&mut self, data: &Data) {
        let element = self.resolve_type(&data.type_name);
        let kind = self.array_type(element, data);
        if data.storage == Storage::Pers {
            self.error(
                Diagnostic::error(
                    "RAPID0134",
                    data.name.span,
                    format!("PERS {} cannot be declared in a routine", data.name.text),
                )
                .help("move it to the module"),
            );
        }
        let slot = self.new_local(kind.default_value(&self.records));
        if let Some(value) = &data.value {
            let begin = self.body.code.len();
            self.value(value, Some(&kind));
            if let [Op::Push(constant)] = &self.body.code[begin..] {
                if constant.is_present() {
                    self.body.locals[slot as usize] = constant.clone();
                }
                self.body.code.truncate(begin);
            } else {
                self.emit(Op::SetLocal(slot));
            }
        }
        self.declare_local(
            &data.name,
            DataSymbol {
                name: data.name.text.clone(),
                slot: Slot::Local(slot),
                kind,
                access: Access::Stored(data.storage),
                optional: false,
                span: data.name.span,
                constant: constant_of(data),
            },
        );
    }

    /// Finds what the task starts with and what runs at its events.
    pub(super) fn entries(&mut self, entry: &TaskEntry<'_>) {
        self.program.entry = self.startable(entry.main, true).unwrap_or(0);
        let mut events = EventRoutines::default();
        for (event, name, needed) in &entry.events {
            let list = match event {
                TaskEvent::BeforeStart => &mut events.before_start,
                TaskEvent::Stop => &mut events.on_stop,
                TaskEvent::Restart => &mut events.on_restart,
            };
            list.extend(self.startable(name, *needed));
        }
        self.program.events = events;
    }

    /// A procedure that can run by itself.
    fn startable(&mut self, entry: &str, needed: bool) -> Option<u32> {
        self.module = self.module_scopes.len();
        match self.task.get(&entry.to_lowercase()) {
            Some(Symbol::Routine(RoutineSymbol {
                callee: Callee::Routine(index),
                signature,
                ..
            })) if signature.result.is_none()
                && signature.parameters.iter().all(|p| p.optional) =>
            {
                return Some(*index);
            }
            Some(other) => {
                let span = other.span();
                self.error(Diagnostic::error(
                    "RAPID0117",
                    span,
                    format!(
                        "{entry} cannot be started: it must be a PROC without required parameters"
                    ),
                ));
            }
            None if !needed => {}
            None => {
                let names = self.task.values().filter_map(|symbol| match symbol {
                    Symbol::Routine(routine) => Some(routine.signature.name.clone()),
                    Symbol::Data(_) => None,
                });
                let near = nearest_name(entry, names);
                let mut diagnostic = Diagnostic::error(
                    "RAPID0117",
                    Span::new(0, 0, 0),
                    format!("there is no procedure {entry} to start"),
                );
                if let Some(near) = near {
                    diagnostic = diagnostic.help(format!("did you mean {near}?"));
                }
                self.error(diagnostic);
            }
        }
        None
    }
}
