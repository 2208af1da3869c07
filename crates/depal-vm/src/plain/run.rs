use super::{
    Arithmetic, CallSite, Comparison, Instruction, Kind, Logic, NONE, Operand, PlainCode,
    TEMPORARIES,
};
use crate::memory::Frame;
use crate::{Routine, Value};

/// The variables that instructions take their operands from.
struct Store<'a> {
    locals: &'a mut [Value],
    globals: &'a mut [Value],
    operands: &'a mut Vec<Value>,
    temporaries: &'a mut [f32; TEMPORARIES],
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
            Operand::Stacked(index) => self.operands.get(index as usize)?,
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
            Operand::Stacked(index) => self.operands.get(index as usize)?,
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
            Operand::Temporary(_) | Operand::Constant(_) | Operand::Stacked(_) => None,
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
            Operand::Constant(_) | Operand::Stacked(_) => return None,
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

    /// A number or a truth value as a value.
    #[inline]
    fn value(&self, operand: Operand, kind: Kind) -> Option<Value> {
        if kind != Kind::Truth
            && let Some(number) = self.number(operand)
        {
            return Some(Value::Num(number));
        }
        if kind == Kind::Number {
            return None;
        }
        self.truth(operand).map(Value::Bool)
    }

    /// The values that a call takes: its arguments into `locals`, what is to be found again onto the operand stack.
    /// Whether all are of this form; if not, nothing has changed but `locals`.
    #[inline]
    fn pass(&mut self, call: &CallSite, locals: &mut Vec<Value>) -> Option<()> {
        for (operand, kind) in &call.arguments {
            locals.push(self.value(*operand, *kind)?);
        }
        if let [(operand, kind)] = call.spilled.as_slice() {
            let value = self.value(*operand, *kind)?;
            self.operands.truncate(call.kept);
            self.operands.push(value);
            return Some(());
        }
        for (operand, kind) in &call.spilled {
            self.value(*operand, *kind)?;
        }
        self.operands.truncate(call.kept);
        for (operand, kind) in &call.spilled {
            let value = self.value(*operand, *kind)?;
            self.operands.push(value);
        }
        Some(())
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

/// Emptied parts of frames that are kept.
const SPARE_LIMIT: usize = 64;

/// The parts of a machine that plain statements use.
pub(crate) struct Runner<'a> {
    pub(crate) routines: &'a [Routine],
    pub(crate) codes: &'a [PlainCode],
    pub(crate) frames: &'a mut Vec<Frame>,
    pub(crate) globals: &'a mut [Value],
    pub(crate) spare: &'a mut Vec<(Vec<Value>, Vec<Value>)>,
    pub(crate) recursion_limit: usize,
    /// Whether a return is nothing but a return.
    pub(crate) may_return: bool,
}

/// How the innermost frame was left.
enum Exit {
    /// The loop over operations goes on there, with so many values on the operand stack.
    Leave(u32, u32),
    /// A routine is called with these locals; the caller goes on there.
    Call(u32, Vec<Value>, Vec<Value>, u32),
    Return(Option<Value>),
}

impl Runner<'_> {
    /// Runs from the statement at which the innermost frame stands: at most `limit` statements, to the first
    /// operation that has no plain form. How many statements began, and routine and line of the last;
    /// the last may have to be ended by the caller.
    pub(crate) fn run(&mut self, limit: u32) -> (u32, (u32, u32)) {
        let mut left_over = limit;
        let mut last = (0, 0);
        let mut temporaries = [0.0; TEMPORARIES];
        while self.stretch(&mut left_over, &mut last, &mut temporaries) {}
        (limit - left_over, last)
    }

    /// Runs in the innermost frame. Whether it goes on in what is the innermost frame then.
    fn stretch(
        &mut self,
        statements_left: &mut u32,
        last: &mut (u32, u32),
        temporaries: &mut [f32; TEMPORARIES],
    ) -> bool {
        let height = self.frames.len();
        let Some(frame) = self.frames.last_mut() else {
            return false;
        };
        let plain = &self.codes[frame.routine as usize];
        let Some(at) = plain.at.get(frame.pc as usize).filter(|at| **at != NONE) else {
            return false;
        };
        let mut at = *at as usize;
        let mut store = Store {
            locals: &mut frame.locals,
            globals: self.globals,
            operands: &mut frame.operands,
            temporaries,
        };
        let code = plain.instructions.as_slice();
        let mut left_over = *statements_left;
        let mut current = None;
        // Each arm gives the next instruction, or breaks with where to go on.
        macro_rules! bail {
            () => {{
                let (pc, depth) = plain.resume[at];
                break Exit::Leave(pc, depth);
            }};
        }
        macro_rules! need {
            ($option:expr) => {
                match $option {
                    Some(value) => value,
                    None => bail!(),
                }
            };
        }
        let exit = loop {
            match code[at] {
                Instruction::Statement(statement) => {
                    if left_over == 0 {
                        break Exit::Leave(plain.statements[statement as usize].pc, 0);
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
                        break Exit::Leave(plain.statements[statement as usize].pc, 0);
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
                Instruction::Call(index) => {
                    let call = &plain.calls[index as usize];
                    if height >= self.recursion_limit {
                        bail!();
                    }
                    let (mut locals, operands) = self.spare.pop().unwrap_or_default();
                    if store.pass(call, &mut locals).is_none() {
                        locals.clear();
                        self.spare.push((locals, operands));
                        bail!();
                    }
                    break Exit::Call(call.routine, locals, operands, call.next);
                }
                Instruction::Return => {
                    if height < 2 || !self.may_return {
                        bail!();
                    }
                    break Exit::Return(None);
                }
                Instruction::ReturnValue { value, kind } => {
                    if height < 2 || !self.may_return {
                        bail!();
                    }
                    break Exit::Return(Some(need!(store.value(value, kind))));
                }
                Instruction::Leave(_) => bail!(),
            }
            at += 1;
        };
        *statements_left = left_over;
        if let Some(statement) = current {
            let mark = plain.statements[statement as usize];
            frame.statement = mark.pc;
            frame.next = mark.next;
            frame.line = mark.line;
            *last = (frame.routine, mark.line);
        }
        match exit {
            Exit::Leave(pc, depth) => {
                frame.operands.truncate(depth as usize);
                frame.pc = pc;
                false
            }
            Exit::Call(routine, mut locals, operands, next) => {
                frame.pc = next;
                let given = locals.len();
                let all = &self.routines[routine as usize].locals;
                if given < all.len() {
                    locals.extend_from_slice(&all[given..]);
                }
                self.frames.push(Frame {
                    routine,
                    locals,
                    operands,
                    ..Frame::default()
                });
                true
            }
            Exit::Return(value) => self.leave(value),
        }
    }

    /// Leaves the innermost frame. Whether its caller goes on in this form.
    #[inline]
    fn leave(&mut self, value: Option<Value>) -> bool {
        let Some(Frame {
            mut locals,
            mut operands,
            interrupt,
            is_event,
            ..
        }) = self.frames.pop()
        else {
            return false;
        };
        if self.spare.len() < SPARE_LIMIT {
            locals.clear();
            operands.clear();
            self.spare.push((locals, operands));
        }
        let Some(caller) = self.frames.last_mut() else {
            return false;
        };
        caller.operands.extend(value);
        interrupt.is_none()
            && !is_event
            && caller.handling.is_none()
            && caller.retried_statement.is_none()
    }
}
