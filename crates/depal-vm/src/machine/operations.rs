use depal_time::SimTime;

use super::{Flow, Machine};
use crate::execution::Step;
use crate::memory::element;
use crate::operators::{binary, unary};
use crate::system::System;
use crate::{MachineFault, Op, Reference, Root, Value};

impl Machine {
    pub(super) fn dispatch(&mut self, system: &mut dyn System, op: &Op) -> Flow {
        match op {
            Op::CallBuiltin {
                builtin,
                arguments,
                result,
            } => match self.call_builtin(system, *builtin, *arguments, *result) {
                Ok(flow) => flow,
                Err(error) => self.handle(error, false),
            },
            Op::Raise => {
                let number = self.pop().as_number().unwrap_or(0.0);
                let from_handler = self.frame().handling.is_some();
                self.handle(self.user_error(number), from_handler)
            }
            Op::Reraise => {
                let handled = self.frame().handling.take().map(|h| h.error);
                let error = handled.unwrap_or_else(|| self.user_error(self.last_error as f64));
                self.handle(error, true)
            }
            Op::RaiseError(error) => self.handle((**error).clone(), false),
            op => match self.run(system, op) {
                Ok(flow) => flow,
                Err(fault) => {
                    let from_handler = matches!(fault, MachineFault::RetryLimit { .. });
                    self.handle((self.program.rules.raise)(&fault), from_handler)
                }
            },
        }
    }

    fn run(&mut self, system: &mut dyn System, op: &Op) -> Result<Flow, MachineFault> {
        match op {
            Op::Statement { .. } => {}
            Op::Push(value) => self.push(value.clone()),
            Op::Pop => {
                self.pop();
            }
            Op::LoadLocal(slot) => {
                let frame = self.memory.frames.last().expect("inside a frame");
                let value = match &frame.locals[*slot as usize] {
                    Value::Absent => return Err(MachineFault::NotPresent),
                    Value::Reference(reference) => self.memory.read(reference)?.clone(),
                    value => value.clone(),
                };
                self.push(value);
            }
            Op::LoadGlobal(slot) => {
                let value = self.memory.globals[*slot as usize].clone();
                self.push(value);
            }
            Op::StoreLocal(slot) => {
                let value = self.pop();
                let reference = self.local_reference(*slot);
                if self.memory.read(&reference).is_err() {
                    return Err(MachineFault::NotPresent);
                }
                self.memory.write(&reference, value)?;
            }
            Op::StoreGlobal(slot) => {
                let value = self.pop();
                self.memory.globals[*slot as usize] = value;
            }
            Op::SetLocal(slot) => {
                let value = self.pop();
                self.frame().locals[*slot as usize] = value;
            }
            Op::PlaceLocal(slot) => {
                let reference = self.local_reference(*slot);
                self.memory.read(&reference)?;
                self.push(Value::Reference(reference));
            }
            Op::PlaceGlobal(slot) => self.push(Value::Reference(Reference {
                root: Root::Global(*slot),
                path: Vec::new(),
            })),
            Op::PlaceField(field) => {
                let mut reference = self.pop_reference()?;
                reference.path.push(*field);
                self.push(Value::Reference(reference));
            }
            Op::PlaceIndex(count) => {
                let indexes = self.pop_many(*count);
                let reference = self.pop_reference()?;
                let reference = self.memory.index(reference, &indexes)?;
                self.push(Value::Reference(reference));
            }
            Op::LoadPlace => {
                let reference = self.pop_reference()?;
                let value = self.memory.read(&reference)?.clone();
                self.push(value);
            }
            Op::StorePlace => {
                let value = self.pop();
                let reference = self.pop_reference()?;
                self.memory.write(&reference, value)?;
            }
            Op::Field(index) => {
                let value = match self.pop() {
                    Value::Record(mut fields) if (*index as usize) < fields.len() => {
                        fields.swap_remove(*index as usize)
                    }
                    _ => return Err(MachineFault::NotPresent),
                };
                self.push(value);
            }
            Op::Index(count) => {
                let indexes = self.pop_many(*count);
                let array = self.pop();
                let mut value = &array;
                for (dimension, index) in indexes.iter().enumerate() {
                    value = element(value, index, dimension)?.1;
                }
                let value = value.clone();
                self.push(value);
            }
            Op::MakeRecord(count) => {
                let fields = self.pop_many(*count);
                self.push(Value::Record(fields));
            }
            Op::MakeArray(count) => {
                let items = self.pop_many(*count);
                self.push(Value::Array(items));
            }
            Op::CheckSet(name) => {
                let top = self.memory.frames.last().and_then(|f| f.operands.last());
                if top.is_none_or(Value::is_unset) {
                    return Err(MachineFault::NotInitialized {
                        name: name.to_string(),
                    });
                }
            }
            Op::Resume => self.resume()?,
            Op::Unary(op) => {
                let value = unary(*op, self.pop())?;
                let value = self.in_range(value)?;
                self.push(value);
            }
            Op::Binary(op) => {
                let right = self.pop();
                let left = self.pop();
                let value = binary(*op, left, right, self.program.rules.string_limit)?;
                let value = self.in_range(value)?;
                self.push(value);
            }
            Op::ReadSignal => {
                let Value::Signal(name) = self.pop() else {
                    return Err(MachineFault::NotPresent);
                };
                let value = system.signal(&name).map_err(MachineFault::System)?;
                self.push(Value::Num(value as f32));
            }
            Op::Jump(target) => self.jump(*target),
            Op::JumpIfFalse(target) => {
                if !self.pop_bool()? {
                    self.jump(*target);
                }
            }
            Op::JumpIfFalseKeep(target) => {
                if self.frame().operands.last() == Some(&Value::Bool(false)) {
                    self.jump(*target);
                }
            }
            Op::JumpIfTrueKeep(target) => {
                if self.frame().operands.last() == Some(&Value::Bool(true)) {
                    self.jump(*target);
                }
            }
            Op::PassLocal(slot) => {
                let value = self.frame().locals[*slot as usize].clone();
                self.push(value);
            }
            Op::IsPresent(slot) => {
                let present = self.frame().locals[*slot as usize].is_present();
                self.push(Value::Bool(present));
            }
            Op::ForBegin { slot, stepped } => self.begin_for(*slot, *stepped)?,
            Op::ForTest { slot, exit } => {
                let (value, end, step) = self.for_state(*slot);
                let over = if step > 0.0 { value > end } else { value < end };
                if over {
                    self.jump(*exit);
                }
            }
            Op::ForStep { slot } => {
                let (value, _, step) = self.for_state(*slot);
                let locals = &mut self.frame().locals;
                locals[*slot as usize] = match locals[*slot as usize] {
                    Value::Dnum(_) => Value::Dnum(value + step),
                    Value::Int(_) => Value::Int((value + step) as i64),
                    _ => Value::Num((value + step) as f32),
                };
            }
            Op::Call { routine, arguments } => {
                let limit = self.program.rules.recursion_limit;
                if self.memory.frames.len() >= limit {
                    return Err(MachineFault::RecursionLimit { limit });
                }
                self.call(*routine, *arguments);
            }
            Op::Return { value } => {
                let result = value.then(|| self.pop());
                self.leave();
                match (self.memory.frames.last_mut(), result) {
                    (None, _) => return Ok(Flow::End(Step::Finished)),
                    (Some(frame), Some(result)) => frame.operands.push(result),
                    (Some(_), None) => {}
                }
            }
            Op::MissingReturn => {
                let routine = self.frame().routine;
                return Err(MachineFault::NoReturnValue {
                    name: self.program.routines[routine as usize].name.clone(),
                });
            }
            Op::LoadErrorNumber => {
                let number = self.last_error;
                self.push(Value::Num(number as f32));
            }
            Op::Retry => return self.retry(),
            Op::TryNext => {
                let frame = self.frame();
                if let Some(handling) = frame.handling.take() {
                    frame.pc = handling.next;
                }
            }
            Op::ResetRetries => {
                self.frame().retries = 0;
            }
            Op::WaitBegin => {
                let now = system.call_time();
                self.frame().wait_started = Some(now);
            }
            Op::WaitElapsed => {
                let now = system.now();
                let start = self.frame().wait_started.unwrap_or(SimTime::ZERO);
                self.push(Value::Dnum((now - start).as_secs_f64()));
            }
            Op::Block(target) => {
                self.jump(*target);
                return Ok(Flow::Blocked);
            }
            Op::Fault(fault) => return Err((**fault).clone()),
            Op::Stop(reason) => return Ok(Flow::End(Step::Stopped(reason.clone()))),
            Op::CallByName { arguments } => self.call_by_name(*arguments)?,
            Op::Connect(routine) => self.connect(*routine)?,
            Op::LoadInterruptNumber => {
                let mut frames = self.memory.frames.iter().rev();
                let number = frames.find_map(|f| f.interrupt).unwrap_or(0);
                self.push(Value::Num(number as f32));
            }
            Op::EndUndo => {
                self.memory.frames.pop();
                match self.unwinding.take() {
                    Some((error, height)) => return Ok(self.unwind(error, height)),
                    None => return Ok(Flow::End(Step::Finished)),
                }
            }
            Op::CallBuiltin { .. } | Op::Raise | Op::Reraise | Op::RaiseError(_) => {
                unreachable!("handled by the loop")
            }
        }
        Ok(Flow::Next)
    }

    /// An integer must be one of the language.
    fn in_range(&self, value: Value) -> Result<Value, MachineFault> {
        let (lowest, highest) = self.program.rules.integers;
        match value {
            Value::Int(value) if !(lowest..=highest).contains(&value) => {
                Err(MachineFault::IntegerOverflow {
                    value,
                    lowest,
                    highest,
                })
            }
            value => Ok(value),
        }
    }

    fn begin_for(&mut self, slot: u32, stepped: bool) -> Result<(), MachineFault> {
        let step = stepped.then(|| self.pop());
        let end = self.pop();
        let start = self.pop();
        let descending = self.program.rules.for_counts_down && start.as_number() > end.as_number();
        let step = step.unwrap_or(Value::Num(if descending { -1.0 } else { 1.0 }));
        if step.as_number() == Some(0.0) {
            return Err(MachineFault::ZeroStep);
        }
        let locals = &mut self.frame().locals;
        locals[slot as usize] = start;
        locals[slot as usize + 1] = end;
        locals[slot as usize + 2] = step;
        Ok(())
    }

    fn for_state(&self, slot: u32) -> (f64, f64, f64) {
        let locals = &self.memory.frames.last().expect("inside a frame").locals;
        let number = |i: usize| locals[slot as usize + i].as_number().unwrap_or(0.0);
        (number(0), number(1), number(2))
    }

    fn local_reference(&self, slot: u32) -> Reference {
        let frame = self.memory.frames.len() - 1;
        match &self.memory.frames[frame].locals[slot as usize] {
            Value::Reference(reference) => reference.clone(),
            _ => Reference {
                root: Root::Local {
                    frame: frame as u32,
                    slot,
                },
                path: Vec::new(),
            },
        }
    }
}
