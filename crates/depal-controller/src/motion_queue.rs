use std::cell::Cell;
use std::collections::{BTreeMap, VecDeque};
use std::task::Poll;

use depal_frames::JointPositions;
use depal_motion::{Interpolation, Segment, SegmentId, SegmentTarget, Speed, Trajectory, Zone};
use depal_time::{SimDuration, SimTime};
use depal_vm::system::{
    Fault, MoveId, MoveKind, MoveRequest, MoveTarget, MoveZone, ProgramLocation,
};

use crate::ControllerEvent;

/// Accepted moves and the path that they make.
#[derive(Debug, Clone)]
pub(crate) struct MotionQueue {
    trajectory: Trajectory,
    depth: usize,
    /// In order; the first is under way or about to be.
    open: VecDeque<OpenMove>,
    /// The move that was closed last: its corner may still turn out to be a stop.
    closed: Option<OpenMove>,
    /// Moves that the supervision broke off.
    broken: BTreeMap<MoveId, String>,
    /// A supervision stop that the program may not know of yet.
    alarm: Option<Alarm>,
    /// Corner failures already told.
    failures_told: usize,
}

#[derive(Debug, Clone)]
struct OpenMove {
    id: MoveId,
    location: ProgramLocation,
    started: bool,
}

#[derive(Debug, Clone)]
struct Alarm {
    message: String,
    /// Asking whether a move is done may tell it, and asking does not change the queue otherwise.
    told: Cell<bool>,
}

impl MotionQueue {
    pub fn new(trajectory: Trajectory, depth: usize) -> Self {
        Self {
            trajectory,
            depth,
            open: VecDeque::new(),
            closed: None,
            broken: BTreeMap::new(),
            alarm: None,
            failures_told: 0,
        }
    }

    /// Takes a move, unless the queue is full.
    pub fn start(
        &mut self,
        now: SimTime,
        request: &MoveRequest,
        events: &mut Vec<ControllerEvent>,
    ) -> Poll<Result<MoveId, Fault>> {
        if let Some(alarm) = self.alarm.take()
            && !alarm.told.get()
        {
            return Poll::Ready(Err(Fault::MotionSupervision {
                message: alarm.message,
            }));
        }
        let seconds = now.as_secs_f64();
        let unfinished = self
            .open
            .iter()
            .filter(|m| !self.trajectory.is_done(SegmentId(m.id.0), seconds))
            .count();
        // One is under way, the others wait.
        if unfinished > self.depth {
            return Poll::Pending;
        }
        let id = match self.trajectory.append(seconds, &segment(request)) {
            Ok(id) => MoveId(id.0),
            Err(error) => {
                return Poll::Ready(Err(Fault::OutOfReach {
                    message: error.to_string(),
                }));
            }
        };
        let failures = self.trajectory.corner_failures();
        for failed in &failures[self.failures_told..] {
            let known = self.open.iter().chain(&self.closed);
            let location = known.into_iter().find(|m| m.id.0 == failed.0);
            events.push(ControllerEvent::CornerFailure {
                at: now,
                id: MoveId(failed.0),
                location: location.map(|m| m.location.clone()).unwrap_or_default(),
            });
        }
        self.failures_told = failures.len();
        self.open.push_back(OpenMove {
            id,
            location: request.location.clone(),
            started: false,
        });
        Poll::Ready(Ok(id))
    }

    /// Whether a move is over. A move that the supervision broke off is an error for ever.
    pub fn is_done(&self, now: SimTime, id: MoveId) -> Result<bool, Fault> {
        if let Some(message) = self.broken.get(&id) {
            if let Some(alarm) = &self.alarm {
                alarm.told.set(true);
            }
            return Err(Fault::MotionSupervision {
                message: message.clone(),
            });
        }
        Ok(self.trajectory.is_done(SegmentId(id.0), now.as_secs_f64()))
    }

    pub fn is_standing(&self, now: SimTime) -> bool {
        now.as_secs_f64() >= self.trajectory.duration()
    }

    /// Brakes and drops the queue.
    pub fn stop(&mut self, now: SimTime, reason: &str, events: &mut Vec<ControllerEvent>) {
        let seconds = now.as_secs_f64();
        if self.open.is_empty() && self.is_standing(now) {
            return;
        }
        self.trajectory.stop(seconds);
        events.push(ControllerEvent::MotionStopped {
            at: now,
            dropped: self.open.drain(..).map(|m| m.id).collect(),
            reason: reason.to_owned(),
        });
    }

    /// Brakes because something was hit: all moves that are not over become errors.
    pub fn supervise(&mut self, now: SimTime, message: &str, events: &mut Vec<ControllerEvent>) {
        let seconds = now.as_secs_f64();
        for open in &self.open {
            if !self.trajectory.is_done(SegmentId(open.id.0), seconds) {
                self.broken.insert(open.id, message.to_owned());
            }
        }
        self.alarm = Some(Alarm {
            message: message.to_owned(),
            told: Cell::new(false),
        });
        self.stop(now, message, events);
    }

    /// Reports what starts and ends until `end`, and forgets what lies before `begin`.
    pub fn advance(&mut self, begin: SimTime, end: SimTime, events: &mut Vec<ControllerEvent>) {
        let instant = |seconds: f64| SimTime::ZERO + SimDuration::from_secs_f64(seconds);
        let until = end.as_secs_f64();
        for open in &mut self.open {
            let segment = SegmentId(open.id.0);
            let over = self.trajectory.is_done(segment, until);
            let start = self.trajectory.start_time(segment);
            if !open.started && (over || start.is_some_and(|s| s <= until)) {
                open.started = true;
                events.push(ControllerEvent::MoveStarted {
                    at: start.map_or(begin, instant).max(begin),
                    id: open.id,
                    location: open.location.clone(),
                });
            }
            if !over {
                break;
            }
            let at = self.trajectory.end_time(segment).map_or(begin, instant);
            events.push(ControllerEvent::MoveReached {
                at: at.max(begin),
                id: open.id,
                location: open.location.clone(),
            });
        }
        while let Some(open) = self.open.front()
            && self.trajectory.is_done(SegmentId(open.id.0), until)
        {
            self.closed = self.open.pop_front();
        }
        self.trajectory.forget_before(begin.as_secs_f64());
    }

    pub fn joints(&self, now: SimTime) -> JointPositions {
        self.trajectory.sample(now.as_secs_f64())
    }

    pub fn planned_joints(&self) -> JointPositions {
        self.trajectory.end_joints()
    }

    pub fn corner_failures(&self) -> usize {
        self.trajectory.corner_failures().len()
    }
}

fn segment(request: &MoveRequest) -> Segment {
    Segment {
        interpolation: match request.kind {
            MoveKind::Joint => Interpolation::Joint,
            MoveKind::Linear => Interpolation::Linear,
        },
        target: match &request.target {
            MoveTarget::Joints(joints) => SegmentTarget::Joints(*joints),
            MoveTarget::Tcp(pose) => SegmentTarget::Tcp(*pose),
        },
        flange_from_tcp: request.flange_from_tcp,
        speed: Speed {
            tcp: request.speed.tcp,
            orientation: request.speed.orientation,
            joint_fraction: request.speed.joint_fraction,
            acceleration_fraction: request.speed.acceleration_fraction,
        },
        zone: match request.zone {
            MoveZone::Fine => Zone::Fine,
            MoveZone::Fly { tcp, orientation } => Zone::Fly { tcp, orientation },
        },
    }
}
