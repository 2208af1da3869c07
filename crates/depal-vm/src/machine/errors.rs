use super::{Flow, Machine};
use crate::execution::{RuntimeError, Step};
use crate::memory::Handling;
use crate::{ErrorNumber, MachineFault, RaisedError, Value};

impl Machine {
    /// Hands an error to the nearest handler that takes it. `from_handler`: a handler gives it up itself.
    pub(super) fn handle(&mut self, error: RaisedError, from_handler: bool) -> Flow {
        let failure = RuntimeError {
            name: error.name.clone(),
            message: error.message.clone(),
            call_stack: self.call_stack(),
        };
        self.last_error = error.number;
        let mut give_up = from_handler;
        let mut taker = None;
        for (height, frame) in self.memory.frames.iter().enumerate().rev() {
            if frame.handling.is_some() && !give_up {
                // An error inside a handler has nowhere to go.
                break;
            }
            let handler = self.program.routines[frame.routine as usize]
                .handler
                .as_ref();
            let holds = |value: Option<&Value>| {
                value.and_then(Value::as_number) == Some(error.number as f64)
            };
            let is_this = |number: &ErrorNumber| match number {
                ErrorNumber::Number(number) => *number == error.number,
                ErrorNumber::Global(slot) => holds(self.memory.globals.get(*slot as usize)),
                ErrorNumber::Local(slot) => holds(frame.locals.get(*slot as usize)),
            };
            let takes = !give_up
                && handler.is_some_and(|handler| {
                    handler
                        .numbers
                        .as_ref()
                        .is_none_or(|numbers| numbers.iter().any(is_this))
                });
            give_up = false;
            if takes {
                taker = Some(height);
                break;
            }
            if frame.interrupt.is_some() || frame.is_event {
                // What the routine of an interrupt or an event does not handle stops the program.
                break;
            }
        }
        match taker {
            Some(height) => self.unwind(error, height),
            None => Flow::End(Step::Failed(failure)),
        }
    }

    /// Leaves all routines above the one that handles the error; each runs its UNDO clause first.
    pub(super) fn unwind(&mut self, error: RaisedError, height: usize) -> Flow {
        while self.memory.frames.len() > height + 1 {
            let frame = self.memory.frames.last_mut().expect("just counted");
            let undo = self.program.routines[frame.routine as usize].undo;
            if let (Some(undo), false) = (undo, frame.undoing) {
                frame.undoing = true;
                frame.operands.clear();
                frame.pending = None;
                frame.wait_started = None;
                frame.handling = None;
                frame.pc = undo;
                self.unwinding = Some((error, height));
                return Flow::Next;
            }
            self.memory.frames.pop();
        }
        let frame = self.memory.frames.last_mut().expect("the taker is there");
        let handler = self.program.routines[frame.routine as usize]
            .handler
            .as_ref();
        frame.operands.clear();
        frame.pending = None;
        frame.wait_started = None;
        frame.handling = Some(Box::new(Handling {
            error,
            retry: frame.statement,
            next: frame.next,
        }));
        frame.pc = handler.map_or(0, |handler| handler.entry);
        Flow::Next
    }

    pub(super) fn retry(&mut self) -> Result<Flow, MachineFault> {
        let limit = self.program.rules.retry_limit;
        let frame = self.frame();
        let Some(handling) = frame.handling.take() else {
            return Ok(Flow::Next);
        };
        if frame.retried_statement == Some(handling.retry) {
            frame.retries += 1;
        } else {
            frame.retried_statement = Some(handling.retry);
            frame.retries = 1;
        }
        if frame.retries > limit {
            frame.retries = 0;
            frame.retried_statement = None;
            frame.handling = Some(handling);
            return Err(MachineFault::RetryLimit { limit });
        }
        frame.pc = handling.retry;
        Ok(Flow::Next)
    }

    /// The error for a number: the language's own if the program passes one on, else the user's.
    pub(super) fn user_error(&self, number: f64) -> RaisedError {
        let name = (self.program.rules.error_name)(number as i64);
        RaisedError {
            number: number as i64,
            message: match name {
                Some(name) => format!("raised by the program: {name}"),
                None => format!("raised by the program: error number {number}"),
            },
            name: name.map_or_else(|| format!("ERROR {number}"), str::to_owned),
        }
    }
}
