//! Calls of programs and of the vision calls, and RUN.

use depal_syntax::{Diagnostic, Span};
use depal_vm::Op;

use super::Compiler;
use super::routine::ARGUMENTS;
use crate::syntax::tree::*;

impl Compiler<'_> {
    pub(super) fn call(&mut self, call: &Call, span: Span) {
        if call.arguments.len() > ARGUMENTS + 1 {
            let message = format!(
                "{} arguments are given; a program takes at most {ARGUMENTS}",
                call.arguments.len()
            );
            self.error(Diagnostic::error("TP0230", span, message));
            return;
        }
        match &call.callee {
            Callee::Name(name) => self.call_by_name(name, &call.arguments),
            Callee::Register(index) => self.call_by_register(index, &call.arguments),
        }
    }

    /// A program that runs beside this one.
    pub(super) fn run(&mut self, call: &Call, span: Span) {
        let Callee::Name(name) = &call.callee else {
            self.refuse(span, "RUN SR[...]");
            return;
        };
        let key = name.text.to_uppercase();
        let Some(routine) = self.programs.get(&key).copied() else {
            self.call_by_name(name, &[]);
            return;
        };
        self.push_number(f64::from(routine));
        for argument in &call.arguments {
            self.value(argument);
        }
        self.call_builtin("run", call.arguments.len() as u32 + 1, false);
    }

    fn call_by_name(&mut self, name: &Name, arguments: &[Expr]) {
        let key = name.text.to_uppercase();
        if let Some(routine) = self.programs.get(&key).copied() {
            for argument in arguments {
                self.value(argument);
            }
            self.emit(Op::Call {
                routine,
                arguments: arguments.len() as u32,
            });
            return;
        }
        if let Some(call) = crate::mm::CALLS
            .iter()
            .find(|c| c.name.eq_ignore_ascii_case(&key))
        {
            let wanted = call.parameters.len();
            // A status register behind the others is that of newer versions.
            if arguments.len() != wanted && arguments.len() != wanted + 1 {
                let message = format!(
                    "{} takes {wanted} arguments, or {} with a status register, {} are given",
                    call.name,
                    wanted + 1,
                    arguments.len()
                );
                self.error(
                    Diagnostic::error("TP0231", name.span, message).help(format!(
                        "{}({})",
                        call.name,
                        call.parameters.join(",")
                    )),
                );
                return;
            }
            self.settle();
            for argument in arguments {
                self.value(argument);
            }
            self.call_builtin(call.name, arguments.len() as u32, false);
            return;
        }
        let message = format!("there is no program {}", name.text);
        let mut message = Diagnostic::warning("TP0232", name.span, message)
            .label("the program stops with an error when it gets here");
        if let Some(near) = self.near_program(&key) {
            message = message.help(format!("did you mean {near}?"));
        }
        self.error(message);
        self.push_text(name.text.clone());
        self.call_builtin("missing program", 1, false);
    }

    /// The register is compared with the name of each program.
    fn call_by_register(&mut self, index: &Expr, arguments: &[Expr]) {
        let held = self.new_local();
        self.amount(index);
        self.call_builtin("sr get", 1, true);
        self.emit(Op::SetLocal(held));
        let mut ends = Vec::new();
        let programs: Vec<(String, u32)> =
            self.programs.iter().map(|(n, r)| (n.clone(), *r)).collect();
        for (name, routine) in programs {
            let next = self.is_named(held, &name);
            for argument in arguments {
                self.value(argument);
            }
            self.emit(Op::Call {
                routine,
                arguments: arguments.len() as u32,
            });
            ends.push(self.emit(Op::Jump(0)));
            self.land(next);
        }
        for call in crate::mm::CALLS {
            let wanted = call.parameters.len();
            if arguments.len() != wanted && arguments.len() != wanted + 1 {
                continue;
            }
            let next = self.is_named(held, call.name);
            self.settle();
            for argument in arguments {
                self.value(argument);
            }
            self.call_builtin(call.name, arguments.len() as u32, false);
            ends.push(self.emit(Op::Jump(0)));
            self.land(next);
        }
        self.emit(Op::LoadLocal(held));
        self.call_builtin("missing program", 1, false);
        for end in ends {
            self.land(end);
        }
    }

    fn is_named(&mut self, held: u32, name: &str) -> usize {
        self.emit(Op::LoadLocal(held));
        self.push_text(name);
        self.call_builtin("name is", 2, true);
        self.emit(Op::JumpIfFalse(0))
    }
}
