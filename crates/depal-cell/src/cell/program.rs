//! What the cabinet tells of its program and its motion, as events of the cell.

use depal_controller::ControllerEvent;

use super::Cell;
use crate::event::EventKind;

impl Cell {
    /// Takes over what the cabinet has told since the last tick.
    pub(super) fn take_controller_events(&mut self) {
        while let Some(event) = self.controller.poll_event() {
            let kind = match event {
                ControllerEvent::Statement { location, .. } => EventKind::ProgramLine {
                    module: location.module,
                    routine: location.routine,
                    line: location.line,
                },
                ControllerEvent::SignalEdge { name, value, .. } => {
                    EventKind::Signal { name, value }
                }
                ControllerEvent::MoveStarted { location, .. } => EventKind::MoveStarted {
                    module: location.module,
                    line: location.line,
                },
                ControllerEvent::CornerFailure { location, .. } => EventKind::CornerPathFailure {
                    module: location.module,
                    line: location.line,
                },
                ControllerEvent::Log { text, .. } => {
                    self.last_message.clone_from(&text);
                    EventKind::Message { text }
                }
                ControllerEvent::MotionStopped { reason, .. } => EventKind::Message {
                    text: format!("motion stopped: {reason}"),
                },
                ControllerEvent::MotionHeld { .. } => EventKind::Message {
                    text: "motion held on its path".to_owned(),
                },
                ControllerEvent::MotionResumed { .. } => EventKind::Message {
                    text: "motion goes on".to_owned(),
                },
                ControllerEvent::Answered {
                    instruction,
                    text,
                    answer,
                    ..
                } => EventKind::Message {
                    text: format!("{instruction} {text}: answered {answer}"),
                },
                ControllerEvent::MoveReached { .. } | ControllerEvent::TaskEnded { .. } => continue,
            };
            self.pending.push(kind);
        }
    }
}
