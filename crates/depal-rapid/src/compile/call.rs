use depal_syntax::{Diagnostic, Span};
use depal_vm::{Op, Value};

use super::place::is_place;
use super::scope::{Access, Callee, Compiler, RoutineSymbol, Slot, Symbol};
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    pub(super) fn call_value(&mut self, name: &Name, arguments: &[Argument], span: Span) -> Type {
        let key = name.key();
        if key == "present" {
            return self.present(arguments, span);
        }
        let Some(routine) = self.lookup_routine(name, true) else {
            self.emit(Op::Push(Value::Absent));
            return Type::Broken;
        };
        let Some(result) = routine.signature.result.clone() else {
            self.error(Diagnostic::error(
                "RAPID0111",
                name.span,
                format!("{} is a procedure and has no value", name.text),
            ));
            self.emit(Op::Push(Value::Absent));
            return Type::Broken;
        };
        let count = self.arguments(&routine.signature, name, arguments);
        self.emit_call(routine.callee, count, true);
        result
    }

    /// WaitUntil is lowered otherwise, and a TRAP is refused.
    fn emit_call(&mut self, callee: Callee, arguments: u32, result: bool) {
        match callee {
            Callee::Routine(routine) => self.emit(Op::Call { routine, arguments }),
            Callee::Builtin(builtin) => self.emit(Op::CallBuiltin {
                builtin,
                arguments,
                result,
            }),
            Callee::ResetRetryCount => self.emit(Op::ResetRetries),
            Callee::WaitUntil | Callee::Trap(_) => 0,
        };
    }

    pub(super) fn present(&mut self, arguments: &[Argument], span: Span) -> Type {
        if let [
            Argument::Positional(Expression {
                kind: ExpressionKind::Name(name),
                ..
            }),
        ] = arguments
            && let Some(Symbol::Data(data)) = self.lookup(&name.to_lowercase()).cloned()
            && let (Slot::Local(slot), true) =
                (data.slot, matches!(data.access, Access::Parameter(_)))
        {
            if !data.optional {
                self.error(Diagnostic::warning(
                    "RAPID0125",
                    span,
                    format!("{name} is not optional, so it is always present"),
                ));
            }
            self.emit(Op::IsPresent(slot));
            return Type::Bool;
        }
        self.error(Diagnostic::error(
            "RAPID0126",
            span,
            "Present takes the name of an optional parameter of this routine",
        ));
        self.emit(Op::Push(Value::Bool(false)));
        Type::Bool
    }

    pub(super) fn call(&mut self, name: &Name, arguments: &[Argument]) {
        let Some(routine) = self.lookup_routine(name, false) else {
            return;
        };
        if routine.signature.result.is_some() {
            self.error(
                Diagnostic::error(
                    "RAPID0111",
                    name.span,
                    format!("{} is a function; its value must be used", name.text),
                )
                .help(format!("write x := {}(..);", name.text)),
            );
            return;
        }
        if routine.callee == Callee::WaitUntil {
            self.wait_until(&routine.signature, name, arguments);
            return;
        }
        if let Callee::Trap(_) = routine.callee {
            self.error(
                Diagnostic::error(
                    "RAPID0111",
                    name.span,
                    format!("{} is a TRAP and cannot be called", name.text),
                )
                .help("a TRAP runs when its interrupt comes: CONNECT .. WITH .."),
            );
            return;
        }
        let count = self.arguments(&routine.signature, name, arguments);
        self.emit_call(routine.callee, count, false);
    }

    /// Arguments of a call by name: data are given by reference, the callee takes what it needs.
    pub(super) fn call_by_name(&mut self, name: &Expression, arguments: &[Argument]) {
        self.value(name, Some(&Type::Text));
        for argument in arguments {
            let Argument::Positional(value) = argument else {
                self.error(
                    Diagnostic::error(
                        "RAPID0112",
                        argument.span(),
                        "optional arguments of a call by name are not simulated",
                    )
                    .help("call the procedure by its own name, or leave the argument out"),
                );
                continue;
            };
            if is_place(value) && self.root_data(value).is_some() {
                self.place(value);
            } else {
                self.value(value, None);
            }
        }
        self.emit(Op::CallByName {
            arguments: arguments.len() as u32,
        });
    }

    pub(super) fn connect(&mut self, variable: &Expression, trap: &Name) {
        let routine = if let Some(Symbol::Routine(RoutineSymbol {
            callee: Callee::Trap(routine),
            ..
        })) = self.lookup(&trap.key())
        {
            *routine
        } else {
            self.error(Diagnostic::error(
                "RAPID0101",
                trap.span,
                format!("there is no TRAP named {}", trap.text),
            ));
            return;
        };
        self.check_assignable(variable);
        let kind = self.place(variable);
        if !Type::Num.accepts(&kind) {
            self.mismatch(variable.span, &Type::Num, &kind);
        }
        self.emit(Op::Connect(routine));
    }
}
