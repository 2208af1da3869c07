use depal_syntax::{Diagnostic, Span};
use depal_vm::{BinaryOp, Op};

use super::scope::Compiler;
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    pub(super) fn binary(
        &mut self,
        operator: Operator,
        left: &Expression,
        right: &Expression,
        expected: Option<&Type>,
    ) -> Type {
        if matches!(operator, Operator::And | Operator::Or | Operator::Xor) {
            return self.logical(operator, left, right);
        }
        let comparison = matches!(
            operator,
            Operator::Equal
                | Operator::NotEqual
                | Operator::Less
                | Operator::LessOrEqual
                | Operator::Greater
                | Operator::GreaterOrEqual
        );
        let hint = expected.filter(|t| !comparison && matches!(t, Type::Num | Type::Dnum));
        let begin = self.body.code.len();
        let left_hint = hint.filter(|_| is_literal_number(left));
        let left_aggregate = matches!(left.kind, ExpressionKind::Aggregate(_));
        let mut left_kind = if left_aggregate {
            self.value(left, expected)
        } else {
            self.value(left, left_hint)
        };
        let middle = self.body.code.len();
        let right_hint =
            if is_literal_number(right) || matches!(right.kind, ExpressionKind::Aggregate(_)) {
                Some(left_kind.clone())
                    .filter(|t| *t != Type::Broken && *t != Type::Text && *t != Type::Bool)
            } else {
                None
            };
        // A number times a literal record, a record times a literal number: no hint for the number.
        let right_hint =
            right_hint.filter(|t| !is_literal_number(right) || matches!(t, Type::Num | Type::Dnum));
        let right_kind = self.value(right, right_hint.as_ref());
        if right_kind == Type::Dnum && left_kind == Type::Num && is_literal_number(left) {
            // Literals take the width of the other side; their code has the same length in both.
            let tail = self.body.code.split_off(middle);
            self.body.code.truncate(begin);
            left_kind = self.value(left, Some(&Type::Dnum));
            self.body.code.extend(tail);
        }
        self.operation(operator, &left_kind, &right_kind, left.span.to(right.span))
    }

    pub(super) fn operation(
        &mut self,
        operator: Operator,
        left: &Type,
        right: &Type,
        span: Span,
    ) -> Type {
        let op = match operator {
            Operator::Add => BinaryOp::Add,
            Operator::Subtract => BinaryOp::Subtract,
            Operator::Multiply => BinaryOp::Multiply,
            Operator::Divide => BinaryOp::Divide,
            Operator::Div => BinaryOp::IntegerDivide,
            Operator::Mod => BinaryOp::Remainder,
            Operator::Equal => BinaryOp::Equal,
            Operator::NotEqual => BinaryOp::NotEqual,
            Operator::Less => BinaryOp::Less,
            Operator::LessOrEqual => BinaryOp::LessOrEqual,
            Operator::Greater => BinaryOp::Greater,
            Operator::GreaterOrEqual => BinaryOp::GreaterOrEqual,
            Operator::And => BinaryOp::And,
            Operator::Or => BinaryOp::Or,
            Operator::Xor => BinaryOp::Xor,
        };
        if *left == Type::Broken || *right == Type::Broken {
            self.emit(Op::Binary(op));
            return match operator {
                Operator::Add
                | Operator::Subtract
                | Operator::Multiply
                | Operator::Divide
                | Operator::Div
                | Operator::Mod => Type::Broken,
                _ => Type::Bool,
            };
        }
        match operator {
            Operator::Equal | Operator::NotEqual if left.accepts(right) => {
                if !matches!(left, Type::Socket | Type::Clock | Type::Raw) {
                    self.emit(Op::Binary(op));
                    return Type::Bool;
                }
            }
            Operator::Less
            | Operator::LessOrEqual
            | Operator::Greater
            | Operator::GreaterOrEqual
                if left == right && left.is_number() =>
            {
                self.emit(Op::Binary(op));
                return Type::Bool;
            }
            Operator::Add if *left == Type::Text && *right == Type::Text => {
                self.emit(Op::Binary(op));
                return Type::Text;
            }
            Operator::Add
            | Operator::Subtract
            | Operator::Multiply
            | Operator::Divide
            | Operator::Div
            | Operator::Mod
                if left == right && left.is_number() =>
            {
                self.emit(Op::Binary(op));
                return left.clone();
            }
            _ => {
                if let Some((builtin, kind)) = self.record_operation(operator, left, right) {
                    self.emit(Op::CallBuiltin {
                        builtin,
                        arguments: 2,
                        result: true,
                    });
                    return kind;
                }
            }
        }
        let (a, b) = (self.type_name(left), self.type_name(right));
        let mut diagnostic = Diagnostic::error(
            "RAPID0104",
            span,
            format!("{} does not take {a} and {b}", operator.text()),
        );
        if matches!(
            (left, right),
            (Type::Num, Type::Dnum) | (Type::Dnum, Type::Num)
        ) {
            diagnostic = diagnostic.help("convert one side with NumToDnum(..) or DnumToNum(..)");
        }
        self.error(diagnostic);
        Type::Broken
    }

    /// Sums and products of positions and orientations are built-ins with names that no program can write.
    pub(super) fn record_operation(
        &self,
        operator: Operator,
        left: &Type,
        right: &Type,
    ) -> Option<(u32, Type)> {
        let name = match operator {
            Operator::Add => "+",
            Operator::Subtract => "-",
            Operator::Multiply => "*",
            Operator::Divide => "/",
            _ => return None,
        };
        let (a, b) = (self.type_name(left), self.type_name(right));
        let index = self.table.operator(&format!("{a} {name} {b}"))?;
        let result = if matches!(left, Type::Record(_)) {
            left.clone()
        } else {
            right.clone()
        };
        Some((index, result))
    }

    pub(super) fn logical(
        &mut self,
        operator: Operator,
        left: &Expression,
        right: &Expression,
    ) -> Type {
        self.value(left, Some(&Type::Bool));
        let skip = if crate::rules::SHORT_CIRCUIT {
            match operator {
                Operator::And => Some(self.emit(Op::JumpIfFalseKeep(0))),
                Operator::Or => Some(self.emit(Op::JumpIfTrueKeep(0))),
                _ => None,
            }
        } else {
            None
        };
        self.value(right, Some(&Type::Bool));
        self.emit(Op::Binary(match operator {
            Operator::And => BinaryOp::And,
            Operator::Or => BinaryOp::Or,
            _ => BinaryOp::Xor,
        }));
        if let Some(skip) = skip {
            self.patch_here(skip);
        }
        Type::Bool
    }
}

fn is_literal_number(expression: &Expression) -> bool {
    match &expression.kind {
        ExpressionKind::Number { .. } => true,
        ExpressionKind::Negate(inner) => is_literal_number(inner),
        ExpressionKind::Binary(operator, left, right) => {
            matches!(
                operator,
                Operator::Add | Operator::Subtract | Operator::Multiply | Operator::Divide
            ) && is_literal_number(left)
                && is_literal_number(right)
        }
        _ => false,
    }
}
