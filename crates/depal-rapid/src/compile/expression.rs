use std::sync::Arc;

use depal_syntax::{Diagnostic, Span};
use depal_vm::{Op, UnaryOp, Value};

use super::place::is_place;
use super::scope::{Compiler, Slot, Symbol};
use super::types::Type;
use crate::syntax::tree::*;

/// Largest whole number that a num literal holds exactly; a larger literal is a dnum.
const NUM_INTEGER_LIMIT: f64 = 8_388_608.0;

impl Compiler<'_> {
    /// Lowers a value and checks it against `expected`. Signals are read unless a signal is expected.
    pub(crate) fn value(&mut self, expression: &Expression, expected: Option<&Type>) -> Type {
        let found = self.any_value(expression, expected);
        if let (Type::Signal(None), Some(Type::Signal(Some(kind))), ExpressionKind::Name(name)) =
            (&found, expected, &expression.kind)
            && let Some((_, taken)) = self.taken_signals.get_mut(&name.to_lowercase())
        {
            taken.get_or_insert(*kind);
        }
        let found = match (found, expected) {
            (Type::Signal(kind), Some(Type::Signal(_) | Type::Any)) => Type::Signal(kind),
            (Type::Signal(_), _) => {
                self.emit(Op::ReadSignal);
                Type::Num
            }
            (found, _) => found,
        };
        if let Some(expected) = expected
            && !expected.accepts(&found)
        {
            self.mismatch(expression.span, expected, &found);
            return Type::Broken;
        }
        found
    }

    pub(crate) fn mismatch(&mut self, span: Span, expected: &Type, found: &Type) {
        let (wanted, got) = (self.type_name(expected), self.type_name(found));
        let mut diagnostic =
            Diagnostic::error("RAPID0104", span, format!("expected {wanted}, found {got}"))
                .label(format!("this is {got}"));
        diagnostic.help = match (expected, found) {
            (Type::Num, Type::Dnum) => Some("convert with DnumToNum(..)".into()),
            (Type::Dnum, Type::Num) => Some("convert with NumToDnum(..)".into()),
            (Type::Text, Type::Num | Type::Dnum) => {
                Some("convert with NumToStr(.., decimals) or ValToStr(..)".into())
            }
            (Type::Bool, Type::Num) => Some("compare it: .. = 1".into()),
            _ => None,
        };
        self.error(diagnostic);
    }

    pub(super) fn any_value(&mut self, expression: &Expression, expected: Option<&Type>) -> Type {
        let span = expression.span;
        match &expression.kind {
            ExpressionKind::Number { value, integer } => {
                let dnum = match expected {
                    Some(Type::Dnum) => true,
                    Some(Type::Num) => false,
                    _ => *integer && value.abs() > NUM_INTEGER_LIMIT,
                };
                if dnum {
                    self.emit(Op::Push(Value::Dnum(*value)));
                    Type::Dnum
                } else {
                    self.emit(Op::Push(Value::Num(*value as f32)));
                    Type::Num
                }
            }
            ExpressionKind::Text(text) => {
                self.emit(Op::Push(Value::Str(text.clone())));
                Type::Text
            }
            ExpressionKind::Bool(value) => {
                self.emit(Op::Push(Value::Bool(*value)));
                Type::Bool
            }
            ExpressionKind::Name(name) => self.name_value(name, span),
            ExpressionKind::Field(..) | ExpressionKind::Index(..) => {
                if is_place(expression) {
                    let kind = self.place(expression);
                    self.emit(Op::LoadPlace);
                    kind
                } else {
                    self.part_of_value(expression)
                }
            }
            ExpressionKind::Call { name, arguments } => self.call_value(name, arguments, span),
            ExpressionKind::Aggregate(items) => self.aggregate(items, span, expected),
            ExpressionKind::Negate(operand) => {
                let found = self.value(operand, expected.filter(|t| t.is_number()));
                if !found.is_number() && !matches!(found, Type::Record(_)) {
                    self.operand_error(operand.span, "minus", &found);
                }
                self.emit(Op::Unary(UnaryOp::Negate));
                found
            }
            ExpressionKind::Not(operand) => {
                self.value(operand, Some(&Type::Bool));
                self.emit(Op::Unary(UnaryOp::Not));
                Type::Bool
            }
            ExpressionKind::Binary(operator, left, right) => {
                self.binary(*operator, left, right, expected)
            }
            ExpressionKind::Broken => {
                self.emit(Op::Push(Value::Absent));
                Type::Broken
            }
        }
    }

    pub(super) fn operand_error(&mut self, span: Span, operator: &str, found: &Type) {
        let got = self.type_name(found);
        self.error(Diagnostic::error(
            "RAPID0104",
            span,
            format!("{operator} does not take {got}"),
        ));
    }

    pub(super) fn name_value(&mut self, name: &str, span: Span) -> Type {
        let key = name.to_lowercase();
        match self.lookup(&key).cloned() {
            Some(Symbol::Data(data)) => {
                match data.slot {
                    Slot::Global(slot) => self.emit(Op::LoadGlobal(slot)),
                    Slot::Local(slot) => self.emit(Op::LoadLocal(slot)),
                };
                data.kind
            }
            Some(Symbol::Routine(routine)) => {
                let help = if routine.signature.result.is_some() {
                    format!("call it with parentheses: {name}(..)")
                } else {
                    "a procedure has no value".into()
                };
                self.error(
                    Diagnostic::error("RAPID0111", span, format!("{name} is a routine, not data"))
                        .help(help),
                );
                self.emit(Op::Push(Value::Absent));
                Type::Broken
            }
            None if key == "errno" => {
                self.emit(Op::LoadErrorNumber);
                Type::Num
            }
            None if key == "intno" => {
                self.emit(Op::LoadInterruptNumber);
                Type::Num
            }
            None => self.signal_or_unknown(name, &key, span),
        }
    }

    pub(super) fn signal_or_unknown(&mut self, name: &str, key: &str, span: Span) -> Type {
        if let Some((spelled, kind)) = self.lookup_signal(key) {
            self.emit(Op::Push(Value::Signal(Arc::from(spelled))));
            return Type::Signal(Some(kind));
        }
        if let Some((_, number)) = crate::errors::ERRORS
            .iter()
            .find(|(error, _)| error.eq_ignore_ascii_case(name))
        {
            self.emit(Op::Push(Value::Num(*number as f32)));
            return Type::Num;
        }
        if self.any_signal {
            let taken = self.taken_signals.entry(key.to_owned());
            taken.or_insert_with(|| (name.to_owned(), None));
            self.emit(Op::Push(Value::Signal(Arc::from(name))));
            self.error(
                Diagnostic::warning(
                    "RAPID0102",
                    span,
                    format!("{name} is not declared; taken as a signal of the controller"),
                )
                .help("check together with the cell to know its signals"),
            );
            return Type::Signal(None);
        }
        let mut diagnostic = Diagnostic::error(
            "RAPID0100",
            span,
            format!("there are no data and no signal named {name}"),
        );
        if let Some(near) = self.nearest(name, |s| matches!(s, Symbol::Data(_))) {
            diagnostic = diagnostic.help(format!("did you mean {near}?"));
        }
        self.error(diagnostic);
        self.emit(Op::Push(Value::Absent));
        Type::Broken
    }
}
