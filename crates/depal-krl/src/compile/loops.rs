use depal_syntax::Span;
use depal_vm::{BinaryOp, MachineFault, Op, Value};

use super::scope::Compiler;
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    /// The body of a loop, which EXIT may leave.
    pub(super) fn looped(&mut self, body: &[Statement]) {
        self.body.exits.push(Vec::new());
        self.statements(body);
    }

    pub(super) fn end_loop(&mut self) {
        for exit in self.body.exits.pop().unwrap_or_default() {
            self.patch_here(exit);
        }
    }

    /// The end and the step are computed once.
    pub(super) fn for_statement(
        &mut self,
        span: Span,
        variable: &Expression,
        [from, to]: [&Expression; 2],
        step: Option<&Expression>,
        body: &[Statement],
    ) {
        if !self.is_place(variable) {
            self.place(variable);
            self.emit(Op::Pop);
            self.looped(body);
            self.end_loop();
            return;
        }
        self.assign(variable, from);
        let end = self.new_local(Value::Int(0));
        let by = self.new_local(Value::Int(1));
        self.value(to, Some(&Type::Int));
        self.emit(Op::SetLocal(end));
        let fixed = match step.map(|s| &s.kind) {
            None => Some(1),
            Some(ExpressionKind::Integer(step)) => Some(*step),
            Some(ExpressionKind::Negate(inner)) => match inner.kind {
                ExpressionKind::Integer(step) => Some(-step),
                _ => None,
            },
            _ => None,
        };
        if let Some(step) = step {
            self.value(step, Some(&Type::Int));
            self.emit(Op::SetLocal(by));
        }
        if fixed.is_none_or(|step| step == 0) {
            self.emit(Op::LoadLocal(by));
            self.emit(Op::Push(Value::Int(0)));
            self.emit(Op::Binary(BinaryOp::Equal));
            let moves = self.emit(Op::JumpIfFalse(0));
            self.emit(Op::Fault(Box::new(MachineFault::ZeroStep)));
            self.patch_here(moves);
        }
        let first = self.emit(Op::Jump(0));
        let top = self.begin(span);
        self.patch_here(first);
        let kind = self.any_value(variable, None);
        if !matches!(kind, Type::Int | Type::Broken) {
            self.mismatch(variable.span, &Type::Int, &kind);
        }
        self.emit(Op::LoadLocal(end));
        if let Some(step) = fixed {
            self.emit(Op::Binary(if step > 0 {
                BinaryOp::LessOrEqual
            } else {
                BinaryOp::GreaterOrEqual
            }));
        } else {
            // (value - end) * sign of the step <= 0
            self.emit(Op::Binary(BinaryOp::LessOrEqual));
            self.emit(Op::LoadLocal(by));
            self.emit(Op::Push(Value::Int(0)));
            self.emit(Op::Binary(BinaryOp::Greater));
            self.emit(Op::Binary(BinaryOp::And));
            self.any_value(variable, None);
            self.emit(Op::LoadLocal(end));
            self.emit(Op::Binary(BinaryOp::GreaterOrEqual));
            self.emit(Op::LoadLocal(by));
            self.emit(Op::Push(Value::Int(0)));
            self.emit(Op::Binary(BinaryOp::Less));
            self.emit(Op::Binary(BinaryOp::And));
            self.emit(Op::Binary(BinaryOp::Or));
        }
        let exit = self.emit(Op::JumpIfFalse(0));
        self.looped(body);
        self.place(variable);
        self.any_value(variable, None);
        self.emit(Op::LoadLocal(by));
        self.emit(Op::Binary(BinaryOp::Add));
        self.emit(Op::StorePlace);
        self.emit(Op::Jump(top as u32));
        self.patch_here(exit);
        self.patch_here(top);
        self.end_loop();
    }
}
