use std::sync::Arc;

use super::{Flow, Machine};
use crate::execution::Step;
use crate::memory::{Interrupt, Interrupts, Memory, Trigger};
use crate::system::System;
use crate::{MachineFault, Value};

/// Most operations of a condition.
const CONDITION_LIMIT: u32 = 100_000;

impl Machine {
    /// Looks at what orders interrupts, and queues those whose time has come.
    /// A condition that cannot be computed ends the program.
    pub(super) fn watch(&mut self, system: &mut dyn System) -> Result<(), Step> {
        let height = self.memory.frames.len() as u32;
        let interrupts = &mut self.memory.interrupts;
        interrupts.connected.retain(|i| i.level <= height);
        let Interrupts {
            connected,
            queued,
            reported,
            ..
        } = interrupts;
        queued.retain(|number| connected.iter().any(|i| i.number == *number));
        reported.retain(|(number, _)| connected.iter().any(|i| i.number == *number));
        for index in 0..self.memory.interrupts.connected.len() {
            let interrupt = &self.memory.interrupts.connected[index];
            let number = interrupt.number;
            let Trigger::Condition { routine, last } = interrupt.trigger else {
                continue;
            };
            if interrupt.asleep {
                continue;
            }
            let now = self.evaluate(system, routine)?;
            let interrupts = &mut self.memory.interrupts;
            interrupts.connected[index].trigger = Trigger::Condition {
                routine,
                last: Some(now),
            };
            // A change while its routine still waits is not a second one.
            if last == Some(false) && now && !interrupts.queued.contains(&number) {
                interrupts.queued.push_back(number);
            }
        }
        self.watch_events(system);
        Ok(())
    }

    /// The truth value of a condition. One that has to wait is not true yet.
    fn evaluate(&mut self, system: &mut dyn System, routine: u32) -> Result<bool, Step> {
        let program = Arc::clone(&self.program);
        let height = self.memory.frames.len();
        self.push_frame(routine, Vec::new());
        self.frame().line = program.routines[routine as usize].line;
        let mut operations = 0;
        while self.memory.frames.len() > height {
            operations += 1;
            if operations > CONDITION_LIMIT {
                let message = "the condition of an interrupt takes too long".into();
                let error = (program.rules.raise)(&MachineFault::Argument { message });
                if let Flow::End(step) = self.handle(error, true) {
                    return Err(step);
                }
                return Ok(false);
            }
            let frame = self.frame();
            let code = &program.routines[frame.routine as usize].code;
            let Some(op) = code.get(frame.pc as usize) else {
                break;
            };
            frame.pc += 1;
            match self.dispatch(system, op) {
                Flow::Next => {}
                Flow::Blocked => {
                    self.memory.frames.truncate(height);
                    return Ok(false);
                }
                Flow::End(step) => return Err(step),
            }
        }
        let frame = self.memory.frames.last_mut();
        let value = frame.and_then(|frame| frame.operands.pop());
        Ok(value == Some(Value::Bool(true)))
    }

    fn watch_events(&mut self, system: &mut dyn System) {
        let Memory {
            globals,
            frames,
            interrupts,
            ..
        } = &mut self.memory;
        let mut over = Vec::new();
        for interrupt in &mut interrupts.connected {
            let fired = match &mut interrupt.trigger {
                Trigger::None | Trigger::Condition { .. } | Trigger::Report(_) => false,
                Trigger::Move {
                    id,
                    ends,
                    delay,
                    reached,
                } => {
                    let now = system.now();
                    let there = if *ends {
                        // A move that failed is told where the program waits for it.
                        system.is_move_done(*id).unwrap_or(false)
                    } else {
                        system.is_move_begun(*id)
                    };
                    if there && reached.is_none() {
                        *reached = Some(now);
                    }
                    reached.is_some_and(|at| now.saturating_since(at) >= *delay)
                }
                Trigger::Signal { name, wanted, last } => {
                    let value = system.signal(name).unwrap_or(*last);
                    let changed = value != *last;
                    *last = value;
                    changed && wanted.is_none_or(|wanted| wanted == value)
                }
                Trigger::Level {
                    name,
                    wanted,
                    step,
                    direction,
                    last,
                } => {
                    let value = system.signal(name).unwrap_or(*last);
                    let moved = match direction.signum() {
                        1 => value - *last,
                        -1 => *last - value,
                        _ => (value - *last).abs(),
                    };
                    let came = moved > *step && wanted.holds(value);
                    if came {
                        *last = value;
                    }
                    came
                }
                Trigger::Notice { name, last } => {
                    let count = system.notices(name);
                    let came = count > *last;
                    *last = count;
                    came
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
    pub(super) fn begin_interrupt(&mut self) {
        let served = self.memory.frames.iter().rev().find_map(|f| f.interrupt);
        let interrupts = &mut self.memory.interrupts;
        if interrupts.disabled {
            return;
        }
        if interrupts.connected.iter().any(|i| i.priority.is_some()) {
            self.begin_by_priority(served);
            return;
        }
        if served.is_some() {
            return;
        }
        while let Some(number) = interrupts.queued.pop_front() {
            if let Some(routine) = interrupts.find(number).map(|i| i.routine) {
                self.serve(routine, number);
                return;
            }
        }
    }

    /// Begins the most urgent queued interrupt if it is more urgent than the one being served.
    fn begin_by_priority(&mut self, served: Option<u32>) {
        let interrupts = &mut self.memory.interrupts;
        let urgency = |number: u32, all: &[Interrupt]| {
            let found = all.iter().find(|i| i.number == number);
            found.and_then(|i| i.priority).unwrap_or(u32::MAX)
        };
        let current = served.map(|number| urgency(number, &interrupts.connected));
        let ready = interrupts.connected.iter().filter(|i| {
            !i.held
                && interrupts.queued.contains(&i.number)
                && current.is_none_or(|current| i.priority.unwrap_or(u32::MAX) < current)
        });
        let Some((number, routine)) = ready
            .min_by_key(|i| (i.priority.unwrap_or(u32::MAX), i.number))
            .map(|i| (i.number, i.routine))
        else {
            return;
        };
        interrupts.queued.retain(|queued| *queued != number);
        self.serve(routine, number);
    }

    /// Begins the routine of an interrupt.
    fn serve(&mut self, routine: u32, number: u32) {
        let report = self.memory.take_report(number);
        self.push_frame(routine, Vec::new());
        let frame = self.frame();
        frame.interrupt = Some(number);
        frame.report = report;
    }

    /// Goes on in the routine that declared the interrupt being served.
    pub(super) fn resume(&mut self) -> Result<(), MachineFault> {
        let served = self.memory.frames.iter().rev().find_map(|f| f.interrupt);
        let declared = served.and_then(|number| self.memory.interrupts.find(number));
        let level = declared.map_or(0, |interrupt| interrupt.level as usize);
        if level == 0 || level > self.memory.frames.len() {
            return Err(MachineFault::Argument {
                message: "RESUME has its place in the routine of an interrupt".into(),
            });
        }
        self.memory.frames.truncate(level);
        let frame = self.frame();
        frame.operands.clear();
        frame.pending = None;
        frame.wait_started = None;
        frame.pc = frame.next;
        Ok(())
    }

    pub(super) fn connect(&mut self, routine: u32) -> Result<(), MachineFault> {
        let reference = self.pop_reference()?;
        let interrupts = &mut self.memory.interrupts;
        interrupts.given += 1;
        let number = interrupts.given;
        interrupts.connected.push(Interrupt {
            number,
            routine,
            trigger: Trigger::None,
            ..Interrupt::default()
        });
        self.memory.write(&reference, Value::Num(number as f32))
    }
}
