use depal_syntax::{Diagnostic, Span};
use depal_vm::{BinaryOp, Op, UnaryOp, Value};

use super::scope::Compiler;
use super::types::*;
use crate::syntax::tree::*;

impl Compiler<'_> {
    /// Both sides are always computed: expressions have no jumps, so that operations can be put in between.
    pub(super) fn binary(
        &mut self,
        operator: Operator,
        left: &Expression,
        right: &Expression,
    ) -> Type {
        use Operator::{
            Add, And, BitAnd, BitExor, BitOr, Divide, Equal, Exor, Frame, Greater, GreaterOrEqual,
            Less, LessOrEqual, Multiply, NotEqual, Or, Subtract,
        };
        match operator {
            And | Or | Exor => {
                for side in [left, right] {
                    self.warn_about_order(operator, side);
                    self.value(side, Some(&Type::Bool));
                }
                self.emit(Op::Binary(match operator {
                    And => BinaryOp::And,
                    Or => BinaryOp::Or,
                    _ => BinaryOp::Xor,
                }));
                Type::Bool
            }
            BitAnd | BitOr | BitExor => {
                self.value(left, Some(&Type::Int));
                self.value(right, Some(&Type::Int));
                self.emit(Op::Binary(match operator {
                    BitAnd => BinaryOp::BitAnd,
                    BitOr => BinaryOp::BitOr,
                    _ => BinaryOp::BitXor,
                }));
                Type::Int
            }
            Frame => self.frame_product(left, right),
            Equal | NotEqual | Less | LessOrEqual | Greater | GreaterOrEqual => {
                self.comparison(operator, left, right);
                Type::Bool
            }
            Add | Subtract | Multiply | Divide => {
                let kind = self.numbers(operator, left, right);
                self.emit(Op::Binary(match operator {
                    Add => BinaryOp::Add,
                    Subtract => BinaryOp::Subtract,
                    Multiply => BinaryOp::Multiply,
                    _ => BinaryOp::Divide,
                }));
                kind
            }
        }
    }

    /// The manual's table has comparisons below AND and OR.
    fn warn_about_order(&mut self, operator: Operator, side: &Expression) {
        if let ExpressionKind::Binary(inner, ..) = &side.kind
            && inner.is_comparison()
        {
            self.error(
                Diagnostic::warning(
                    "KRL0130",
                    side.span,
                    format!(
                        "this comparison beside {} has no parentheses",
                        operator.text()
                    ),
                )
                .label("taken as if it stood in parentheses")
                .help("put it in parentheses: by the manual AND, EXOR and OR bind tighter than comparisons"),
            );
        }
    }

    /// Two numbers of one type.
    fn numbers(&mut self, operator: Operator, left: &Expression, right: &Expression) -> Type {
        let a = self.value(left, None);
        let between = self.body.code.len();
        let b = self.value(right, None);
        for (side, kind) in [(left, &a), (right, &b)] {
            if !kind.is_number() {
                self.operand_error(side.span, operator.text(), kind);
                return Type::Broken;
            }
        }
        self.same_numbers(&a, &b, between)
    }

    /// Makes both REAL if one is. The left one lies below; its operation goes to `between`.
    fn same_numbers(&mut self, a: &Type, b: &Type, between: usize) -> Type {
        match (a, b) {
            (Type::Broken, _) | (_, Type::Broken) => Type::Broken,
            (Type::Real, Type::Real) => Type::Real,
            (Type::Real, _) => {
                self.emit(Op::Unary(UnaryOp::ToNum));
                Type::Real
            }
            (_, Type::Real) => {
                self.body.code.insert(between, Op::Unary(UnaryOp::ToNum));
                Type::Real
            }
            _ => Type::Int,
        }
    }

    fn comparison(&mut self, operator: Operator, left: &Expression, right: &Expression) {
        let op = match operator {
            Operator::Equal => BinaryOp::Equal,
            Operator::NotEqual => BinaryOp::NotEqual,
            Operator::Less => BinaryOp::Less,
            Operator::LessOrEqual => BinaryOp::LessOrEqual,
            Operator::Greater => BinaryOp::Greater,
            _ => BinaryOp::GreaterOrEqual,
        };
        let begin = self.body.code.len();
        // A constant of an enumeration gets its type from the other side.
        let a = if let ExpressionKind::Constant(_) = left.kind {
            self.emit(Op::Push(Value::Unset));
            None
        } else {
            Some(self.value(left, None))
        };
        let between = self.body.code.len();
        let expected = a
            .clone()
            .filter(|a| matches!(a, Type::Enum(_) | Type::Char));
        let b = self.any_value(right, expected.as_ref());
        let a = match (a, &left.kind) {
            (Some(a), _) => a,
            (None, ExpressionKind::Constant(name)) => {
                let known = Some(&b).filter(|b| matches!(b, Type::Enum(_)));
                match self.enum_constant(name, known) {
                    Some((index, kind)) => {
                        self.body.code[begin] = Op::Push(Value::Int(index));
                        kind
                    }
                    None => Type::Broken,
                }
            }
            _ => Type::Broken,
        };
        // A text of one character beside a CHAR on its right.
        if let (ExpressionKind::Text(text), Type::Char) = (&left.kind, &b)
            && let (Value::Array(items), 1) = (codes(text), text.chars().count())
        {
            self.body.code[begin] = Op::Push(items[0].clone());
            self.emit(Op::Binary(op));
            return;
        }
        if a.is_number() && b.is_number() {
            self.same_numbers(&a, &b, between);
        } else if !comparable(operator, &a, &b) {
            let (a, b) = (self.type_name(&a), self.type_name(&b));
            let span = left.span.to(right.span);
            self.error(Diagnostic::error(
                "KRL0104",
                span,
                format!("{} does not compare {a} with {b}", operator.text()),
            ));
        }
        self.emit(Op::Binary(op));
    }

    /// `a:b`, of the type of the right side.
    fn frame_product(&mut self, left: &Expression, right: &Expression) -> Type {
        let a = self.value(left, None);
        let b = self.value(right, None);
        let ok = |this: &Self, kind: &Type, span: Span| {
            (this.types.family(kind) != Some(Family::Pose) && *kind != Type::Broken)
                .then_some((span, kind.clone()))
        };
        let wrong = [ok(self, &a, left.span), ok(self, &b, right.span)];
        if let Some((span, kind)) = wrong.into_iter().flatten().next() {
            self.operand_error(span, "the frame operator `:`", &kind);
            return Type::Broken;
        }
        self.emit_builtin("frame product", 2, true);
        b
    }
}

/// Whether values that are no numbers may be compared.
fn comparable(operator: Operator, a: &Type, b: &Type) -> bool {
    if *a == Type::Broken || *b == Type::Broken {
        return true;
    }
    match a {
        Type::Enum(_) => a == b,
        Type::Bool => a == b && matches!(operator, Operator::Equal | Operator::NotEqual),
        _ => false,
    }
}
