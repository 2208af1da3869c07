use super::generate::{Number, Statement, Truth};
use crate::{BinaryOp, Op, UnaryOp, Value};

/// Lowers as a language does.
#[derive(Default)]
pub(super) struct Lowering {
    pub(super) code: Vec<Op>,
    pub(super) locals: Vec<Value>,
}

impl Lowering {
    pub(super) fn emit(&mut self, op: Op) -> usize {
        self.code.push(op);
        self.code.len() - 1
    }

    fn patch(&mut self, at: usize) {
        let here = self.code.len() as u32;
        match &mut self.code[at] {
            Op::Jump(target)
            | Op::JumpIfFalse(target)
            | Op::JumpIfFalseKeep(target)
            | Op::JumpIfTrueKeep(target)
            | Op::Statement { next: target, .. }
            | Op::ForTest { exit: target, .. } => *target = here,
            _ => unreachable!(),
        }
    }

    fn same_text(&mut self) {
        self.emit(Op::Push(Value::Str("a".into())));
        self.emit(Op::Push(Value::Str("a".into())));
        self.emit(Op::Binary(BinaryOp::Equal));
    }

    fn number(&mut self, number: &Number) {
        match number {
            Number::Constant(value) => {
                self.emit(Op::Push(Value::Num(f32::from(*value) / 4.0)));
            }
            Number::Global(slot) => {
                self.emit(Op::LoadGlobal(*slot));
            }
            Number::Local(slot) => {
                self.emit(Op::LoadLocal(*slot));
            }
            Number::Element(index) => {
                self.emit(Op::PlaceGlobal(3));
                self.number(index);
                self.emit(Op::PlaceIndex(1));
                self.emit(Op::LoadPlace);
            }
            Number::Negate(inner) => {
                self.number(inner);
                self.emit(Op::Unary(UnaryOp::Negate));
            }
            Number::Binary(op, left, right) => {
                self.number(left);
                self.number(right);
                self.emit(Op::Binary(*op));
            }
            Number::Call(inner) | Number::Recursion(inner) => {
                self.number(inner);
                let routine = if matches!(number, Number::Call(_)) {
                    1
                } else {
                    2
                };
                self.emit(Op::Call {
                    routine,
                    arguments: 1,
                });
            }
            Number::FromText => {
                self.same_text();
                let no = self.emit(Op::JumpIfFalse(0));
                self.emit(Op::Push(Value::Num(1.0)));
                let over = self.emit(Op::Jump(0));
                self.patch(no);
                self.emit(Op::Push(Value::Num(0.0)));
                self.patch(over);
            }
        }
    }

    fn short_cut(&mut self, left: &Truth, right: &Truth, jump: Op, op: BinaryOp) {
        self.truth(left);
        let skip = self.emit(jump);
        self.truth(right);
        self.emit(Op::Binary(op));
        self.patch(skip);
    }

    fn truth(&mut self, truth: &Truth) {
        match truth {
            Truth::Constant(value) => {
                self.emit(Op::Push(Value::Bool(*value)));
            }
            Truth::Global => {
                self.emit(Op::LoadGlobal(4));
            }
            Truth::Local => {
                self.emit(Op::LoadLocal(3));
            }
            Truth::Compare(op, left, right) => {
                self.number(left);
                self.number(right);
                self.emit(Op::Binary(*op));
            }
            Truth::Not(inner) => {
                self.truth(inner);
                self.emit(Op::Unary(UnaryOp::Not));
            }
            Truth::And(a, b) => self.short_cut(a, b, Op::JumpIfFalseKeep(0), BinaryOp::And),
            Truth::Or(a, b) => self.short_cut(a, b, Op::JumpIfTrueKeep(0), BinaryOp::Or),
            Truth::Xor(a, b) => {
                self.truth(a);
                self.truth(b);
                self.emit(Op::Binary(BinaryOp::Xor));
            }
            Truth::SameText => self.same_text(),
        }
    }

    pub(super) fn begin(&mut self) -> usize {
        let line = self.code.len() as u32 + 1;
        self.emit(Op::Statement { line, next: 0 })
    }

    pub(super) fn block(&mut self, statements: &[Statement]) {
        for statement in statements {
            let begin = self.begin();
            self.statement(statement);
            self.patch(begin);
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::SetGlobal(slot, value) => {
                self.number(value);
                self.emit(Op::StoreGlobal(*slot));
            }
            Statement::SetLocal(slot, value) => {
                self.number(value);
                self.emit(Op::StoreLocal(*slot));
            }
            Statement::SetElement(index, value) => {
                self.emit(Op::PlaceGlobal(3));
                self.number(index);
                self.emit(Op::PlaceIndex(1));
                self.number(value);
                self.emit(Op::StorePlace);
            }
            Statement::SetTruth(global, value) => {
                self.truth(value);
                self.emit(if *global {
                    Op::StoreGlobal(4)
                } else {
                    Op::StoreLocal(3)
                });
            }
            Statement::Copy(numbers) => {
                let (from, to) = if *numbers { (1, 0) } else { (4, 3) };
                self.emit(Op::LoadGlobal(from));
                self.emit(Op::StoreLocal(to));
            }
            Statement::If(condition, yes, no) => {
                self.truth(condition);
                let skip = self.emit(Op::JumpIfFalse(0));
                self.block(yes);
                let over = self.emit(Op::Jump(0));
                self.patch(skip);
                self.block(no);
                self.patch(over);
            }
            Statement::For(start, step, body) => self.counting(start, *step, body),
            Statement::Text => {
                self.emit(Op::Push(Value::Str("text".into())));
                self.emit(Op::Pop);
            }
            Statement::Call(value) => {
                self.number(value);
                self.emit(Op::Call {
                    routine: 1,
                    arguments: 1,
                });
                self.emit(Op::StoreGlobal(0));
            }
            Statement::Procedure(value, truth) => {
                self.number(value);
                self.truth(truth);
                self.emit(Op::Call {
                    routine: 3,
                    arguments: 2,
                });
            }
        }
    }

    fn counting(&mut self, start: &Number, step: i8, body: &[Statement]) {
        let slot = self.locals.len() as u32;
        self.locals.extend(vec![Value::Num(0.0); 3]);
        // Five times round at most, from a start that an expression gives.
        self.number(start);
        self.number(start);
        self.emit(Op::Push(Value::Num(f32::from(step) * 4.0)));
        self.emit(Op::Binary(BinaryOp::Add));
        if step != 0 {
            self.emit(Op::Push(Value::Num(f32::from(step))));
        }
        self.emit(Op::ForBegin {
            slot,
            stepped: step != 0,
        });
        let first = self.emit(Op::Jump(0));
        let top = self.begin();
        self.patch(first);
        let test = self.emit(Op::ForTest { slot, exit: 0 });
        self.block(body);
        self.emit(Op::ForStep { slot });
        self.emit(Op::Jump(top as u32));
        self.patch(test);
        self.patch(top);
    }
}
