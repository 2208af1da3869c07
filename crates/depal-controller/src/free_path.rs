//! Holding and putting aside the path of a mechanism that reaches everything.

use std::task::Poll;

use depal_time::SimTime;
use depal_vm::system::{Fault, MoveId};

use crate::ControllerEvent;
use crate::free_motion::FreeMotion;

/// How far from the stored path the mechanism may stand when it is taken up again, metres or radians.
const BESIDE: f64 = 1e-6;

impl FreeMotion {
    /// The time of the motion: it stands while held.
    pub fn clock(&self, now: SimTime) -> SimTime {
        self.held.map_or(now, |held| held.min(now))
    }

    pub fn is_begun(&self, now: SimTime, id: MoveId) -> bool {
        let now = self.clock(now);
        self.open.iter().all(|m| m.id != id || m.begin <= now)
    }

    pub fn is_resting(&self, now: SimTime) -> bool {
        self.held.is_some() || self.is_standing(now)
    }

    pub fn is_held(&self) -> bool {
        self.held.is_some()
    }

    /// Stands at once: it has no mass.
    pub fn hold(&mut self, now: SimTime, events: &mut Vec<ControllerEvent>) -> Poll<()> {
        if self.held.is_none() {
            if !self.is_standing(now) {
                events.push(ControllerEvent::MotionHeld { at: now });
            }
            self.held = Some(now);
        }
        Poll::Ready(())
    }

    pub fn resume(&mut self, now: SimTime, events: &mut Vec<ControllerEvent>) {
        let standing = self.is_standing(now);
        let Some(held) = self.held.take() else {
            return;
        };
        let later = now.saturating_since(held);
        for open in self.open.iter_mut().filter(|m| m.end > held) {
            open.begin += later;
            open.end += later;
        }
        if !standing {
            events.push(ControllerEvent::MotionResumed { at: now });
        }
    }

    pub fn store(&mut self, now: SimTime, events: &mut Vec<ControllerEvent>) -> Poll<()> {
        let was_held = self.held.is_some();
        let _ = self.hold(now, events);
        let rest = self.joints(now);
        let held = self.held.take().unwrap_or(now);
        // The times of what is put aside count from the instant of the hold.
        let mut open = std::mem::take(&mut self.open);
        open.retain(|m| m.end > held);
        let mut frozen = Self::new(0);
        frozen.open = open;
        frozen.rest = rest;
        frozen.held = Some(held);
        self.stored.push((frozen, was_held));
        self.rest = rest;
        Poll::Ready(())
    }

    pub fn restore(&mut self, now: SimTime) -> Result<(), Fault> {
        if !self.is_standing(now) {
            return Err(Fault::NotThere {
                message: "a way to take up a stored path while the arm moves".to_owned(),
            });
        }
        let here = self.joints(now);
        let Some((stored, was_held)) = self.stored.last() else {
            return Err(Fault::NotThere {
                message: "a stored path; call StorePath first".to_owned(),
            });
        };
        let beside = stored.joints(now).max_distance(&here);
        if beside > BESIDE {
            return Err(Fault::OutOfReach {
                message: format!(
                    "the flange is {:.3} mm or mrad away from where the path was stored; move back there before RestoPath",
                    beside * 1e3
                ),
            });
        }
        let was_held = *was_held;
        if let Some((stored, _)) = self.stored.pop() {
            self.open = stored.open;
            self.rest = stored.rest;
            self.held = stored.held;
            if !was_held {
                self.resume(now, &mut Vec::new());
            }
        }
        Ok(())
    }

    /// Drops the path that is held; the hold stays.
    pub fn clear(&mut self, now: SimTime, reason: &str, events: &mut Vec<ControllerEvent>) {
        let held = self.held;
        self.stop(now, reason, events);
        self.held = held.map(|_| now);
    }

    /// The moves that are put aside.
    pub fn aside(&self) -> impl Iterator<Item = MoveId> {
        self.stored
            .iter()
            .flat_map(|(path, _)| path.open.iter().map(|m| m.id))
    }
}
