use std::sync::{Arc, Mutex, PoisonError};

use depal_vm::execution::{RobotTask, RuntimeError, Step};
use depal_vm::system::{ProgramLocation, System};
use depal_vm::{Machine, Memory, Program, Value};

use crate::registers::written_registers;
use crate::state;

/// Most programs that run side by side.
const MOST: usize = 32;

/// The registers of a [`Tasks`] that was given away, as they stood when it last waited or ended.
#[derive(Debug, Clone, Default)]
pub struct RegisterView {
    written: Arc<Mutex<Vec<(u32, f64)>>>,
}

impl RegisterView {
    /// As [`written_registers`].
    pub fn written_registers(&self) -> Vec<(u32, f64)> {
        let written = self.written.lock();
        written.unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn show(&self, memory: &Memory) {
        let mut written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
        *written = written_registers(memory);
    }
}

/// A program, and those that it starts with RUN. They take turns, a statement each, and share all registers.
///
/// It is over when all of them are. PAUSE and ABORT of the first program end all; in one that was started they end
/// that one only. An error in any of them stops all, as a controller pauses them.
#[derive(Debug, Clone)]
pub struct Tasks {
    program: Arc<Program>,
    /// The first one is the main program; the one at `holder` has the registers.
    machines: Vec<Running>,
    is_main_over: bool,
    holder: usize,
    turn: usize,
    /// Requests of RUN that have been done.
    started: usize,
    ended: Option<Step>,
    view: Option<RegisterView>,
}

#[derive(Debug, Clone)]
struct Running {
    machine: Machine,
    routine: u32,
}

impl Tasks {
    /// Before the first line of the program's entry.
    pub fn new(program: Arc<Program>, name: impl Into<String>) -> Self {
        Self {
            machines: vec![Running {
                machine: Machine::new(Arc::clone(&program), name),
                routine: program.entry,
            }],
            program,
            is_main_over: false,
            holder: 0,
            turn: 0,
            started: 0,
            ended: None,
            view: None,
        }
    }

    /// A view of the registers that stays when the tasks are given to a cabinet.
    pub fn view(&mut self) -> RegisterView {
        let view = self.view.get_or_insert_default().clone();
        view.show(self.memory());
        view
    }

    /// The registers, for [`written_registers`](crate::written_registers).
    pub fn memory(&self) -> &Memory {
        self.machines[self.holder].machine.memory()
    }

    /// The places of all routines of the program whose turn it was last, innermost first.
    pub fn call_stack(&self) -> Vec<ProgramLocation> {
        self.machines[self.holder].machine.call_stack()
    }

    /// Gives the registers to a machine.
    fn hand(&mut self, to: usize) {
        if self.holder != to {
            let (low, high) = (self.holder.min(to), self.holder.max(to));
            let (left, right) = self.machines.split_at_mut(high);
            left[low].machine.exchange_globals(&mut right[0].machine);
            self.holder = to;
        }
    }

    /// Begins the programs that RUN has asked for since the last time.
    fn begin(&mut self) -> Result<(), String> {
        let asked: Vec<Value> = state::items(self.memory(), state::STARTS)[self.started..].to_vec();
        self.started += asked.len();
        for request in asked {
            let Value::Array(mut values) = request else {
                continue;
            };
            let routine = values.first().and_then(Value::as_number).unwrap_or(0.0) as u32;
            let mut program = (*self.program).clone();
            let name = program.routines[routine as usize].name.clone();
            let is_over = |index: usize| index == 0 && self.is_main_over;
            let mut running = self.machines.iter().enumerate();
            if running.any(|(index, other)| other.routine == routine && !is_over(index)) {
                return Err(format!("Program is already running: RUN {name}"));
            }
            if self.machines.len() >= MOST {
                return Err(format!(
                    "Too many tasks: RUN {name}, {MOST} programs run already"
                ));
            }
            program.entry = routine;
            // Its arguments are what its first locals begin with.
            let locals = &mut program.routines[routine as usize].locals;
            for (local, value) in locals.iter_mut().zip(values.drain(1..)) {
                *local = value;
            }
            self.machines.push(Running {
                machine: Machine::new(Arc::new(program), name),
                routine,
            });
        }
        Ok(())
    }

    fn fail(&mut self, message: String) -> Step {
        let mut call_stack = self.call_stack();
        if call_stack.is_empty() {
            // It was the last line.
            call_stack.push(self.location());
        }
        let error = RuntimeError {
            name: "INTP".into(),
            message,
            call_stack,
        };
        self.end(Step::Failed(error))
    }

    fn end(&mut self, step: Step) -> Step {
        self.ended = Some(step.clone());
        step
    }

    /// A program is over. What the whole does.
    fn leave(&mut self, index: usize, step: Step) -> Step {
        if index == 0 {
            if step != Step::Finished {
                return self.end(step);
            }
            self.is_main_over = true;
        } else {
            self.hand(0);
            self.machines.remove(index);
        }
        if self.is_main_over && self.machines.len() == 1 {
            self.end(Step::Finished)
        } else {
            Step::Ran
        }
    }
}

impl Tasks {
    fn advance(&mut self, system: &mut dyn System) -> Step {
        if let Some(step) = &self.ended {
            return step.clone();
        }
        let count = self.machines.len();
        for ahead in 0..count {
            let index = (self.turn + ahead) % count;
            if index == 0 && self.is_main_over {
                continue;
            }
            self.hand(index);
            match self.machines[index].machine.step(system) {
                Step::Blocked => {}
                Step::Ran => {
                    self.turn = index + 1;
                    return match self.begin() {
                        Ok(()) => Step::Ran,
                        Err(message) => self.fail(message),
                    };
                }
                Step::Failed(error) => return self.end(Step::Failed(error)),
                step => {
                    // RUN may stand in its last line.
                    return match self.begin() {
                        Ok(()) => self.leave(index, step),
                        Err(message) => self.fail(message),
                    };
                }
            }
        }
        Step::Blocked
    }
}

impl RobotTask for Tasks {
    fn step(&mut self, system: &mut dyn System) -> Step {
        let step = self.advance(system);
        if step != Step::Ran
            && let Some(view) = &self.view
        {
            view.show(self.memory());
        }
        step
    }

    fn location(&self) -> ProgramLocation {
        self.machines[self.holder].machine.location()
    }
}
