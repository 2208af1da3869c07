use depal_syntax::{Diagnostic, Span};
use depal_vm::{Op, Routine, Value};

use super::scope::*;
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    /// The condition and the call become routines of their own; they see the module's data.
    pub(super) fn interrupt_declaration(
        &mut self,
        global: bool,
        number: &Expression,
        condition: &Expression,
        (routine, arguments): (&Name, &[Option<Expression>]),
        span: Span,
    ) {
        let condition = self.small_routine(routine, span, |this| {
            this.body.ahead = true;
            this.value(condition, Some(&Type::Bool));
            this.emit(Op::Return { value: true });
        });
        let called = self.small_routine(routine, span, |this| {
            this.body.ahead = true;
            this.call(routine, arguments);
            this.emit_builtin("interrupt end", 0, false);
            this.emit(Op::Return { value: false });
        });
        self.value(number, Some(&Type::Int));
        self.emit(Op::Push(Value::Int(i64::from(condition))));
        self.emit(Op::Push(Value::Int(i64::from(called))));
        self.emit(Op::Push(Value::Bool(global)));
        self.emit_builtin("interrupt declare", 4, false);
    }

    /// A routine without statements; its index.
    fn small_routine(&mut self, name: &Name, span: Span, make: impl FnOnce(&mut Self)) -> u32 {
        let around = std::mem::take(&mut self.body);
        let before = self.diagnostics.len();
        make(self);
        let made = std::mem::replace(&mut self.body, around);
        // What is local to the routine around is not there when the interrupt comes.
        let locals = &self.body.scope;
        for diagnostic in &mut self.diagnostics[before..] {
            let named = diagnostic.message.split(' ').next().unwrap_or_default();
            if diagnostic.code == "KRL0100" && locals.contains_key(&named.to_lowercase()) {
                *diagnostic = Diagnostic::error(
                    "KRL0125",
                    diagnostic.primary.span,
                    format!("{named} is local to this routine; an interrupt does not see it"),
                )
                .help("declare it in the data list of the module");
            }
        }
        let line = self.line(span);
        self.program.routines.push(Routine {
            name: name.text.clone(),
            module: self.module_name.clone(),
            line,
            locals: made.locals,
            code: made.code,
            ..Routine::default()
        });
        self.program.routines.len() as u32 - 1
    }

    /// Outputs are set along the next move. The built-in takes kind of place, distance in mm, delay in ms,
    /// output and value.
    pub(super) fn trigger(
        &mut self,
        place: &TriggerPlace,
        delay: &Expression,
        action: &Statement,
        priority: Option<&Expression>,
    ) {
        let (kind, distance) = match place {
            TriggerPlace::Distance(distance) => (0, distance),
            TriggerPlace::Path {
                distance,
                on_start: false,
            } => (1, distance),
            TriggerPlace::Path { distance, .. } => (2, distance),
        };
        self.emit(Op::Push(Value::Int(kind)));
        self.value(distance, Some(&Type::Real));
        self.value(delay, Some(&Type::Real));
        match &action.kind {
            StatementKind::Assign { target, value } if self.output_number(target) => {
                self.value(value, Some(&Type::Bool));
                self.emit_builtin("trigger", 5, false);
            }
            StatementKind::Call { name, arguments } => {
                let called = self.small_routine(name, action.span, |this| {
                    this.body.ahead = true;
                    this.call(name, arguments);
                    this.emit_builtin("interrupt end", 0, false);
                    this.emit(Op::Return { value: false });
                });
                self.emit(Op::Push(Value::Int(i64::from(called))));
                match priority {
                    Some(priority) => {
                        self.value(priority, Some(&Type::Int));
                    }
                    None => {
                        self.error(
                            Diagnostic::error(
                                "KRL0126",
                                action.span,
                                "a TRIGGER that calls a routine needs a priority",
                            )
                            .help("add PRIO = -1"),
                        );
                    }
                }
                self.emit_builtin("trigger call", 5, false);
            }
            _ => self.error(
                Diagnostic::error(
                    "KRL0120",
                    action.span,
                    "only digital outputs and calls are simulated as the action of a TRIGGER",
                )
                .help("write $OUT[n], the SIGNAL of one output, or a call"),
            ),
        }
    }
}
