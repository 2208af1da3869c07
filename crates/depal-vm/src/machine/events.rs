use super::{Flow, Machine};
use crate::execution::Step;

impl Machine {
    /// Puts event routines on the call stack, the first of them on top.
    pub(super) fn push_events(&mut self, routines: &[u32]) {
        for routine in routines.iter().rev() {
            self.push_frame(*routine, Vec::new());
            self.frame().is_event = true;
        }
    }

    /// The program stops itself; what is to run at that event runs first.
    pub(super) fn stop(&mut self, reason: String) -> Flow {
        let step = Step::Stopped(reason);
        if self.stopping.is_some() || self.program.events.on_stop.is_empty() {
            return Flow::End(step);
        }
        self.stopping = Some((self.memory.frames.len(), step));
        let routines = self.program.events.on_stop.clone();
        self.push_events(&routines);
        Flow::Next
    }

    /// How the program stopped, if the routines of that event have just ended.
    pub(super) fn stopped(&mut self) -> Option<Flow> {
        let (height, _) = self.stopping.as_ref()?;
        if *height < self.memory.frames.len() {
            return None;
        }
        self.stopping.take().map(|(_, step)| Flow::End(step))
    }

    /// Goes on behind the statement with which the program stopped itself. Whether it had.
    pub(super) fn go_on(&mut self) -> bool {
        if !matches!(self.ended, Some(Step::Stopped(_))) || self.memory.frames.is_empty() {
            return false;
        }
        self.ended = None;
        let routines = self.program.events.on_restart.clone();
        self.push_events(&routines);
        true
    }
}
