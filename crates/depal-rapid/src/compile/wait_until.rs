use depal_vm::{BinaryOp, Op, Value};

use super::scope::{Compiler, Signature};
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    /// `WaitUntil` evaluates its condition anew each time it is asked.
    pub(super) fn wait_until(
        &mut self,
        signature: &Signature,
        name: &Name,
        arguments: &[Argument],
    ) {
        let matched = self.match_arguments(signature, name, arguments);
        let given = |key: &str| {
            let index = signature.parameters.iter().position(|p| p.key == key)?;
            matched[index]
        };
        let value = |argument: Option<&Argument>| match argument {
            Some(
                Argument::Positional(value)
                | Argument::Named {
                    value: Some(value), ..
                },
            ) => Some(value.clone()),
            _ => None,
        };
        let in_position = given("inpos").is_some() || given("zerospeed").is_some();
        let condition = value(given("cond"));
        let max_time = value(given("maxtime"));
        let time_flag = value(given("timeflag"));
        let limit = max_time.map(|max_time| {
            let slot = self.new_local(Value::Num(0.0));
            self.value(&max_time, Some(&Type::Num));
            self.emit(Op::SetLocal(slot));
            slot
        });
        self.emit(Op::WaitBegin);
        let again = self.here();
        if in_position && let Some(builtin) = self.table.operator("standing") {
            self.emit(Op::CallBuiltin {
                builtin,
                arguments: 0,
                result: true,
            });
        } else {
            self.emit(Op::Push(Value::Bool(true)));
        }
        let moving = self.emit(Op::JumpIfFalseKeep(0));
        if let Some(condition) = condition {
            self.value(&condition, Some(&Type::Bool));
        } else {
            self.emit(Op::Push(Value::Bool(true)));
        }
        self.emit(Op::Binary(BinaryOp::And));
        self.patch_here(moving);
        let waiting = self.emit(Op::JumpIfFalse(0));
        if let Some(flag) = &time_flag {
            self.store(flag, false);
        }
        let over = self.emit(Op::Jump(0));
        self.patch_here(waiting);
        let mut ends = vec![over];
        if let Some(slot) = limit {
            self.emit(Op::WaitElapsed);
            self.emit(Op::LoadLocal(slot));
            self.emit(Op::Unary(depal_vm::UnaryOp::ToDnum));
            self.emit(Op::Binary(BinaryOp::GreaterOrEqual));
            let not_yet = self.emit(Op::JumpIfFalse(0));
            if let Some(flag) = &time_flag {
                self.store(flag, true);
                ends.push(self.emit(Op::Jump(0)));
            } else {
                let error = crate::errors::error(
                    "ERR_WAIT_MAXTIME",
                    "the condition of WaitUntil did not come true within \\MaxTime",
                );
                self.emit(Op::RaiseError(Box::new(error)));
            }
            self.patch_here(not_yet);
        }
        self.emit(Op::Block(again));
        for end in ends {
            self.patch_here(end);
        }
    }

    pub(super) fn store(&mut self, target: &Expression, value: bool) {
        let kind = self.place(target);
        if !Type::Bool.accepts(&kind) {
            self.mismatch(target.span, &Type::Bool, &kind);
        }
        self.emit(Op::Push(Value::Bool(value)));
        self.emit(Op::StorePlace);
    }
}
