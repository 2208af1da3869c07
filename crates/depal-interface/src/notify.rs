//! Messages of notify steps, and command 601.

use depal_time::SimTime;
use depal_wire::Reply;

use crate::dispatch::Answer;
use crate::job::JobId;
use crate::session::Session;
use crate::vision_run::VisionState;
use crate::viz_run::VizRun;

/// A message that nobody has fetched.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Message {
    value: i32,
    /// From this time on it is gone.
    expires: SimTime,
}

impl Session {
    /// A run sends a message: it replaces one that still waits. Messages of runs that are no longer wanted,
    /// and values that are not positive, are ignored.
    pub(crate) fn take_message(&mut self, now: SimTime, sender: JobId, value: i32) {
        let is_viz = matches!(&self.viz, VizRun::Running { job_id, .. } if *job_id == sender);
        let is_vision = self.vision.values().any(
            |run| matches!(&run.state, VisionState::Running { job_id, .. } if *job_id == sender),
        );
        if value > 0 && (is_viz || is_vision) {
            self.message = Some(Message {
                value,
                expires: now + self.settings.notify_hold,
            });
        }
    }

    /// Reading consumes the message.
    pub(crate) fn get_notify(&mut self, now: SimTime) -> Answer {
        match self.message.take() {
            Some(message) if now < message.expires => Answer::Reply(Reply::Message(message.value)),
            _ => Answer::Wait {
                on_timeout: Reply::Message(0),
            },
        }
    }
}
