use std::sync::Arc;
use std::task::Poll;

use depal_arm::Arm;
use depal_frames::{JointPositions, Point, Pose};
use depal_time::SimTime;
use depal_vm::system::{Fault, MoveId, MoveRequest, PathEvent};

use crate::ControllerEvent;
use crate::free_motion::{FreeMotion, free_forward, free_inverse};
use crate::motion_queue::MotionQueue;
use crate::path_events::Fired;

/// What the cabinet moves: an arm with its queue, or a mechanism that reaches everything.
#[derive(Debug, Clone)]
pub(crate) enum Mechanism {
    Arm(Arc<Arm>, Box<MotionQueue>),
    Free(FreeMotion),
}

impl Mechanism {
    pub fn arm(&self) -> Option<&Arc<Arm>> {
        match self {
            Self::Arm(arm, _) => Some(arm),
            Self::Free(_) => None,
        }
    }

    pub fn start(
        &mut self,
        now: SimTime,
        request: &MoveRequest,
        along: &[PathEvent],
        events: &mut Vec<ControllerEvent>,
    ) -> Poll<Result<MoveId, Fault>> {
        match self {
            Self::Arm(_, queue) => queue.start(now, request, along, events),
            Self::Free(free) => free.start(now, request, along),
        }
    }

    /// What hangs on the flange in moves to come, kg and m in the flange frame; none for what the cabinet was set up with.
    pub fn set_tool_load(&mut self, load: Option<(f64, Point)>) {
        if let Self::Arm(_, queue) = self {
            queue.set_tool_load(load);
        }
    }

    /// Load of moves to come, kg and m in the tool frame. What reaches everything carries everything.
    pub fn set_payload(&mut self, mass: f64, centre_in_tcp: Point) {
        if let Self::Arm(_, queue) = self {
            queue.set_payload(mass, centre_in_tcp);
        }
    }

    pub fn is_begun(&self, now: SimTime, id: MoveId) -> bool {
        match self {
            Self::Arm(_, queue) => queue.is_begun(now, id),
            Self::Free(free) => free.is_begun(now, id),
        }
    }

    /// Whether the arm stands until the program does something: nothing is queued, or the path is held.
    pub fn is_resting(&self, now: SimTime) -> bool {
        match self {
            Self::Arm(_, queue) => queue.is_resting(now),
            Self::Free(free) => free.is_resting(now),
        }
    }

    pub fn clear(&mut self, now: SimTime, reason: &str, events: &mut Vec<ControllerEvent>) {
        match self {
            Self::Arm(_, queue) => queue.clear(now, reason, events),
            Self::Free(free) => free.clear(now, reason, events),
        }
    }

    pub fn is_held(&self) -> bool {
        match self {
            Self::Arm(_, queue) => queue.is_held(),
            Self::Free(free) => free.is_held(),
        }
    }

    pub fn hold(&mut self, now: SimTime, events: &mut Vec<ControllerEvent>) -> Poll<()> {
        match self {
            Self::Arm(_, queue) => queue.hold(now, events),
            Self::Free(free) => free.hold(now, events),
        }
    }

    pub fn resume(&mut self, now: SimTime, events: &mut Vec<ControllerEvent>) {
        match self {
            Self::Arm(_, queue) => queue.resume(now, events),
            Self::Free(free) => free.resume(now, events),
        }
    }

    pub fn store(
        &mut self,
        now: SimTime,
        events: &mut Vec<ControllerEvent>,
    ) -> Poll<Result<(), Fault>> {
        match self {
            Self::Arm(_, queue) => queue.store(now, events).map(Ok),
            Self::Free(free) => free.store(now, events).map(Ok),
        }
    }

    pub fn restore(&mut self, now: SimTime) -> Result<(), Fault> {
        match self {
            Self::Arm(_, queue) => queue.restore(now),
            Self::Free(free) => free.restore(now),
        }
    }

    pub fn is_done(&self, now: SimTime, id: MoveId) -> Result<bool, Fault> {
        match self {
            Self::Arm(_, queue) => queue.is_done(now, id),
            Self::Free(free) => Ok(free.is_done(now, id)),
        }
    }

    pub fn is_standing(&self, now: SimTime) -> bool {
        match self {
            Self::Arm(_, queue) => queue.is_standing(now),
            Self::Free(free) => free.is_standing(now),
        }
    }

    pub fn stop(&mut self, now: SimTime, reason: &str, events: &mut Vec<ControllerEvent>) {
        match self {
            Self::Arm(_, queue) => queue.stop(now, reason, events),
            Self::Free(free) => free.stop(now, reason, events),
        }
    }

    /// A mechanism without an arm has nothing to hit; a report stops it all the same.
    pub fn supervise(&mut self, now: SimTime, message: &str, events: &mut Vec<ControllerEvent>) {
        match self {
            Self::Arm(_, queue) => queue.supervise(now, message, events),
            Self::Free(free) => free.stop(now, message, events),
        }
    }

    /// What the arm passes until `end`, by time.
    pub fn advance(
        &mut self,
        begin: SimTime,
        end: SimTime,
        events: &mut Vec<ControllerEvent>,
    ) -> Vec<Fired> {
        match self {
            Self::Arm(_, queue) => queue.advance(begin, end, events),
            Self::Free(free) => free.advance(begin, end, events),
        }
    }

    pub fn joints(&self, now: SimTime) -> JointPositions {
        match self {
            Self::Arm(_, queue) => queue.joints(now),
            Self::Free(free) => free.joints(now),
        }
    }

    pub fn planned_joints(&self) -> JointPositions {
        match self {
            Self::Arm(_, queue) => queue.planned_joints(),
            Self::Free(free) => free.planned_joints(),
        }
    }

    pub fn corner_failures(&self) -> usize {
        match self {
            Self::Arm(_, queue) => queue.corner_failures(),
            Self::Free(_) => 0,
        }
    }

    pub fn forward(&self, joints: &JointPositions) -> Pose {
        match self {
            Self::Arm(arm, _) => arm.base_from_flange(joints),
            Self::Free(_) => free_forward(joints),
        }
    }

    pub fn inverse(
        &self,
        base_from_flange: &Pose,
        near: &JointPositions,
    ) -> Option<JointPositions> {
        match self {
            Self::Arm(arm, _) => arm.inverse_nearest(base_from_flange, near),
            Self::Free(_) => Some(free_inverse(base_from_flange)),
        }
    }
}
