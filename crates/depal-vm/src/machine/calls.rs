use std::sync::Arc;

use super::{Flow, Machine};
use crate::execution::Step;
use crate::memory::{Frame, PendingCall};
use crate::system::System;
use crate::{CallContext, MachineFault, Outcome, RaisedError, Value};

/// Emptied parts of frames that are kept.
const SPARE_LIMIT: usize = 64;

impl Machine {
    /// Calls a routine with the top values of the innermost frame as its first locals.
    pub(super) fn call(&mut self, routine: u32, arguments: u32) {
        let code = &self.program.routines[routine as usize];
        let arguments = arguments as usize;
        let (mut locals, operands) = self.spare.pop().unwrap_or_default();
        let caller = self.memory.frames.last_mut();
        let values = &mut caller.expect("operations run inside a frame").operands;
        let at = values.len().checked_sub(arguments);
        locals.extend(values.drain(at.expect("the lowering balances the operand stack")..));
        locals.extend_from_slice(code.locals.get(arguments..).unwrap_or_default());
        self.memory.frames.push(Frame {
            routine,
            locals,
            operands,
            ..Frame::default()
        });
    }

    /// Leaves the innermost routine; the room of its data is kept for the next call.
    pub(super) fn leave(&mut self) {
        if let Some(Frame {
            mut locals,
            mut operands,
            ..
        }) = self.memory.frames.pop()
            && self.spare.len() < SPARE_LIMIT
        {
            locals.clear();
            operands.clear();
            self.spare.push((locals, operands));
        }
    }

    pub(super) fn call_by_name(&mut self, count: u32) -> Result<(), MachineFault> {
        let mut given = self.pop_many(count).into_iter();
        let Value::Str(name) = self.pop() else {
            return Err(MachineFault::Argument {
                message: "the name of a procedure is a string".into(),
            });
        };
        let (module, wanted) = match name.split_once(':') {
            Some((module, wanted)) => (Some(module), wanted),
            None => (None, name.as_str()),
        };
        let program = Arc::clone(&self.program);
        let found = program.routines.iter().position(|routine| {
            routine.callable.is_some()
                && routine.name.eq_ignore_ascii_case(wanted)
                && module.is_none_or(|module| routine.module.eq_ignore_ascii_case(module))
        });
        let Some(index) = found else {
            return Err(MachineFault::UnknownRoutine { name });
        };
        let parameters = program.routines[index].callable.iter().flatten();
        let needed = parameters.clone().filter(|p| !p.optional).count();
        if needed != count as usize {
            return Err(MachineFault::WrongCall {
                name,
                message: format!("it needs {needed}, {count} are given"),
            });
        }
        let mut arguments = Vec::new();
        for parameter in parameters {
            if parameter.optional {
                arguments.push(Value::Absent);
                continue;
            }
            arguments.push(
                match (given.next().unwrap_or_default(), parameter.by_reference) {
                    (Value::Reference(reference), false) => self.memory.read(&reference)?.clone(),
                    (Value::Reference(reference), true) => Value::Reference(reference),
                    (_, true) => {
                        return Err(MachineFault::WrongCall {
                            name,
                            message: "a variable is needed, a value is given".into(),
                        });
                    }
                    (value, false) => value,
                },
            );
        }
        let limit = self.program.rules.recursion_limit;
        if self.memory.frames.len() >= limit {
            return Err(MachineFault::RecursionLimit { limit });
        }
        self.push_frame(index as u32, arguments);
        Ok(())
    }

    pub(super) fn call_builtin(
        &mut self,
        system: &mut dyn System,
        builtin: u32,
        arguments: u32,
        result: bool,
    ) -> Result<Flow, RaisedError> {
        self.locate();
        let mut pending = match self.frame().pending.take() {
            Some(pending) => pending,
            None => Box::new(PendingCall {
                arguments: self.pop_many(arguments),
                started: system.call_time(),
                notes: Vec::new(),
            }),
        };
        let program = Arc::clone(&self.program);
        let mut context = CallContext {
            arguments: &mut pending.arguments,
            started: pending.started,
            notes: &mut pending.notes,
            memory: &mut self.memory,
            location: &self.location,
            rules: &program.rules,
            program: &program,
        };
        match (program.builtins[builtin as usize].run)(&mut context, system)? {
            Outcome::Done(value) => {
                if result {
                    self.push(value);
                }
                Ok(Flow::Next)
            }
            Outcome::Blocked => {
                let frame = self.frame();
                frame.pending = Some(pending);
                frame.pc -= 1;
                Ok(Flow::Blocked)
            }
            Outcome::Raise(error) => {
                let from_handler = self.frame().handling.is_some();
                Ok(self.handle(error, from_handler))
            }
            Outcome::Stop(reason) => Ok(self.stop(reason)),
            Outcome::Restart if self.single_cycle => {
                self.memory.frames.clear();
                Ok(Flow::End(Step::Stopped("ExitCycle".into())))
            }
            Outcome::Restart => {
                self.begin();
                Ok(Flow::Next)
            }
        }
    }
}
