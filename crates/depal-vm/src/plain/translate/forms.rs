use super::{Entry, NotPlain, Translator};
use crate::operators::{BinaryOp, UnaryOp};
use crate::plain::{
    Arithmetic, CallSite, Comparison, Instruction, Kind, Logic, NONE, Operand, StatementMark,
};
use crate::{Op, Value};

impl Translator<'_> {
    /// Translates one operation; how many it covers.
    pub(super) fn operation(&mut self, pc: usize, op: &Op) -> Result<usize, NotPlain> {
        match op {
            Op::Statement { line, next } => {
                self.needs_empty_stack()?;
                let index = self.plain.statements.len() as u32;
                self.plain.statements.push(StatementMark {
                    pc: pc as u32,
                    line: *line,
                    next: *next,
                });
                self.emit(Instruction::Statement(index));
            }
            Op::Push(Value::Num(value)) => self.push(Operand::Constant(*value), Kind::Number),
            Op::Push(Value::Bool(value)) => {
                self.push(Operand::Constant(f32::from(u8::from(*value))), Kind::Truth);
            }
            Op::LoadLocal(slot) => self.push(Operand::Local(*slot), Kind::Variable),
            Op::LoadGlobal(slot) => self.push(Operand::Global(*slot), Kind::Variable),
            Op::PlaceLocal(slot) => self.stack.push(Entry::Place(Operand::Local(*slot))),
            Op::PlaceGlobal(slot) => self.stack.push(Entry::Place(Operand::Global(*slot))),
            Op::StoreLocal(slot) | Op::SetLocal(slot) => self.store(pc, Operand::Local(*slot))?,
            Op::StoreGlobal(slot) => self.store(pc, Operand::Global(*slot))?,
            Op::PlaceIndex(1) => self.place_index()?,
            Op::LoadPlace => match self.stack.pop() {
                Some(Entry::Place(variable)) => self.push(variable, Kind::Variable),
                Some(Entry::Element { array, index }) => {
                    let to = self.temporary()?;
                    self.emit(Instruction::LoadElement { to, array, index });
                    self.push(to, Kind::Number);
                }
                _ => return Err(NotPlain),
            },
            Op::StorePlace => self.store_place(pc)?,
            Op::Unary(UnaryOp::Negate) => {
                let value = self.pop_number()?;
                let to = self.temporary()?;
                self.emit(Instruction::Negate { to, value });
                self.push(to, Kind::Number);
            }
            Op::Unary(UnaryOp::Not) => {
                let value = self.pop_truth()?;
                let to = self.temporary()?;
                self.emit(Instruction::Not { to, value });
                self.push(to, Kind::Truth);
            }
            Op::Binary(op) => self.binary(*op)?,
            Op::Jump(target) => {
                self.needs_empty_stack()?;
                self.emit_jump(Instruction::Jump(0), *target);
            }
            Op::JumpIfFalse(target) => self.jump_if_false(pc, *target)?,
            Op::JumpIfFalseKeep(target) => self.keep(*target, false)?,
            Op::JumpIfTrueKeep(target) => self.keep(*target, true)?,
            Op::ForTest { slot, exit } => {
                self.needs_empty_stack()?;
                let test = Instruction::ForTest {
                    slot: *slot,
                    exit: 0,
                };
                self.emit_jump(test, *exit);
            }
            Op::ForStep { slot } => {
                self.needs_empty_stack()?;
                return Ok(self.for_step(pc, *slot));
            }
            Op::Call { routine, arguments } => self.call(pc, *routine, *arguments as usize)?,
            Op::Return { value: false } => {
                self.needs_empty_stack()?;
                self.emit(Instruction::Return);
            }
            Op::Return { value: true } => {
                let (value, kind) = self.pop_value()?;
                self.needs_empty_stack()?;
                self.emit(Instruction::ReturnValue { value, kind });
            }
            _ => return Err(NotPlain),
        }
        Ok(1)
    }

    /// What lies on the stack goes onto that of the frame, the topmost values as arguments.
    fn call(&mut self, pc: usize, routine: u32, arguments: usize) -> Result<(), NotPlain> {
        let below = self.stack.len().checked_sub(arguments).ok_or(NotPlain)?;
        // A jump over the call would come from where its truth value is not on the operand stack.
        if self.short_cut {
            return Err(NotPlain);
        }
        let value = |entry: &Entry| match entry {
            Entry::Value(operand, kind) => Ok((*operand, *kind)),
            _ => Err(NotPlain),
        };
        let values: Result<Vec<_>, _> = self.stack.iter().map(value).collect();
        let mut values = values?;
        let arguments = values.split_off(below);
        let is_kept =
            |(i, (operand, _)): &(usize, &(Operand, Kind))| *operand == Operand::Stacked(*i as u32);
        let kept = values.iter().enumerate().take_while(is_kept).count();
        let index = self.plain.calls.len() as u32;
        self.plain.calls.push(CallSite {
            routine,
            kept,
            spilled: values.split_off(kept),
            arguments,
            next: pc as u32 + 1,
        });
        self.emit(Instruction::Call(index));
        let left = below + usize::from(self.yields[routine as usize]);
        let stacked = |i| Entry::Value(Operand::Stacked(i as u32), Kind::Variable);
        self.stack = (0..left).map(stacked).collect();
        self.called = true;
        Ok(())
    }

    /// A step, with the jump to the loop's beginning if that is as the lowering makes it.
    fn for_step(&mut self, pc: usize, slot: u32) -> usize {
        if let Some(Op::Jump(top)) = self.code.get(pc + 1)
            && !self.is_target[pc + 1]
            && let Some(Op::ForTest { slot: tested, exit }) = self.code.get(*top as usize + 1)
            && *tested == slot
            && *top < pc as u32
            && let begin = self.plain.at[*top as usize]
            && begin != NONE
            && let Some(Instruction::Statement(statement)) =
                self.plain.instructions.get(begin as usize)
        {
            let next = Instruction::ForNext {
                slot,
                statement: *statement,
                body: self.plain.at[*top as usize + 1] + 1,
                exit: 0,
            };
            self.emit_jump(next, *exit);
            return 2;
        }
        self.emit(Instruction::ForStep { slot });
        1
    }

    fn place_index(&mut self) -> Result<(), NotPlain> {
        let index = self.pop_number()?;
        let Some(Entry::Place(array)) = self.stack.pop() else {
            return Err(NotPlain);
        };
        // An index that was computed is kept in the second temporary of its array's level.
        let index = if let Operand::Temporary(_) = index {
            let Operand::Temporary(base) = self.temporary()? else {
                return Err(NotPlain);
            };
            let kept = Operand::Temporary(base + 1);
            self.emit(Instruction::Set {
                to: kept,
                value: index,
            });
            kept
        } else {
            index
        };
        self.stack.push(Entry::Element { array, index });
        Ok(())
    }

    fn store_place(&mut self, pc: usize) -> Result<(), NotPlain> {
        let (value, kind) = self.pop_value()?;
        match self.stack.pop() {
            Some(Entry::Place(variable)) => {
                self.push(value, kind);
                self.store(pc, variable)
            }
            Some(Entry::Element { array, index }) if kind != Kind::Truth => {
                self.needs_empty_stack()?;
                self.emit(Instruction::StoreElement {
                    array,
                    index,
                    value,
                });
                Ok(())
            }
            _ => Err(NotPlain),
        }
    }

    fn store(&mut self, pc: usize, to: Operand) -> Result<(), NotPlain> {
        let (value, kind) = self.pop_value()?;
        self.needs_empty_stack()?;
        match kind {
            Kind::Number => {
                let last = self.plain.instructions.last_mut();
                if let (Operand::Temporary(_), false, Some(last)) =
                    (value, self.is_target[pc], last)
                    && let Some(destination) = number_destination(last)
                    && *destination == value
                {
                    *destination = to;
                } else {
                    self.emit(Instruction::Set { to, value });
                }
            }
            Kind::Truth => self.emit(Instruction::SetTruth { to, value }),
            Kind::Variable => self.emit(Instruction::Copy { to, value }),
        }
        Ok(())
    }

    fn binary(&mut self, op: BinaryOp) -> Result<(), NotPlain> {
        if let BinaryOp::And | BinaryOp::Or | BinaryOp::Xor = op {
            let (right, left) = (self.pop_truth()?, self.pop_truth()?);
            let to = self.temporary()?;
            let op = match op {
                BinaryOp::And => Logic::And,
                BinaryOp::Or => Logic::Or,
                _ => Logic::Xor,
            };
            self.emit(Instruction::Logic {
                op,
                to,
                left,
                right,
            });
            self.push(to, Kind::Truth);
            return Ok(());
        }
        let (right, left) = (self.pop_number()?, self.pop_number()?);
        let to = self.temporary()?;
        let arithmetic = |op| Instruction::Arithmetic {
            op,
            to,
            left,
            right,
        };
        let compare = |test| Instruction::Compare {
            test,
            to,
            left,
            right,
        };
        let instruction = match op {
            BinaryOp::Add => Instruction::Add { to, left, right },
            BinaryOp::Subtract => arithmetic(Arithmetic::Subtract),
            BinaryOp::Multiply => arithmetic(Arithmetic::Multiply),
            BinaryOp::Divide => arithmetic(Arithmetic::Divide),
            BinaryOp::IntegerDivide => arithmetic(Arithmetic::IntegerDivide),
            BinaryOp::Remainder => arithmetic(Arithmetic::Remainder),
            BinaryOp::Equal => compare(Comparison::Equal),
            BinaryOp::NotEqual => compare(Comparison::NotEqual),
            BinaryOp::Less => compare(Comparison::Less),
            BinaryOp::LessOrEqual => compare(Comparison::LessOrEqual),
            BinaryOp::Greater => compare(Comparison::Greater),
            BinaryOp::GreaterOrEqual => compare(Comparison::GreaterOrEqual),
            BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => return Err(NotPlain),
        };
        self.emit(instruction);
        let truth = matches!(instruction, Instruction::Compare { .. });
        self.push(to, if truth { Kind::Truth } else { Kind::Number });
        Ok(())
    }

    fn jump_if_false(&mut self, pc: usize, target: u32) -> Result<(), NotPlain> {
        let value = self.pop_truth()?;
        self.needs_empty_stack()?;
        if let Some(Instruction::Compare {
            test,
            to,
            left,
            right,
        }) = self.plain.instructions.last().copied()
            && to == value
            && !self.is_target[pc]
        {
            self.plain.instructions.pop();
            self.plain.resume.pop();
            // What was marked to begin at the comparison begins there still.
            let jump = Instruction::JumpUnless {
                test,
                left,
                right,
                target: 0,
            };
            self.emit_jump(jump, target);
        } else {
            self.emit_jump(Instruction::JumpIfFalse { value, target: 0 }, target);
        }
        Ok(())
    }

    /// A jump that leaves its truth value: at the target both ways have it in the same temporary.
    fn keep(&mut self, target: u32, when: bool) -> Result<(), NotPlain> {
        let operand = self.pop_truth()?;
        let value = self.temporary()?;
        if operand != value {
            self.emit(Instruction::SetTruth {
                to: value,
                value: operand,
            });
        }
        let jump = if when {
            Instruction::JumpIfTrue { value, target: 0 }
        } else {
            Instruction::JumpIfFalse { value, target: 0 }
        };
        self.emit_jump(jump, target);
        self.push(value, Kind::Truth);
        self.short_cut = true;
        Ok(())
    }
}

fn number_destination(instruction: &mut Instruction) -> Option<&mut Operand> {
    match instruction {
        Instruction::Add { to, .. }
        | Instruction::Arithmetic { to, .. }
        | Instruction::Negate { to, .. }
        | Instruction::LoadElement { to, .. } => Some(to),
        _ => None,
    }
}
