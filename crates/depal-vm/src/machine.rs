use std::sync::Arc;

use depal_time::SimTime;

use crate::execution::{RobotTask, RuntimeError, Step};
use crate::memory::{Frame, Handling, Interrupt, Memory, PendingCall, Trigger, element};
use crate::operators::{binary, unary};
use crate::system::{ProgramLocation, System};
use crate::{
    BinaryOp, CallContext, MachineFault, Op, Outcome, Program, RaisedError, Reference, Root, Value,
};

/// Runs a [`Program`], one statement a step. Cloning it is a snapshot of the whole task.
#[derive(Debug, Clone)]
pub struct Machine {
    program: Arc<Program>,
    memory: Memory,
    location: ProgramLocation,
    located_routine: Option<u32>,
    last_error: i64,
    ended: Option<Step>,
    single_cycle: bool,
    /// An error on its way through UNDO clauses to the frame of this height.
    unwinding: Option<(RaisedError, usize)>,
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
        let mut machine = Self {
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
            unwinding: None,
        };
        machine.begin();
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

    /// The program's data.
    pub fn memory(&self) -> &Memory {
        &self.memory
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
        let routine = &self.program.routines[frame.routine as usize];
        if self.located_routine != Some(frame.routine) {
            self.located_routine = Some(frame.routine);
            self.location.module.clone_from(&routine.module);
            self.location.routine.clone_from(&routine.name);
        }
        self.location.line = if frame.line == 0 {
            routine.line
        } else {
            frame.line
        };
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

    fn pop_reference(&mut self) -> Result<Reference, MachineFault> {
        match self.pop() {
            Value::Reference(reference) => Ok(reference),
            _ => Err(MachineFault::NotPresent),
        }
    }

    /// Hands an error to the nearest handler that takes it. `from_handler`: a handler gives it up itself.
    fn handle(&mut self, error: RaisedError, from_handler: bool) -> Flow {
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
            let takes = !give_up
                && handler.is_some_and(|handler| {
                    handler
                        .numbers
                        .as_ref()
                        .is_none_or(|numbers| numbers.contains(&error.number))
                });
            give_up = false;
            if takes {
                taker = Some(height);
                break;
            }
            if frame.interrupt.is_some() {
                // What an interrupt's routine does not handle stops the program.
                break;
            }
        }
        match taker {
            Some(height) => self.unwind(error, height),
            None => Flow::End(Step::Failed(failure)),
        }
    }

    /// Leaves all routines above the one that handles the error; each runs its UNDO clause first.
    fn unwind(&mut self, error: RaisedError, height: usize) -> Flow {
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
        frame.handling = Some(Handling {
            error,
            retry: frame.statement,
            next: frame.next,
        });
        frame.pc = handler.map_or(0, |handler| handler.entry);
        Flow::Next
    }

    /// Looks at what orders interrupts, and queues those whose time has come.
    fn watch(&mut self, system: &mut dyn System) {
        let Memory {
            globals,
            frames,
            interrupts,
            ..
        } = &mut self.memory;
        let mut over = Vec::new();
        for interrupt in &mut interrupts.connected {
            let fired = match &mut interrupt.trigger {
                Trigger::None => false,
                Trigger::Signal { name, wanted, last } => {
                    let value = system.signal(name).unwrap_or(*last);
                    let changed = value != *last;
                    *last = value;
                    changed && wanted.is_none_or(|wanted| wanted == value)
                }
                Trigger::Timer { period, due } => {
                    let passed = system.now() >= *due;
                    if passed {
                        *due += *period;
                    }
                    passed
                }
                Trigger::Change { variable, last } => {
                    let value = Memory::find(globals, frames, variable).unwrap_or(&Value::Absent);
                    let changed = value != last;
                    if changed {
                        *last = value.clone();
                    }
                    changed
                }
            };
            if fired && !interrupt.asleep {
                interrupts.queued.push_back(interrupt.number);
                if interrupt.once {
                    over.push(interrupt.number);
                }
            }
        }
        for number in over {
            if let Some(interrupt) = interrupts.find(number) {
                interrupt.trigger = Trigger::None;
            }
        }
    }

    /// Begins the routine of the next queued interrupt, unless one runs or they are held back.
    fn begin_interrupt(&mut self) {
        let busy = self.memory.frames.iter().any(|f| f.interrupt.is_some());
        let interrupts = &mut self.memory.interrupts;
        if busy || interrupts.disabled {
            return;
        }
        while let Some(number) = interrupts.queued.pop_front() {
            if let Some(routine) = interrupts.find(number).map(|i| i.routine) {
                self.push_frame(routine, Vec::new());
                self.frame().interrupt = Some(number);
                return;
            }
        }
    }

    fn connect(&mut self, routine: u32) -> Result<(), MachineFault> {
        let reference = self.pop_reference()?;
        let interrupts = &mut self.memory.interrupts;
        interrupts.given += 1;
        let number = interrupts.given;
        interrupts.connected.push(Interrupt {
            number,
            routine,
            trigger: Trigger::None,
            once: false,
            asleep: false,
        });
        self.memory.write(&reference, Value::Num(number as f32))
    }

    fn call_by_name(&mut self, count: u32) -> Result<(), MachineFault> {
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

    fn retry(&mut self) -> Result<Flow, MachineFault> {
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

    fn call_builtin(
        &mut self,
        system: &mut dyn System,
        builtin: u32,
        arguments: u32,
        result: bool,
    ) -> Result<Flow, RaisedError> {
        self.locate();
        let mut pending = match self.frame().pending.take() {
            Some(pending) => pending,
            None => PendingCall {
                arguments: self.pop_many(arguments),
                started: system.call_time(),
                notes: Vec::new(),
            },
        };
        let program = Arc::clone(&self.program);
        let mut context = CallContext {
            arguments: &mut pending.arguments,
            started: pending.started,
            notes: &mut pending.notes,
            memory: &mut self.memory,
            location: &self.location,
            rules: &program.rules,
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
            Outcome::Stop(reason) => Ok(Flow::End(Step::Stopped(reason))),
            Outcome::Restart if self.single_cycle => {
                Ok(Flow::End(Step::Stopped("ExitCycle".into())))
            }
            Outcome::Restart => {
                self.begin();
                Ok(Flow::Next)
            }
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
            Op::Unary(op) => {
                let value = unary(*op, self.pop())?;
                self.push(value);
            }
            Op::Binary(op) => {
                let right = self.pop();
                let left = self.pop();
                let value = binary(*op, left, right, self.program.rules.string_limit)?;
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
                let arguments = self.pop_many(*arguments);
                self.push_frame(*routine, arguments);
            }
            Op::Return { value } => {
                let result = value.then(|| self.pop());
                self.memory.frames.pop();
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

    fn begin_for(&mut self, slot: u32, stepped: bool) -> Result<(), MachineFault> {
        let step = stepped.then(|| self.pop());
        let end = self.pop();
        let start = self.pop();
        let descending = start.as_number() > end.as_number();
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

    fn dispatch(&mut self, system: &mut dyn System, op: &Op) -> Flow {
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

    /// The error for a number: the language's own if the program passes one on, else the user's.
    fn user_error(&self, number: f64) -> RaisedError {
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

/// The operations of plain 32-bit arithmetic, which most loops consist of, without a call for each.
/// Runs as many as there are from here on and stops, still before it, at the first that is not one of them or
/// does not find plain numbers. Whether it ran any.
fn run_plain(frame: &mut Frame, globals: &mut [Value], code: &[Op]) -> bool {
    let begin = frame.pc;
    let mut pc = frame.pc as usize;
    let plain = |value: &Value| match value {
        Value::Num(v) => Some(*v),
        _ => None,
    };
    let result = loop {
        match code.get(pc) {
            Some(Op::LoadGlobal(slot)) => {
                let Some(v) = plain(&globals[*slot as usize]) else {
                    break pc;
                };
                frame.operands.push(Value::Num(v));
            }
            Some(Op::LoadLocal(slot)) => {
                let Some(v) = plain(&frame.locals[*slot as usize]) else {
                    break pc;
                };
                frame.operands.push(Value::Num(v));
            }
            Some(Op::Push(Value::Num(v))) => frame.operands.push(Value::Num(*v)),
            Some(Op::StoreGlobal(slot)) => {
                let (Some(Value::Num(v)), Value::Num(target)) =
                    (frame.operands.last(), &mut globals[*slot as usize])
                else {
                    break pc;
                };
                *target = *v;
                frame.operands.pop();
            }
            Some(Op::StoreLocal(slot)) => {
                let (Some(Value::Num(v)), Value::Num(target)) =
                    (frame.operands.last(), &mut frame.locals[*slot as usize])
                else {
                    break pc;
                };
                *target = *v;
                frame.operands.pop();
            }
            Some(Op::Binary(op)) => {
                let [.., Value::Num(left), Value::Num(right)] = frame.operands.as_mut_slice()
                else {
                    break pc;
                };
                // Sum, difference and product of two f32 are the same rounded once from f64.
                let (a, b) = (*left, *right);
                let value = match op {
                    BinaryOp::Add => Value::Num(a + b),
                    BinaryOp::Subtract => Value::Num(a - b),
                    BinaryOp::Multiply => Value::Num(a * b),
                    BinaryOp::Less => Value::Bool(a < b),
                    BinaryOp::LessOrEqual => Value::Bool(a <= b),
                    BinaryOp::Greater => Value::Bool(a > b),
                    BinaryOp::GreaterOrEqual => Value::Bool(a >= b),
                    BinaryOp::Equal => Value::Bool(a == b),
                    BinaryOp::NotEqual => Value::Bool(a != b),
                    _ => break pc,
                };
                frame.operands.pop();
                if let Some(top) = frame.operands.last_mut() {
                    *top = value;
                }
            }
            Some(Op::Jump(target)) => {
                pc = *target as usize;
                continue;
            }
            Some(Op::JumpIfFalse(target)) => {
                let Some(Value::Bool(holds)) = frame.operands.last() else {
                    break pc;
                };
                let holds = *holds;
                frame.operands.pop();
                if !holds {
                    pc = *target as usize;
                    continue;
                }
            }
            Some(Op::ForTest { slot, exit }) => {
                let at = *slot as usize;
                let [Value::Num(value), Value::Num(end), Value::Num(step)] =
                    &frame.locals[at..at + 3]
                else {
                    break pc;
                };
                let over = if *step > 0.0 {
                    value > end
                } else {
                    value < end
                };
                if over {
                    pc = *exit as usize;
                    continue;
                }
            }
            Some(Op::ForStep { slot }) => {
                let at = *slot as usize;
                let [Value::Num(value), _, Value::Num(step)] = &mut frame.locals[at..at + 3] else {
                    break pc;
                };
                *value += *step;
            }
            _ => break pc,
        }
        pc += 1;
    };
    frame.pc = result as u32;
    // A jump to itself alone would be no progress; there is none without a statement between.
    frame.pc != begin
}

impl RobotTask for Machine {
    fn step(&mut self, system: &mut dyn System) -> Step {
        if let Some(step) = &self.ended {
            return step.clone();
        }
        if !self.memory.interrupts.connected.is_empty() {
            self.watch(system);
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
                if frame.handling.is_none() && frame.retried_statement != Some(frame.pc) {
                    frame.retried_statement = None;
                }
                if frame.handling.is_none() {
                    frame.statement = frame.pc;
                    frame.next = *next;
                }
                frame.line = *line;
                frame.pc += 1;
                self.locate();
                system.statement(&self.location);
                continue;
            }
            if run_plain(frame, &mut self.memory.globals, code) {
                begun |= frame.line > 0;
                continue;
            }
            let Some(op) = code.get(frame.pc as usize) else {
                break Step::Finished;
            };
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
