mod forms;

use super::{Instruction, Kind, NONE, Operand, PlainCode, TEMPORARIES};
use crate::Op;

/// What stands on the operand stack, as a place to take it from.
#[derive(Debug, Clone, Copy)]
enum Entry {
    Value(Operand, Kind),
    Place(Operand),
    Element { array: Operand, index: Operand },
}

/// An operation that has no plain form.
struct NotPlain;

/// Where the expression under way begins: there it can be evaluated again.
#[derive(Debug, Clone, Copy, Default)]
struct Begin {
    /// Its operation.
    pc: u32,
    /// How many values lie on the operand stack.
    depth: u32,
    /// How many instructions and fixups there were.
    instructions: usize,
    fixups: usize,
}

struct Translator<'a> {
    code: &'a [Op],
    /// For each routine whether it gives a value.
    yields: &'a [bool],
    is_target: Vec<bool>,
    plain: PlainCode,
    /// Instruction with a target, and that target as an operation.
    fixups: Vec<(usize, u32)>,
    stack: Vec<Entry>,
    begin: Begin,
    /// A call was made: what comes before it is not done again.
    called: bool,
    /// Jumps with a truth value lead into the expression under way.
    short_cut: bool,
    /// Waiting for the next statement after an operation that has no plain form.
    skipping: bool,
}

/// The plain form of a routine's code. `yields`: for each routine whether it gives a value.
pub(crate) fn translate(code: &[Op], yields: &[bool]) -> PlainCode {
    let mut is_target = vec![false; code.len() + 1];
    for op in code {
        if let Some(target) = target(op)
            && let Some(flag) = is_target.get_mut(target as usize)
        {
            *flag = true;
        }
    }
    let mut translator = Translator {
        code,
        yields,
        is_target,
        plain: PlainCode {
            at: vec![NONE; code.len()],
            ..PlainCode::default()
        },
        fixups: Vec::new(),
        stack: Vec::new(),
        begin: Begin::default(),
        called: false,
        short_cut: false,
        skipping: false,
    };
    translator.run();
    translator.plain
}

fn target(op: &Op) -> Option<u32> {
    match op {
        Op::Jump(target)
        | Op::JumpIfFalse(target)
        | Op::JumpIfFalseKeep(target)
        | Op::JumpIfTrueKeep(target)
        | Op::Block(target)
        | Op::ForTest { exit: target, .. } => Some(*target),
        _ => None,
    }
}

impl Translator<'_> {
    fn run(&mut self) {
        let mut pc = 0;
        while pc < self.code.len() {
            let op = &self.code[pc];
            if self.skipping && begins_afresh(op) {
                self.skipping = false;
                self.stack.clear();
                self.mark_begin(pc as u32);
            }
            if self.skipping {
                pc += 1;
                continue;
            }
            self.plain.at[pc] = self.plain.instructions.len() as u32;
            if let Ok(length) = self.operation(pc, op) {
                pc += length;
                if self.stack.is_empty() || self.called {
                    self.mark_begin(pc as u32);
                }
            } else {
                self.give_up(pc);
                pc += 1;
            }
        }
        if !self.skipping {
            self.give_up(self.code.len());
        }
        for (instruction, target) in std::mem::take(&mut self.fixups) {
            let known = self.plain.at.get(target as usize).copied();
            let to = if let Some(to) = known.filter(|to| *to != NONE) {
                to
            } else {
                self.begin = Begin {
                    pc: target,
                    ..Begin::default()
                };
                self.emit(Instruction::Leave(target));
                self.plain.instructions.len() as u32 - 1
            };
            set_target(&mut self.plain.instructions[instruction], to);
        }
    }

    fn mark_begin(&mut self, pc: u32) {
        self.begin = Begin {
            pc,
            depth: self.stack.len() as u32,
            instructions: self.plain.instructions.len(),
            fixups: self.fixups.len(),
        };
        self.called = false;
        self.short_cut = false;
    }

    /// Takes back the expression under way; the loop over operations evaluates it.
    fn give_up(&mut self, pc: usize) {
        let begin = self.begin.pc;
        self.plain.instructions.truncate(self.begin.instructions);
        self.plain.resume.truncate(self.begin.instructions);
        self.fixups.truncate(self.begin.fixups);
        let last = (pc + 1).min(self.code.len());
        for at in &mut self.plain.at[(begin as usize + 1).min(last)..last] {
            *at = NONE;
        }
        self.stack.clear();
        self.emit(Instruction::Leave(begin));
        self.skipping = true;
    }

    fn emit(&mut self, instruction: Instruction) {
        self.plain.instructions.push(instruction);
        self.plain.resume.push((self.begin.pc, self.begin.depth));
    }

    fn emit_jump(&mut self, instruction: Instruction, target: u32) {
        self.fixups.push((self.plain.instructions.len(), target));
        self.emit(instruction);
    }

    /// The temporary of the level above the stack as it is.
    fn temporary(&self) -> Result<Operand, NotPlain> {
        let index = self.stack.len() * 2;
        if index + 1 >= TEMPORARIES {
            return Err(NotPlain);
        }
        Ok(Operand::Temporary(index as u32))
    }

    fn pop_value(&mut self) -> Result<(Operand, Kind), NotPlain> {
        match self.stack.pop() {
            Some(Entry::Value(operand, kind)) => Ok((operand, kind)),
            _ => Err(NotPlain),
        }
    }

    fn pop_number(&mut self) -> Result<Operand, NotPlain> {
        match self.pop_value()? {
            (_, Kind::Truth) => Err(NotPlain),
            (operand, _) => Ok(operand),
        }
    }

    fn pop_truth(&mut self) -> Result<Operand, NotPlain> {
        match self.pop_value()? {
            (_, Kind::Number) => Err(NotPlain),
            (operand, _) => Ok(operand),
        }
    }

    fn needs_empty_stack(&self) -> Result<(), NotPlain> {
        if self.stack.is_empty() {
            Ok(())
        } else {
            Err(NotPlain)
        }
    }

    fn push(&mut self, operand: Operand, kind: Kind) {
        self.stack.push(Entry::Value(operand, kind));
    }
}

/// Operations at which the operand stack is empty whatever came before.
fn begins_afresh(op: &Op) -> bool {
    matches!(
        op,
        Op::Statement { .. } | Op::ForTest { .. } | Op::ForStep { .. }
    )
}

fn set_target(instruction: &mut Instruction, to: u32) {
    match instruction {
        Instruction::Jump(target)
        | Instruction::JumpIfFalse { target, .. }
        | Instruction::JumpIfTrue { target, .. }
        | Instruction::JumpUnless { target, .. }
        | Instruction::ForTest { exit: target, .. }
        | Instruction::ForNext { exit: target, .. } => *target = to,
        _ => {}
    }
}
