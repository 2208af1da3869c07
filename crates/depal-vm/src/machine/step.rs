use std::sync::Arc;

use super::{Flow, Machine};
use crate::execution::{RobotTask, Step};
use crate::plain::Runner;
use crate::system::{ProgramLocation, System};
use crate::{Op, SharedDatum, Value};

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
        let mut runner = Runner {
            routines: &self.program.routines,
            codes: &self.plain,
            frames: &mut self.memory.frames,
            globals: &mut self.memory.globals,
            spare: &mut self.spare,
            recursion_limit: self.program.rules.recursion_limit,
            may_return: self.stopping.is_none(),
        };
        let (begun, (routine, line)) = runner.run(limit);
        if begun > 1 {
            system.statements_ran(begun - 1);
        }
        self.locate_at(routine, line);
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
                Flow::End(Step::Finished) if self.cyclic => {
                    // The next round begins in the next tick, so that an empty one takes time, too.
                    self.begin();
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

    fn initialize(&mut self, system: &mut dyn System) {
        let program = Arc::clone(&self.program);
        while self.ended.is_none()
            && let Some(frame) = self.memory.frames.last_mut()
            && program.initializer == Some(frame.routine)
        {
            let code = &program.routines[frame.routine as usize].code;
            let Some(op) = code.get(frame.pc as usize) else {
                break;
            };
            frame.pc += 1;
            match self.dispatch(system, op) {
                Flow::Next => {}
                Flow::Blocked => break,
                Flow::End(step) => self.ended = Some(step),
            }
        }
        self.locate();
    }

    fn restart(&mut self) -> bool {
        self.go_on()
    }

    fn shared_data(&self) -> &[SharedDatum] {
        &self.program.shared
    }

    fn shared_value(&self, index: usize) -> Option<&Value> {
        let datum = self.program.shared.get(index)?;
        self.memory.globals.get(datum.global as usize)
    }

    fn set_shared(&mut self, index: usize, value: Value) {
        let datum = self.program.shared.get(index);
        let slot = datum.and_then(|datum| self.memory.globals.get_mut(datum.global as usize));
        if let Some(slot) = slot {
            *slot = value;
        }
    }
}
