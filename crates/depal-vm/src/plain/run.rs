use super::{Arithmetic, Comparison, Instruction, Logic, Operand, PlainCode, TEMPORARIES};
use crate::Value;
use crate::memory::Frame;

/// The variables that instructions take their operands from.
struct Store<'a> {
    locals: &'a mut [Value],
    globals: &'a mut [Value],
    temporaries: [f32; TEMPORARIES],
}

impl Store<'_> {
    #[inline]
    fn number(&self, operand: Operand) -> Option<f32> {
        let value = match operand {
            Operand::Local(slot) => &self.locals[slot as usize],
            Operand::Global(slot) => &self.globals[slot as usize],
            Operand::Temporary(index) => {
                return Some(self.temporaries[index as usize % TEMPORARIES]);
            }
            Operand::Constant(value) => return Some(value),
        };
        match value {
            Value::Num(value) => Some(*value),
            _ => None,
        }
    }

    #[inline]
    fn truth(&self, operand: Operand) -> Option<bool> {
        let value = match operand {
            Operand::Local(slot) => &self.locals[slot as usize],
            Operand::Global(slot) => &self.globals[slot as usize],
            Operand::Temporary(index) => {
                return Some(self.temporaries[index as usize % TEMPORARIES] != 0.0);
            }
            Operand::Constant(value) => return Some(value != 0.0),
        };
        match value {
            Value::Bool(value) => Some(*value),
            _ => None,
        }
    }

    fn variable(&mut self, operand: Operand) -> Option<&mut Value> {
        match operand {
            Operand::Local(slot) => self.locals.get_mut(slot as usize),
            Operand::Global(slot) => self.globals.get_mut(slot as usize),
            Operand::Temporary(_) | Operand::Constant(_) => None,
        }
    }

    #[inline]
    fn set(&mut self, to: Operand, number: f32) -> Option<()> {
        let target = match to {
            Operand::Local(slot) => &mut self.locals[slot as usize],
            Operand::Global(slot) => &mut self.globals[slot as usize],
            Operand::Temporary(index) => {
                self.temporaries[index as usize % TEMPORARIES] = number;
                return Some(());
            }
            Operand::Constant(_) => return None,
        };
        match target {
            Value::Num(value) => {
                *value = number;
                Some(())
            }
            _ => None,
        }
    }

    #[inline]
    fn set_truth(&mut self, to: Operand, truth: bool) -> Option<()> {
        if let Operand::Temporary(index) = to {
            self.temporaries[index as usize % TEMPORARIES] = f32::from(u8::from(truth));
            return Some(());
        }
        match self.variable(to)? {
            Value::Bool(value) => {
                *value = truth;
                Some(())
            }
            _ => None,
        }
    }

    fn copy(&mut self, to: Operand, from: Operand) -> Option<()> {
        if let Some(number) = self.number(from) {
            return self.set(to, number);
        }
        let truth = self.truth(from)?;
        self.set_truth(to, truth)
    }

    fn element(&mut self, array: Operand, index: f32) -> Option<&mut f32> {
        let position = f64::from(index).round() - 1.0;
        let Some(Value::Array(items)) = self.variable(array) else {
            return None;
        };
        if !(0.0..items.len() as f64).contains(&position) {
            return None;
        }
        match &mut items[position as usize] {
            Value::Num(value) => Some(value),
            _ => None,
        }
    }

    /// Value, end and step of a counting loop.
    #[inline]
    fn counting(&mut self, slot: u32) -> Option<(&mut f32, f32, f32)> {
        let at = slot as usize;
        match self.locals.get_mut(at..at + 3) {
            Some([Value::Num(value), Value::Num(end), Value::Num(step)]) => {
                Some((value, *end, *step))
            }
            _ => None,
        }
    }
}

/// The general operators on numbers compute in f64 and round once. For these that is the same.
#[inline]
fn arithmetic(op: Arithmetic, a: f32, b: f32) -> Option<f32> {
    let (wide, divisor) = (f64::from(a), f64::from(b));
    Some(match op {
        Arithmetic::Subtract => a - b,
        Arithmetic::Multiply => a * b,
        _ if b == 0.0 => return None,
        Arithmetic::Divide => a / b,
        Arithmetic::IntegerDivide => (wide / divisor).trunc() as f32,
        Arithmetic::Remainder => (wide % divisor) as f32,
    })
}

#[inline]
fn holds(test: Comparison, a: f32, b: f32) -> bool {
    match test {
        Comparison::Equal => a == b,
        Comparison::NotEqual => a != b,
        Comparison::Less => a < b,
        Comparison::LessOrEqual => a <= b,
        Comparison::Greater => a > b,
        Comparison::GreaterOrEqual => a >= b,
    }
}

#[inline]
fn is_over(value: f32, end: f32, step: f32) -> bool {
    if step > 0.0 { value > end } else { value < end }
}

impl PlainCode {
    /// Runs from the statement at which the frame stands: at most `limit` statements, to the first operation
    /// that has no plain form. How many statements began; the last may have to be ended by the caller.
    pub(crate) fn run(&self, frame: &mut Frame, globals: &mut [Value], limit: u32) -> u32 {
        let mut at = self.at[frame.pc as usize] as usize;
        let mut store = Store {
            locals: &mut frame.locals,
            globals,
            temporaries: [0.0; TEMPORARIES],
        };
        let code = self.instructions.as_slice();
        let mut left_over = limit;
        let mut current = None;
        // Each arm gives the next instruction, or breaks with the operation to go on with.
        macro_rules! need {
            ($option:expr) => {
                match $option {
                    Some(value) => value,
                    None => break self.resume[at],
                }
            };
        }
        let pc = loop {
            match code[at] {
                Instruction::Statement(statement) => {
                    if left_over == 0 {
                        break self.statements[statement as usize].pc;
                    }
                    left_over -= 1;
                    current = Some(statement);
                }
                Instruction::Add { to, left, right } => {
                    let (a, b) = (need!(store.number(left)), need!(store.number(right)));
                    need!(store.set(to, a + b));
                }
                Instruction::ForNext {
                    slot,
                    statement,
                    body,
                    exit,
                } => {
                    let (value, end, step) = need!(store.counting(slot));
                    *value += step;
                    let over = is_over(*value, end, step);
                    if left_over == 0 {
                        break self.statements[statement as usize].pc;
                    }
                    left_over -= 1;
                    current = Some(statement);
                    at = if over { exit } else { body } as usize;
                    continue;
                }
                Instruction::JumpUnless {
                    test,
                    left,
                    right,
                    target,
                } => {
                    let (a, b) = (need!(store.number(left)), need!(store.number(right)));
                    if !holds(test, a, b) {
                        at = target as usize;
                        continue;
                    }
                }
                Instruction::Arithmetic {
                    op,
                    to,
                    left,
                    right,
                } => {
                    let (a, b) = (need!(store.number(left)), need!(store.number(right)));
                    let result = need!(arithmetic(op, a, b));
                    need!(store.set(to, result));
                }
                Instruction::Negate { to, value } => {
                    let number = need!(store.number(value));
                    need!(store.set(to, -number));
                }
                Instruction::Compare {
                    test,
                    to,
                    left,
                    right,
                } => {
                    let (a, b) = (need!(store.number(left)), need!(store.number(right)));
                    need!(store.set_truth(to, holds(test, a, b)));
                }
                Instruction::Logic {
                    op,
                    to,
                    left,
                    right,
                } => {
                    let (a, b) = (need!(store.truth(left)), need!(store.truth(right)));
                    let result = match op {
                        Logic::And => a && b,
                        Logic::Or => a || b,
                        Logic::Xor => a != b,
                    };
                    need!(store.set_truth(to, result));
                }
                Instruction::Not { to, value } => {
                    let truth = need!(store.truth(value));
                    need!(store.set_truth(to, !truth));
                }
                Instruction::Set { to, value } => {
                    let number = need!(store.number(value));
                    need!(store.set(to, number));
                }
                Instruction::SetTruth { to, value } => {
                    let truth = need!(store.truth(value));
                    need!(store.set_truth(to, truth));
                }
                Instruction::Copy { to, value } => need!(store.copy(to, value)),
                Instruction::LoadElement { to, array, index } => {
                    let index = need!(store.number(index));
                    let number = *need!(store.element(array, index));
                    need!(store.set(to, number));
                }
                Instruction::StoreElement {
                    array,
                    index,
                    value,
                } => {
                    let (index, number) = (need!(store.number(index)), need!(store.number(value)));
                    *need!(store.element(array, index)) = number;
                }
                Instruction::Jump(target) => {
                    at = target as usize;
                    continue;
                }
                Instruction::JumpIfFalse { value, target } => {
                    if !need!(store.truth(value)) {
                        at = target as usize;
                        continue;
                    }
                }
                Instruction::JumpIfTrue { value, target } => {
                    if need!(store.truth(value)) {
                        at = target as usize;
                        continue;
                    }
                }
                Instruction::ForTest { slot, exit } => {
                    let (value, end, step) = need!(store.counting(slot));
                    if is_over(*value, end, step) {
                        at = exit as usize;
                        continue;
                    }
                }
                Instruction::ForStep { slot } => {
                    let (value, _, step) = need!(store.counting(slot));
                    *value += step;
                }
                Instruction::Leave(pc) => break pc,
            }
            at += 1;
        };
        if let Some(statement) = current {
            let mark = self.statements[statement as usize];
            frame.statement = mark.pc;
            frame.next = mark.next;
            frame.line = mark.line;
        }
        frame.pc = pc;
        limit - left_over
    }
}
