use std::rc::Rc;

use depal_syntax::{Diagnostic, Span};
use depal_vm::{Op, Value};

use super::scope::*;
use super::types::{Type, same};
use crate::syntax::tree::*;

impl Compiler<'_> {
    /// A call in an expression.
    pub(super) fn call_value(
        &mut self,
        name: &Name,
        arguments: &[Option<Expression>],
        span: Span,
    ) -> Type {
        let Some(routine) = self.called(name) else {
            self.look_at(arguments);
            self.emit(Op::Push(Value::Unset));
            return Type::Broken;
        };
        let Some(result) = routine.signature.result.clone() else {
            self.error(
                Diagnostic::error(
                    "KRL0111",
                    span,
                    format!("{} is a subprogram, it has no value", name.text),
                )
                .help("a routine with a value is declared with DEFFCT"),
            );
            self.look_at(arguments);
            self.emit(Op::Push(Value::Unset));
            return Type::Broken;
        };
        self.emit_call(&routine, name, arguments, true);
        result
    }

    /// A call as a statement.
    pub(super) fn call(&mut self, name: &Name, arguments: &[Option<Expression>]) {
        let Some(routine) = self.called(name) else {
            self.look_at(arguments);
            return;
        };
        let result = routine.signature.result.is_some();
        self.emit_call(&routine, name, arguments, result);
        if result {
            self.emit(Op::Pop);
        }
    }

    fn called(&mut self, name: &Name) -> Option<RoutineSymbol> {
        match self.lookup(&name.key()).cloned() {
            Some(Symbol::Routine(routine)) => Some(routine),
            Some(other) => {
                let data = other.span();
                let mut diagnostic = Diagnostic::error(
                    "KRL0111",
                    name.span,
                    format!("{} is data, not a routine", name.text),
                );
                if data.file != u32::MAX {
                    diagnostic = diagnostic.secondary(data, "declared here");
                }
                self.error(diagnostic.help("an element of an array is written with [ ]"));
                None
            }
            None => {
                let mut diagnostic = Diagnostic::error(
                    "KRL0102",
                    name.span,
                    format!("there is no routine named {}", name.text),
                );
                let near = self.nearest(&name.text, |s| matches!(s, Symbol::Routine(_)));
                if let Some(near) = near {
                    diagnostic = diagnostic.help(format!("did you mean {near}?"));
                }
                self.error(diagnostic);
                None
            }
        }
    }

    /// Looks for errors in arguments of a call that cannot be made.
    fn look_at(&mut self, arguments: &[Option<Expression>]) {
        let begin = self.body.code.len();
        for argument in arguments.iter().flatten() {
            self.any_value(argument, None);
        }
        self.body.code.truncate(begin);
    }

    fn emit_call(
        &mut self,
        routine: &RoutineSymbol,
        name: &Name,
        arguments: &[Option<Expression>],
        result: bool,
    ) {
        let signature = Rc::clone(&routine.signature);
        if signature.stops_advance {
            self.stop_advance();
        }
        let most = signature.parameters.len();
        if arguments.len() > most && signature.more.is_none() {
            let extra = arguments[most..].iter().flatten().next();
            let span = extra.map_or(name.span, |e| e.span);
            let diagnostic = Diagnostic::error(
                "KRL0105",
                span,
                format!(
                    "{} takes {most} arguments, {} are given",
                    signature.name,
                    arguments.len()
                ),
            )
            .help(format!("usage: {}", self.usage(&signature)));
            self.error(diagnostic);
        }
        for (i, parameter) in signature.parameters.iter().enumerate() {
            match arguments.get(i).and_then(Option::as_ref) {
                Some(argument) => self.argument(&signature, parameter, argument),
                None if parameter.optional => {
                    self.emit(Op::Push(Value::Absent));
                }
                None => {
                    let mut diagnostic = Diagnostic::error(
                        "KRL0106",
                        name.span,
                        format!("{} needs its argument {}", signature.name, parameter.name),
                    )
                    .help(format!("usage: {}", self.usage(&signature)));
                    if routine.span.file != u32::MAX {
                        diagnostic = diagnostic.secondary(routine.span, "declared here");
                    }
                    self.error(diagnostic);
                    self.emit(Op::Push(Value::Unset));
                }
            }
        }
        let mut count = most;
        if let Some(mode) = signature.more {
            for argument in arguments.iter().skip(most).flatten() {
                self.any_argument(&signature, mode, argument);
                count += 1;
            }
        }
        let count = count as u32;
        match routine.callee {
            Callee::Routine(routine) => self.emit(Op::Call {
                routine,
                arguments: count,
            }),
            Callee::Builtin(builtin) => self.emit(Op::CallBuiltin {
                builtin,
                arguments: count,
                result,
            }),
        };
    }

    fn argument(&mut self, signature: &Signature, parameter: &ParameterType, value: &Expression) {
        match (&parameter.kind, parameter.mode) {
            (Type::Any, mode) => self.any_argument(signature, mode, value),
            (Type::Output, _) => {
                if !self.output_number(value) {
                    self.error(
                        Diagnostic::error("KRL0122", value.span, "a digital output is needed here")
                            .help("write $OUT[1], or the name of a SIGNAL of one output"),
                    );
                    self.emit(Op::Push(Value::Unset));
                }
            }
            (kind, Mode::In) => {
                self.value(value, Some(kind));
            }
            (kind, Mode::Out) => {
                if !self.lend(signature, &parameter.name, value) {
                    return;
                }
                let found = self.place(value);
                if !same(kind, &found) {
                    self.mismatch(value.span, kind, &found);
                }
            }
        }
    }

    /// A value, or a variable, with the name of its type.
    fn any_argument(&mut self, signature: &Signature, mode: Mode, value: &Expression) {
        let at = self.emit(Op::Push(Value::Absent));
        let kind = match mode {
            Mode::In => self.any_value(value, None),
            Mode::Out if !self.lend(signature, "", value) => return,
            Mode::Out => self.place(value),
        };
        let name = self.type_name(&kind);
        self.body.code[at] = Op::Push(Value::Str(name));
        self.emit(Op::MakeRecord(2));
    }

    /// Whether an argument is a variable that the routine may change.
    fn lend(&mut self, signature: &Signature, parameter: &str, value: &Expression) -> bool {
        match self.root(value).cloned() {
            Some(Symbol::Data(data)) if !data.constant => return true,
            Some(Symbol::Data(data)) => {
                self.error(
                    Diagnostic::error(
                        "KRL0109",
                        value.span,
                        format!(
                            "{} is a constant, {} may change it",
                            data.name, signature.name
                        ),
                    )
                    .secondary(data.span, "declared here"),
                );
            }
            None if matches!(value.kind, ExpressionKind::Name(_)) => {
                self.any_value(value, None);
                return false;
            }
            _ => {
                let diagnostic = Diagnostic::error(
                    "KRL0108",
                    value.span,
                    format!(
                        "{} may change this argument: a variable is needed",
                        signature.name
                    ),
                );
                let help = if parameter.is_empty() {
                    "put the value into a variable first".to_owned()
                } else {
                    format!("put the value into a variable first, or declare {parameter}:IN")
                };
                self.error(diagnostic.help(help));
            }
        }
        self.emit(Op::Push(Value::Unset));
        false
    }

    pub(super) fn usage(&self, signature: &Signature) -> String {
        let mut parameters: Vec<_> = signature
            .parameters
            .iter()
            .map(|p| {
                let mode = match p.mode {
                    Mode::In => "IN",
                    Mode::Out => "OUT",
                };
                let text = format!("{} {}:{mode}", self.type_name(&p.kind), p.name);
                if p.optional {
                    format!("[{text}]")
                } else {
                    text
                }
            })
            .collect();
        if signature.more.is_some() {
            parameters.push("...".into());
        }
        format!("{}({})", signature.name, parameters.join(", "))
    }
}
