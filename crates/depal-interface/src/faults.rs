//! Faults on demand while a server runs: how often each occasion has come, and what it brings.

use depal_time::{SimDuration, SimTime};
use depal_wire::Status;

use crate::fault_script::{Effect, Fault, FaultScript, Occasion};

/// A fault and how often its occasion has come.
#[derive(Debug, Clone)]
struct Armed {
    fault: Fault,
    seen: u32,
}

impl Armed {
    fn all(script: &FaultScript, wanted: impl Fn(&Effect) -> bool) -> Vec<Self> {
        let faults = script.faults.iter();
        faults
            .filter(|fault| wanted(&fault.effect))
            .map(|fault| Self {
                fault: fault.clone(),
                seen: 0,
            })
            .collect()
    }

    /// Counts one more, whether it is the wanted one.
    fn counts(&mut self, n: Option<u32>) -> bool {
        self.seen = self.seen.saturating_add(1);
        n.is_none_or(|n| n == self.seen)
    }

    /// Counts a command or the reply to it, whether the fault hits it.
    fn hits(&mut self, on: Occasion, command: i32) -> bool {
        on.command.is_none_or(|wanted| wanted == command) && self.counts(on.n)
    }
}

/// What becomes of a reply.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct ReplyFate {
    pub(crate) delay: SimDuration,
    pub(crate) drops: bool,
    pub(crate) splits: bool,
    /// The faults that hit it, as the user wrote them.
    pub(crate) causes: Vec<String>,
}

/// The faults of one port's dialogue.
#[derive(Debug, Clone)]
pub(crate) struct DialogueFaults {
    commands: Vec<Armed>,
    replies: Vec<Armed>,
    cameras: Vec<Armed>,
}

impl DialogueFaults {
    pub(crate) fn new(script: &FaultScript) -> Self {
        Self {
            commands: Armed::all(script, |effect| matches!(effect, Effect::Status { .. })),
            replies: Armed::all(script, |effect| {
                matches!(
                    effect,
                    Effect::Delay { .. }
                        | Effect::DropConnection { .. }
                        | Effect::SplitReplies { .. }
                )
            }),
            cameras: Armed::all(script, |effect| matches!(effect, Effect::CameraLost { .. })),
        }
    }

    /// A command has come: the status that it gets instead of being carried out, and why.
    pub(crate) fn on_command(&mut self, command: i32) -> Option<(Status, String)> {
        let mut refused = None;
        for armed in &mut self.commands {
            if let Effect::Status { status, on } = armed.fault.effect
                && armed.hits(on, command)
            {
                refused.get_or_insert_with(|| (status, armed.fault.text.clone()));
            }
        }
        refused
    }

    /// A reply is about to leave.
    pub(crate) fn on_reply(&mut self, command: i32) -> ReplyFate {
        let mut fate = ReplyFate::default();
        for armed in &mut self.replies {
            let (Effect::Delay { on, .. }
            | Effect::DropConnection { on }
            | Effect::SplitReplies { on }) = armed.fault.effect
            else {
                continue;
            };
            if !armed.hits(on, command) {
                continue;
            }
            match armed.fault.effect {
                Effect::Delay { time, .. } => fate.delay = fate.delay + time,
                Effect::DropConnection { .. } => fate.drops = true,
                _ => fate.splits = true,
            }
            fate.causes.push(armed.fault.text.clone());
        }
        fate
    }

    /// Whether the camera is gone at `now`; 901 tells it.
    pub(crate) fn camera_is_lost(&self, now: SimTime) -> bool {
        camera_is_lost(&self.cameras, now)
    }
}

/// The faults of the pictures that one port asks for: whoever takes them asks here.
#[derive(Debug, Clone)]
pub struct FrameFaults {
    pictures: Vec<Armed>,
    cameras: Vec<Armed>,
}

impl FrameFaults {
    /// Before the first picture.
    pub fn new(script: &FaultScript) -> Self {
        Self {
            pictures: Armed::all(script, |effect| matches!(effect, Effect::NoPoints { .. })),
            cameras: Armed::all(script, |effect| matches!(effect, Effect::CameraLost { .. })),
        }
    }

    /// Counts a picture: whether it shall show no carton.
    pub fn frame_is_empty(&mut self) -> bool {
        let mut is_empty = false;
        for armed in &mut self.pictures {
            if let Effect::NoPoints { pick } = armed.fault.effect {
                is_empty |= armed.counts(pick);
            }
        }
        is_empty
    }

    /// Whether no picture can be taken at `now`.
    pub fn camera_is_lost(&self, now: SimTime) -> bool {
        camera_is_lost(&self.cameras, now)
    }
}

fn camera_is_lost(cameras: &[Armed], now: SimTime) -> bool {
    let is_lost =
        |armed: &Armed| matches!(armed.fault.effect, Effect::CameraLost { from } if from <= now);
    cameras.iter().any(is_lost)
}
