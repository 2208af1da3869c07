//! Values that are known when the program is made: initial values and sizes.

use depal_syntax::Diagnostic;
use depal_vm::Value;

use super::scope::*;
use super::types::*;
use crate::syntax::tree::*;

impl Compiler<'_> {
    /// The value of an expression for a variable of this type; `None` (reported) if it is not constant.
    pub(super) fn constant(&mut self, expression: &Expression, expected: &Type) -> Option<Value> {
        if *expected == Type::Broken {
            return None;
        }
        let (value, found) = self.constant_value(expression, expected)?;
        if !self.types.accepts(expected, &found) {
            self.mismatch(expression.span, expected, &found);
            return None;
        }
        Some(match (expected, value) {
            (Type::Real, Value::Int(value)) => Value::Num(value as f32),
            (Type::Int | Type::Char, Value::Num(value)) => {
                Value::Int(f64::from(value).round() as i64)
            }
            (Type::Array { sizes, .. }, Value::Array(mut items)) if expected.is_text() => {
                let size = sizes[0];
                if size > 0 && items.len() > size {
                    self.error(Diagnostic::error(
                        "KRL0121",
                        expression.span,
                        format!("the string has {} characters, {size} fit", items.len()),
                    ));
                    return None;
                }
                items.resize(size.max(items.len()), Value::Unset);
                Value::Array(items)
            }
            (_, value) => value,
        })
    }

    fn constant_value(
        &mut self,
        expression: &Expression,
        expected: &Type,
    ) -> Option<(Value, Type)> {
        Some(match &expression.kind {
            ExpressionKind::Integer(value) => {
                if *value > i64::from(i32::MAX) {
                    self.too_large(expression.span, *value);
                }
                (Value::Int(*value), Type::Int)
            }
            ExpressionKind::Real(value) => (Value::Num(*value as f32), Type::Real),
            ExpressionKind::Bool(value) => (Value::Bool(*value), Type::Bool),
            ExpressionKind::Text(text) => match (expected, text.chars().count()) {
                (Type::Char, 1) => {
                    let Value::Array(mut items) = codes(text) else {
                        return None;
                    };
                    (items.remove(0), Type::Char)
                }
                (_, count) => (codes(text), Type::text(count)),
            },
            ExpressionKind::Constant(name) => {
                let (index, kind) = self.enum_constant(name, Some(expected))?;
                (Value::Int(index), kind)
            }
            ExpressionKind::Group(inner) => self.constant_value(inner, expected)?,
            ExpressionKind::Negate(inner) => match (&inner.kind, expected) {
                (ExpressionKind::Integer(value), _) => {
                    if -*value < i64::from(i32::MIN) {
                        self.too_large(expression.span, -*value);
                    }
                    (Value::Int(-*value), Type::Int)
                }
                _ => match self.constant_value(inner, expected)? {
                    (Value::Int(value), _) => (Value::Int(-value), Type::Int),
                    (Value::Num(value), _) => (Value::Num(-value), Type::Real),
                    (_, found) => {
                        self.mismatch(inner.span, &Type::Real, &found);
                        return None;
                    }
                },
            },
            ExpressionKind::Aggregate { type_name, fields } => {
                let kind = self.aggregate_type(type_name.as_ref(), fields, Some(expected));
                let Type::Struc(index) = kind else {
                    self.error(Diagnostic::error(
                        "KRL0104",
                        expression.span,
                        format!("components are given for {}", self.type_name(expected)),
                    ));
                    return None;
                };
                let Value::Record(mut values) = self.types.unset(&kind) else {
                    return None;
                };
                for field in fields {
                    let (at, field_type) = self.field(&Type::Struc(index), &field.name);
                    let value = self.constant(&field.value, &field_type);
                    if let (Some(place), Some(value)) = (values.get_mut(at as usize), value) {
                        *place = value;
                    }
                }
                (Value::Record(values), kind)
            }
            ExpressionKind::Name(name) => match self.lookup(&name.to_lowercase()).cloned() {
                Some(Symbol::Data(data)) if data.constant || data.span.file == u32::MAX => {
                    let Slot::Global(slot) = data.slot else {
                        return None;
                    };
                    (self.program.globals[slot as usize].clone(), data.kind)
                }
                Some(_) => {
                    self.not_constant(expression);
                    return None;
                }
                None => {
                    self.unknown_name(name, expression.span);
                    return None;
                }
            },
            ExpressionKind::Broken => return None,
            _ => {
                self.not_constant(expression);
                return None;
            }
        })
    }

    fn not_constant(&mut self, expression: &Expression) {
        self.error(
            Diagnostic::error(
                "KRL0109",
                expression.span,
                "a constant is needed here: a number, a string, components or a CONST",
            )
            .help("compute it in the program, or write the number"),
        );
    }

    pub(super) fn too_large(&mut self, span: depal_syntax::Span, value: i64) {
        self.error(
            Diagnostic::error(
                "KRL0006",
                span,
                format!("the integer {value} is outside -2147483648..2147483647"),
            )
            .help("write it with a decimal point to have a REAL"),
        );
    }
}
