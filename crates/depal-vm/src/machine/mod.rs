mod calls;
mod errors;
mod events;
mod interrupts;
mod operations;
mod step;

use std::sync::Arc;

use crate::execution::Step;
use crate::memory::{Frame, Memory};
use crate::plain::{PlainCode, translate};
use crate::system::ProgramLocation;
use crate::{MachineFault, Op, Program, RaisedError, Reference, Value};

/// Runs a [`Program`], one statement a step. Cloning it is a snapshot of the whole task.
#[derive(Debug, Clone)]
pub struct Machine {
    program: Arc<Program>,
    /// The second form of each routine's code.
    plain: Arc<[PlainCode]>,
    memory: Memory,
    location: ProgramLocation,
    located_routine: Option<u32>,
    last_error: i64,
    ended: Option<Step>,
    single_cycle: bool,
    cyclic: bool,
    /// How the program stopped, and the height of the call stack then, while the routines of that event run.
    stopping: Option<(usize, Step)>,
    /// An error on its way through UNDO clauses to the frame of this height.
    unwinding: Option<(RaisedError, usize)>,
    /// Emptied locals and operands of frames that were left, to be filled again.
    spare: Vec<(Vec<Value>, Vec<Value>)>,
}

/// What an operation asks of the loop around it.
enum Flow {
    Next,
    Blocked,
    End(Step),
}

impl Machine {
    /// A machine that stands before the first statement of the program's entry.
    pub fn new(program: Arc<Program>, task: impl Into<String>) -> Self {
        let memory = Memory {
            globals: program.globals.clone(),
            ..Memory::default()
        };
        let gives = |op: &Op| matches!(op, Op::Return { value: true } | Op::MissingReturn);
        let routines = &program.routines;
        let yields: Vec<_> = routines.iter().map(|r| r.code.iter().any(gives)).collect();
        let code = routines.iter().map(|r| translate(&r.code, &yields));
        let plain = code.collect();
        let mut machine = Self {
            plain,
            program,
            memory,
            location: ProgramLocation {
                task: task.into(),
                ..ProgramLocation::default()
            },
            located_routine: None,
            last_error: 0,
            ended: None,
            single_cycle: false,
            cyclic: false,
            stopping: None,
            unwinding: None,
            spare: Vec::new(),
        };
        machine.begin();
        let before_start = machine.program.events.before_start.clone();
        machine.push_events(&before_start);
        if let Some(initializer) = machine.program.initializer {
            machine.push_frame(initializer, Vec::new());
        }
        machine.locate();
        machine
    }

    /// Ends the task where the program would begin anew (ExitCycle), as in single cycle mode.
    #[must_use]
    pub fn single_cycle(mut self) -> Self {
        self.single_cycle = true;
        self
    }

    /// Begins anew in the next tick when the entry routine has returned, as background tasks do.
    #[must_use]
    pub fn cyclic(mut self) -> Self {
        self.cyclic = true;
        self
    }

    /// Only the loop over operations, to compare with.
    #[cfg(test)]
    pub(crate) fn without_plain(mut self) -> Self {
        self.plain = self.plain.iter().map(|_| PlainCode::default()).collect();
        self
    }

    /// The program's data.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Exchanges the module data with another machine: programs of one controller that run side by side share
    /// them, one at a time. Both must be machines of programs with the same globals.
    pub fn exchange_globals(&mut self, other: &mut Self) {
        std::mem::swap(&mut self.memory.globals, &mut other.memory.globals);
    }

    /// The program that runs.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// Value of a module variable by name, without regard to case.
    pub fn global(&self, name: &str) -> Option<&Value> {
        self.memory.globals.get(self.program.global(name)?)
    }

    /// The places of all routines being run, innermost first.
    pub fn call_stack(&self) -> Vec<ProgramLocation> {
        let initializer = self.program.initializer;
        self.memory
            .frames
            .iter()
            .rev()
            .filter(|frame| frame.line > 0 || initializer == Some(frame.routine))
            .map(|frame| self.location_of(frame))
            .collect()
    }

    fn location_of(&self, frame: &Frame) -> ProgramLocation {
        let routine = &self.program.routines[frame.routine as usize];
        ProgramLocation {
            task: self.location.task.clone(),
            module: routine.module.clone(),
            routine: routine.name.clone(),
            line: if frame.line == 0 {
                routine.line
            } else {
                frame.line
            },
        }
    }

    fn begin(&mut self) {
        self.memory.frames.clear();
        if (self.program.entry as usize) < self.program.routines.len() {
            self.push_frame(self.program.entry, Vec::new());
        }
    }

    fn push_frame(&mut self, routine: u32, arguments: Vec<Value>) {
        let code = &self.program.routines[routine as usize];
        let mut locals = code.locals.clone();
        for (slot, value) in locals.iter_mut().zip(arguments) {
            *slot = value;
        }
        self.memory.frames.push(Frame {
            routine,
            locals,
            ..Frame::default()
        });
    }

    /// Brings `location` up to date with the innermost frame.
    fn locate(&mut self) {
        let Some(frame) = self.memory.frames.last() else {
            return;
        };
        let (routine, line) = (frame.routine, frame.line);
        self.locate_at(routine, line);
    }

    /// Brings `location` to a line of a routine; 0 is where it begins.
    fn locate_at(&mut self, index: u32, line: u32) {
        let routine = &self.program.routines[index as usize];
        if self.located_routine != Some(index) {
            self.located_routine = Some(index);
            self.location.module.clone_from(&routine.module);
            self.location.routine.clone_from(&routine.name);
        }
        self.location.line = if line == 0 { routine.line } else { line };
    }

    fn frame(&mut self) -> &mut Frame {
        self.memory
            .frames
            .last_mut()
            .expect("operations run inside a frame")
    }

    fn pop(&mut self) -> Value {
        self.frame()
            .operands
            .pop()
            .expect("the lowering balances the operand stack")
    }

    fn push(&mut self, value: Value) {
        self.frame().operands.push(value);
    }

    fn pop_many(&mut self, count: u32) -> Vec<Value> {
        let operands = &mut self.frame().operands;
        let at = operands
            .len()
            .checked_sub(count as usize)
            .expect("the lowering balances the operand stack");
        operands.split_off(at)
    }

    fn pop_bool(&mut self) -> Result<bool, MachineFault> {
        match self.pop() {
            Value::Bool(value) => Ok(value),
            other => Err(MachineFault::Argument {
                message: format!("a condition is {}", other.kind_name()),
            }),
        }
    }

    fn jump(&mut self, target: u32) {
        self.frame().pc = target;
    }

    fn pop_reference(&mut self) -> Result<Reference, MachineFault> {
        match self.pop() {
            Value::Reference(reference) => Ok(reference),
            _ => Err(MachineFault::NotPresent),
        }
    }
}
