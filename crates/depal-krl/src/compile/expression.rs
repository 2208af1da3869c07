use depal_syntax::{Diagnostic, Span, nearest_name};
use depal_vm::{Op, UnaryOp, Value};

use super::scope::*;
use super::types::*;
use crate::syntax::print_expression::expression_text;
use crate::syntax::tree::*;

impl Compiler<'_> {
    /// Lowers a value and converts it to `expected`.
    pub(super) fn value(&mut self, expression: &Expression, expected: Option<&Type>) -> Type {
        let found = self.any_value(expression, expected);
        let Some(expected) = expected else {
            return found;
        };
        if !self.types.accepts(expected, &found) {
            self.mismatch(expression.span, expected, &found);
            return Type::Broken;
        }
        self.convert(expected, &found);
        found
    }

    /// Converts the top of the stack.
    pub(super) fn convert(&mut self, expected: &Type, found: &Type) {
        match (expected, found) {
            (Type::Real, Type::Int) => {
                self.emit(Op::Unary(UnaryOp::ToNum));
            }
            (Type::Int, Type::Real) => {
                self.emit(Op::Unary(UnaryOp::ToInteger));
            }
            (Type::Struc(to), Type::Struc(from)) if to != from => {
                let from = &self.types.strucs[*from].fields;
                let sources = self.types.strucs[*to].fields.iter().map(|(name, _)| {
                    let mut names = from.iter();
                    let found = names.position(|(other, _)| other.eq_ignore_ascii_case(name));
                    Value::Int(found.map_or(-1, |i| i as i64))
                });
                let sources = Value::Array(sources.collect());
                self.emit(Op::Push(sources));
                self.emit_builtin("reshape", 2, true);
            }
            _ => {}
        }
    }

    pub(super) fn mismatch(&mut self, span: Span, expected: &Type, found: &Type) {
        let (wanted, got) = (self.type_name(expected), self.type_name(found));
        let mut diagnostic =
            Diagnostic::error("KRL0104", span, format!("expected {wanted}, found {got}"))
                .label(format!("this is {got}"));
        diagnostic.help = match (expected, found) {
            (Type::Bool, Type::Int | Type::Real) => Some("compare it: .. == 1".into()),
            (Type::Array { .. }, found) if expected.is_text() && found.is_number() => {
                Some("write it into a string with SWRITE".into())
            }
            _ => None,
        };
        self.error(diagnostic);
    }

    pub(super) fn any_value(&mut self, expression: &Expression, expected: Option<&Type>) -> Type {
        let span = expression.span;
        match &expression.kind {
            ExpressionKind::Integer(value) => {
                if *value > i64::from(i32::MAX) {
                    self.too_large(span, *value);
                }
                if expected == Some(&Type::Real) {
                    self.emit(Op::Push(Value::Num(*value as f32)));
                    return Type::Real;
                }
                self.emit(Op::Push(Value::Int(*value)));
                Type::Int
            }
            ExpressionKind::Real(value) => {
                self.emit(Op::Push(Value::Num(*value as f32)));
                Type::Real
            }
            ExpressionKind::Text(text) => {
                let mut value = codes(text);
                let count = text.chars().count();
                if let (Value::Array(items), Some(Type::Char), 1) = (&mut value, expected, count) {
                    let code = items.remove(0);
                    self.emit(Op::Push(code));
                    return Type::Char;
                }
                self.emit(Op::Push(value));
                Type::text(count)
            }
            ExpressionKind::Bool(value) => {
                self.emit(Op::Push(Value::Bool(*value)));
                Type::Bool
            }
            ExpressionKind::Constant(name) => {
                if let Some((index, kind)) = self.enum_constant(name, expected) {
                    self.emit(Op::Push(Value::Int(index)));
                    return kind;
                }
                self.emit(Op::Push(Value::Unset));
                Type::Broken
            }
            ExpressionKind::Name(name) => self.name_value(name, span),
            ExpressionKind::Field(..) | ExpressionKind::Index(..) => self.part(expression),
            ExpressionKind::Call { name, arguments } => self.call_value(name, arguments, span),
            ExpressionKind::Aggregate { type_name, fields } => {
                self.aggregate(type_name.as_ref(), fields, span, expected)
            }
            ExpressionKind::Group(inner) => self.any_value(inner, expected),
            ExpressionKind::Negate(operand) => {
                if let ExpressionKind::Integer(value) = operand.kind {
                    if -value < i64::from(i32::MIN) {
                        self.too_large(span, -value);
                    }
                    self.emit(Op::Push(Value::Int(-value)));
                    return Type::Int;
                }
                let found = self.value(operand, None);
                if !found.is_number() {
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
            ExpressionKind::BitNot(operand) => {
                self.value(operand, Some(&Type::Int));
                self.emit(Op::Unary(UnaryOp::BitNot));
                Type::Int
            }
            ExpressionKind::Binary(operator, left, right) => self.binary(*operator, left, right),
            ExpressionKind::Broken => {
                self.emit(Op::Push(Value::Unset));
                Type::Broken
            }
        }
    }

    pub(super) fn operand_error(&mut self, span: Span, operator: &str, found: &Type) {
        if *found == Type::Broken {
            return;
        }
        let got = self.type_name(found);
        self.error(Diagnostic::error(
            "KRL0104",
            span,
            format!("{operator} does not take {got}"),
        ));
    }

    /// A component or an element.
    fn part(&mut self, expression: &Expression) -> Type {
        if self.is_place(expression) {
            let kind = self.place(expression);
            self.emit(Op::LoadPlace);
            self.check_set(expression, &kind);
            return kind;
        }
        match &expression.kind {
            ExpressionKind::Field(inner, field) => {
                let kind = self.any_value(inner, None);
                let (index, kind) = self.field(&kind, field);
                self.emit(Op::Field(index));
                self.check_set(expression, &kind);
                kind
            }
            ExpressionKind::Index(inner, indexes) => {
                if let Some(kind) = self.live_element(inner, indexes, expression.span) {
                    return kind;
                }
                let kind = self.any_value(inner, None);
                let (count, kind) = self.indexes(&kind, indexes, expression.span);
                if count > 0 {
                    self.emit(Op::Index(count));
                }
                kind
            }
            _ => Type::Broken,
        }
    }

    /// What was read must have a value. A string may be empty.
    fn check_set(&mut self, expression: &Expression, kind: &Type) {
        if !matches!(kind, Type::Array { .. } | Type::Broken) {
            let name = expression_text(expression).into_boxed_str();
            self.emit(Op::CheckSet(name));
        }
    }

    pub(super) fn name_value(&mut self, name: &str, span: Span) -> Type {
        match self.lookup(&name.to_lowercase()).cloned() {
            Some(Symbol::Data(data)) => {
                match data.slot {
                    Slot::Global(slot) => self.emit(Op::LoadGlobal(slot)),
                    Slot::Local(slot) => self.emit(Op::LoadLocal(slot)),
                };
                let expression = Expression {
                    kind: ExpressionKind::Name(name.to_owned()),
                    span,
                };
                self.check_set(&expression, &data.kind);
                data.kind
            }
            Some(Symbol::Signal(signal)) => self.read_signal(&signal),
            Some(Symbol::Live(live)) => {
                if live.indexed {
                    self.error(
                        Diagnostic::error("KRL0114", span, format!("{} needs an index", live.name))
                            .help(format!("write {}[1]", live.name)),
                    );
                }
                self.read_live(live)
            }
            Some(Symbol::Routine(routine)) => {
                let help = if routine.signature.result.is_some() {
                    format!("call it with parentheses: {name}( .. )")
                } else {
                    "a subprogram has no value".into()
                };
                self.error(
                    Diagnostic::error("KRL0111", span, format!("{name} is a routine, not data"))
                        .help(help),
                );
                self.emit(Op::Push(Value::Unset));
                Type::Broken
            }
            None => {
                self.unknown_name(name, span);
                self.emit(Op::Push(Value::Unset));
                Type::Broken
            }
        }
    }

    /// Number, from 1, and type of a constant of an enumeration.
    pub(super) fn enum_constant(
        &mut self,
        name: &Name,
        expected: Option<&Type>,
    ) -> Option<(i64, Type)> {
        let find = |kind: &EnumType| {
            let mut constants = kind.constants.iter();
            constants.position(|c| c.eq_ignore_ascii_case(&name.text))
        };
        if let Some(Type::Enum(index)) = expected {
            let kind = &self.types.enums[*index];
            if let Some(at) = find(kind) {
                return Some((at as i64 + 1, Type::Enum(*index)));
            }
            let diagnostic = Diagnostic::error(
                "KRL0112",
                name.span,
                format!("{} has no constant #{}", kind.name, name.text),
            );
            let shown: Vec<_> = kind.constants.iter().map(|c| format!("#{c}")).collect();
            let help = match nearest_name(&name.text, kind.constants.iter().cloned()) {
                Some(near) => format!("did you mean #{near}?"),
                None => format!("it has {}", shown.join(", ")),
            };
            self.error(diagnostic.help(help));
            return None;
        }
        let all = self.types.enums.iter().enumerate();
        let found: Vec<_> = all.filter_map(|(i, kind)| Some((i, find(kind)?))).collect();
        if let [(index, at), ..] = found.as_slice() {
            // Where several enumerations have it, the first is as good as any other: the types are compared.
            return Some((*at as i64 + 1, Type::Enum(*index)));
        }
        let mut diagnostic = Diagnostic::error(
            "KRL0112",
            name.span,
            format!("no enumeration has a constant #{}", name.text),
        );
        let names = self
            .types
            .enums
            .iter()
            .flat_map(|kind| kind.constants.clone());
        if let Some(near) = nearest_name(&name.text, names) {
            diagnostic = diagnostic.help(format!("did you mean #{near}?"));
        }
        self.error(diagnostic);
        None
    }
}
