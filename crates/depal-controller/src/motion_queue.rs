use std::cell::Cell;
use std::collections::{BTreeMap, VecDeque};
use std::task::Poll;

use depal_arm::Load;
use depal_frames::{JointPositions, Point};
use depal_motion::{MotionError, SegmentId, Trajectory};
use depal_time::{SimDuration, SimTime};
use depal_vm::system::{Fault, MoveId, MoveRequest, PathEvent, ProgramLocation};

use crate::ControllerEvent;
use crate::path_events::{Fired, PathEvents};
use segment::segment;

mod segment;

/// Accepted moves and the path that they make.
#[derive(Debug, Clone)]
pub(crate) struct MotionQueue {
    trajectory: Trajectory,
    depth: usize,
    /// What hangs on the flange if the program says nothing of it.
    mounted: Load,
    /// What the program says of it.
    tool: Option<Load>,
    /// Mass carried on top, kg, and its centre in the tool frame, m.
    payload: (f64, Point),
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
    /// Outputs along the way.
    along: PathEvents,
    /// The program holds the motion, with or without a path.
    held: bool,
    /// Paths put aside, the last one on top.
    stored: Vec<StoredPath>,
    /// Whether the motion was held when a path began to be put aside.
    storing_held: Option<bool>,
}

/// A path that was put aside.
#[derive(Debug, Clone)]
struct StoredPath {
    trajectory: Trajectory,
    open: VecDeque<OpenMove>,
    along: PathEvents,
    held: bool,
}

/// How far beside the stored path the arm may stand when it is taken up again, radians.
const BESIDE: f64 = 1e-3;

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
    pub fn new(trajectory: Trajectory, depth: usize, mounted: Load) -> Self {
        Self {
            trajectory,
            depth,
            mounted,
            tool: None,
            payload: (0.0, Point::origin()),
            open: VecDeque::new(),
            closed: None,
            broken: BTreeMap::new(),
            alarm: None,
            failures_told: 0,
            along: PathEvents::default(),
            held: false,
            stored: Vec::new(),
            storing_held: None,
        }
    }

    pub fn set_tool_load(&mut self, load: Option<(f64, Point)>) {
        self.tool = load.map(|(mass, centre)| Load::point(mass, centre));
    }

    pub fn set_payload(&mut self, mass: f64, centre_in_tcp: Point) {
        self.payload = (mass, centre_in_tcp);
    }

    /// Takes a move, unless the queue is full.
    pub fn start(
        &mut self,
        now: SimTime,
        request: &MoveRequest,
        along: &[PathEvent],
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
        let (mass, centre) = self.payload;
        let carried = if mass > 0.0 {
            Load::point(mass, request.flange_from_tcp * centre)
        } else {
            Load::NONE
        };
        let tool = self.tool.unwrap_or(self.mounted);
        self.trajectory.set_tool_and_load(&tool, &carried);
        let id = match self.trajectory.append(seconds, &segment(request)) {
            Ok(id) => MoveId(id.0),
            Err(error) => {
                let message = error.to_string();
                return Poll::Ready(Err(match error {
                    MotionError::Configuration { .. } => Fault::Configuration { message },
                    _ => Fault::OutOfReach { message },
                }));
            }
        };
        self.along.add(&self.trajectory, along);
        if self.held {
            // What comes while the motion is held waits with it.
            self.trajectory.hold(seconds);
        }
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
        let aside = self.stored.iter().flat_map(|path| &path.open);
        if aside.into_iter().any(|open| open.id == id) {
            return Ok(false);
        }
        Ok(self.trajectory.is_done(SegmentId(id.0), now.as_secs_f64()))
    }

    pub fn is_begun(&self, now: SimTime, id: MoveId) -> bool {
        let seconds = now.as_secs_f64();
        let segment = SegmentId(id.0);
        let start = self.trajectory.start_time(segment);
        self.trajectory.is_done(segment, seconds) || start.is_some_and(|start| start <= seconds)
    }

    /// Stands, with nothing to do or with its path held.
    pub fn is_resting(&self, now: SimTime) -> bool {
        now.as_secs_f64() >= self.trajectory.stand_time()
            && (self.held || !self.trajectory.is_held())
    }

    pub fn is_held(&self) -> bool {
        self.held
    }

    /// Stops on the path; ready when the arm stands.
    pub fn hold(&mut self, now: SimTime, events: &mut Vec<ControllerEvent>) -> Poll<()> {
        if !self.held {
            self.held = true;
            if !self.is_standing(now) {
                self.trajectory.hold(now.as_secs_f64());
                events.push(ControllerEvent::MotionHeld { at: now });
            }
        }
        if now.as_secs_f64() >= self.trajectory.stand_time() {
            Poll::Ready(())
        } else {
            Poll::Pending
        }
    }

    /// Goes on along the path.
    pub fn resume(&mut self, now: SimTime, events: &mut Vec<ControllerEvent>) {
        self.held = false;
        if self.trajectory.is_held() {
            self.trajectory.resume(now.as_secs_f64());
            events.push(ControllerEvent::MotionResumed { at: now });
        }
    }

    /// Puts the path aside; ready when the arm stands and that is done.
    pub fn store(&mut self, now: SimTime, events: &mut Vec<ControllerEvent>) -> Poll<()> {
        // Whether the program had stopped the motion itself, as it was when it first asked.
        let was_held = *self.storing_held.get_or_insert(self.held);
        if self.hold(now, events).is_pending() {
            return Poll::Pending;
        }
        let beside = self.trajectory.beside(now.as_secs_f64());
        self.stored.push(StoredPath {
            trajectory: std::mem::replace(&mut self.trajectory, beside),
            open: std::mem::take(&mut self.open),
            along: std::mem::take(&mut self.along),
            held: was_held,
        });
        self.storing_held = None;
        self.held = false;
        Poll::Ready(())
    }

    /// Takes up the path that was put aside last.
    pub fn restore(&mut self, now: SimTime) -> Result<(), Fault> {
        let seconds = now.as_secs_f64();
        if !self.is_standing(now) {
            return Err(Fault::NotThere {
                message: "a way to take up a stored path while the arm moves".to_owned(),
            });
        }
        let here = self.trajectory.sample(seconds);
        let Some(stored) = self.stored.last() else {
            return Err(Fault::NotThere {
                message: "a stored path; call StorePath first".to_owned(),
            });
        };
        let beside = stored.trajectory.sample(seconds).max_distance(&here);
        if beside > BESIDE {
            return Err(Fault::OutOfReach {
                message: format!(
                    "a joint is {:.2} degrees away from where the path was stored; move back there before RestoPath",
                    beside.to_degrees()
                ),
            });
        }
        if let Some(mut stored) = self.stored.pop() {
            stored.trajectory.count_on_from(&self.trajectory);
            self.trajectory = stored.trajectory;
            self.open = stored.open;
            self.along = stored.along;
            self.held = stored.held;
            if !self.held {
                self.trajectory.resume(seconds);
            }
        }
        Ok(())
    }

    /// Drops the path that is held; the hold stays.
    pub fn clear(&mut self, now: SimTime, reason: &str, events: &mut Vec<ControllerEvent>) {
        let held = self.held;
        self.stop(now, reason, events);
        self.held = held;
    }

    pub fn is_standing(&self, now: SimTime) -> bool {
        now.as_secs_f64() >= self.trajectory.duration()
    }

    /// Brakes and drops the queue.
    pub fn stop(&mut self, now: SimTime, reason: &str, events: &mut Vec<ControllerEvent>) {
        let seconds = now.as_secs_f64();
        self.held = false;
        if self.open.is_empty() && self.is_standing(now) {
            return;
        }
        self.trajectory.stop(seconds);
        self.along.clear();
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
    /// What the path has for the outputs in between, by time.
    pub fn advance(
        &mut self,
        begin: SimTime,
        end: SimTime,
        events: &mut Vec<ControllerEvent>,
    ) -> Vec<Fired> {
        let fired = self.along.due(&self.trajectory, begin, end);
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
        fired
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
