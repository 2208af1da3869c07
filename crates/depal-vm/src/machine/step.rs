use std::sync::Arc;

use super::{Flow, Machine};
use crate::Op;
use crate::execution::{RobotTask, Step};
use crate::system::{ProgramLocation, System};

impl Machine {
    /// Runs statements of plain arithmetic from the statement at which the innermost frame stands, if it can
    /// begin in that form now, as many as the cabinet has time for. Whether one has begun.
    fn run_plain(&mut self, system: &mut dyn System) -> bool {
        let Some(frame) = self.memory.frames.last_mut() else {
            return false;
        };
        let plain = &self.plain[frame.routine as usize];
        if frame.handling.is_some() || frame.retried_statement.is_some() || !plain.has(frame.pc) {
            return false;
        }
        // Interrupts are looked at before each statement, so with them each is a step of its own.
        let more = if self.memory.interrupts.connected.is_empty() {
            system.spare_statements()
        } else {
            0
        };
        let limit = more.saturating_add(1);
        let begun = plain.run(frame, &mut self.memory.globals, limit);
        if begun > 1 {
            system.statements_ran(begun - 1);
        }
        self.locate();
        system.statement(&self.location);
        true
    }
}

impl RobotTask for Machine {
    fn step(&mut self, system: &mut dyn System) -> Step {
        if let Some(step) = &self.ended {
            return step.clone();
        }
        if !self.memory.interrupts.connected.is_empty() {
            if let Err(step) = self.watch(system) {
                self.ended = Some(step.clone());
                return step;
            }
            self.begin_interrupt();
        }
        let program = Arc::clone(&self.program);
        let mut begun = false;
        let step = loop {
            let Some(frame) = self.memory.frames.last_mut() else {
                break Step::Finished;
            };
            let code = &program.routines[frame.routine as usize].code;
            let Some(op) = code.get(frame.pc as usize) else {
                break Step::Finished;
            };
            if let Op::Statement { line, next } = op {
                if begun {
                    self.locate();
                    return Step::Ran;
                }
                begun = true;
                if self.run_plain(system) {
                    continue;
                }
                let frame = self.frame();
                if frame.handling.is_none() {
                    if frame.retried_statement != Some(frame.pc) {
                        frame.retried_statement = None;
                    }
                    frame.statement = frame.pc;
                    frame.next = *next;
                }
                frame.line = *line;
                frame.pc += 1;
                self.locate();
                system.statement(&self.location);
                continue;
            }
            // In the middle of a statement: the next one waits for the next step. The code before the
            // first statement of a routine (initial values) belongs to the statement that called it.
            begun |= frame.line > 0;
            frame.pc += 1;
            match self.dispatch(system, op) {
                Flow::Next => {}
                Flow::Blocked => {
                    self.locate();
                    return Step::Blocked;
                }
                Flow::End(step) => break step,
            }
        };
        self.ended = Some(step.clone());
        step
    }

    fn location(&self) -> ProgramLocation {
        self.location.clone()
    }
}
