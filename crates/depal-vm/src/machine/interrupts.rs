use super::Machine;
use crate::memory::{Interrupt, Memory, Trigger};
use crate::system::System;
use crate::{MachineFault, Value};

impl Machine {
    /// Looks at what orders interrupts, and queues those whose time has come.
    pub(super) fn watch(&mut self, system: &mut dyn System) {
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

    pub(super) fn connect(&mut self, routine: u32) -> Result<(), MachineFault> {
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
}
