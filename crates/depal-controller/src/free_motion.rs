use std::collections::VecDeque;
use std::task::Poll;

use depal_frames::nalgebra::Translation3;
use depal_frames::{JointPositions, Point, Pose, Rotation, Vector};
use depal_motion::Circle;
use depal_time::{SimDuration, SimTime};
use depal_vm::system::{
    Fault, MoveId, MoveRequest, MoveTarget, PathEvent, PathPlace, ProgramLocation,
};

use crate::ControllerEvent;
use crate::path_events::{Fired, fired};

/// Speed of a joint move without an arm, rad/s: 180 degrees/s, a common axis speed of large arms.
const JOINT_SPEED: f64 = std::f64::consts::PI;

/// A mechanism that reaches everything, for programs whose arm is not known.
///
/// Its six axes are not those of any arm: the first three are the flange position in metres, the last three its
/// rotation vector in radians. So a pose and its joint positions determine each other, a target read back
/// is the target that was programmed, and nothing is out of reach.
///
/// Time law: constant speed, no acceleration. A move to a pose takes the longer of distance by TCP speed and angle by
/// reorientation speed; a move to joint positions takes its largest axis difference by 180 degrees/s.
/// A corner is driven to its end without a stop.
#[derive(Debug, Clone)]
pub(crate) struct FreeMotion {
    depth: usize,
    next: u64,
    pub(crate) open: VecDeque<FreeMove>,
    pub(crate) rest: JointPositions,
    /// Since when the motion is held: its clock stands.
    pub(crate) held: Option<SimTime>,
    /// Paths put aside, the last one on top, each with whether it was held.
    pub(crate) stored: Vec<(FreeMotion, bool)>,
}

#[derive(Debug, Clone)]
pub(crate) struct FreeMove {
    pub(crate) id: MoveId,
    location: ProgramLocation,
    pub(crate) begin: SimTime,
    pub(crate) end: SimTime,
    from: JointPositions,
    to: JointPositions,
    started: bool,
    /// TCP path length, metres.
    way: f64,
    arc: Option<FreeArc>,
    /// Outputs along the way that are still to come.
    along: Vec<PathEvent>,
}

/// The TCP path of a circular move.
#[derive(Debug, Clone)]
struct FreeArc {
    circle: Circle,
    from: Rotation,
    to: Rotation,
    tcp_from_flange: Pose,
}

impl FreeMove {
    /// The axes after a share of the way.
    fn at(&self, share: f64) -> JointPositions {
        match &self.arc {
            None => self.from.lerp(&self.to, share),
            Some(arc) => {
                let base_from_tcp = Pose::from_parts(
                    Translation3::from(arc.circle.at(share)),
                    arc.from.slerp(&arc.to, share),
                );
                free_inverse(&(base_from_tcp * arc.tcp_from_flange))
            }
        }
    }

    /// When a place is passed.
    fn time_at(&self, place: PathPlace) -> SimTime {
        let share = match place {
            PathPlace::BeforeEnd(metres) => 1.0 - metres / self.way,
            PathPlace::AfterStart(metres) => metres / self.way,
        };
        let share = if share.is_finite() { share } else { 1.0 };
        let seconds = (self.end - self.begin).as_secs_f64() * share.clamp(0.0, 1.0);
        self.begin + SimDuration::from_secs_f64(seconds)
    }

    /// Takes out the outputs that are due before `end`.
    fn due(&mut self, begin: SimTime, end: SimTime) -> Vec<Fired> {
        let mut due = Vec::new();
        let along = std::mem::take(&mut self.along);
        for event in along {
            let nanos = self.time_at(event.place).as_nanos();
            let at = SimTime::from_nanos(nanos.saturating_sub(event.lead.as_nanos()));
            if at < end || self.end <= end {
                due.push(fired(at.max(begin), &event));
            } else {
                self.along.push(event);
            }
        }
        due
    }
}

/// `base_from_flange` of the axes.
pub(crate) fn free_forward(joints: &JointPositions) -> Pose {
    let q = |i: usize| joints.get(i).copied().unwrap_or(0.0);
    Pose::from_parts(
        Translation3::new(q(0), q(1), q(2)),
        Rotation::from_scaled_axis(Vector::new(q(3), q(4), q(5))),
    )
}

/// The axes of `base_from_flange`; the rotation vector is the one of at most half a turn.
pub(crate) fn free_inverse(base_from_flange: &Pose) -> JointPositions {
    let t = base_from_flange.translation.vector;
    let r = base_from_flange.rotation.scaled_axis();
    JointPositions::from_slice(&[t.x, t.y, t.z, r.x, r.y, r.z])
}

impl FreeMotion {
    pub fn new(depth: usize) -> Self {
        Self {
            depth,
            next: 0,
            open: VecDeque::new(),
            rest: JointPositions::zeros(6),
            held: None,
            stored: Vec::new(),
        }
    }

    pub fn start(
        &mut self,
        now: SimTime,
        request: &MoveRequest,
        along: &[PathEvent],
    ) -> Poll<Result<MoveId, Fault>> {
        let now = self.clock(now);
        let unfinished = self.open.iter().filter(|m| m.end > now).count();
        if unfinished > self.depth {
            return Poll::Pending;
        }
        let from = self.planned_joints();
        let begin = free_forward(&from) * request.flange_from_tcp;
        let tcp_from_flange = request.flange_from_tcp.inverse();
        let mut arc = None;
        let (to, way, seconds) = match &request.target {
            MoveTarget::Joints(joints) => {
                let end = free_forward(joints) * request.flange_from_tcp;
                let way = (end.translation.vector - begin.translation.vector).norm();
                (*joints, way, from.max_distance(joints) / JOINT_SPEED)
            }
            MoveTarget::Tcp(to) | MoveTarget::Arc { to, .. } => {
                let mut way = (to.translation.vector - begin.translation.vector).norm();
                if let MoveTarget::Arc { through, .. } = &request.target {
                    let circle = Circle::through(
                        &Point::from(begin.translation.vector),
                        through,
                        &Point::from(to.translation.vector),
                    );
                    let circle = match circle {
                        Ok(circle) => circle,
                        Err(error) => {
                            let message = error.to_string();
                            return Poll::Ready(Err(Fault::OutOfReach { message }));
                        }
                    };
                    way = circle.length();
                    arc = Some(FreeArc {
                        circle,
                        from: begin.rotation,
                        to: to.rotation,
                        tcp_from_flange,
                    });
                }
                let turn = begin.rotation.angle_to(&to.rotation);
                let seconds = (way / request.speed.tcp).max(turn / request.speed.orientation);
                (free_inverse(&(to * tcp_from_flange)), way, seconds)
            }
        };
        if !seconds.is_finite() {
            return Poll::Ready(Err(Fault::OutOfReach {
                message: "the target is not a finite pose".to_owned(),
            }));
        }
        let begin = self.open.back().map_or(now, |last| last.end.max(now));
        let id = MoveId(self.next);
        self.next += 1;
        self.open.push_back(FreeMove {
            id,
            location: request.location.clone(),
            begin,
            end: begin + SimDuration::from_secs_f64(seconds),
            from,
            to,
            started: false,
            way,
            arc,
            along: along.to_vec(),
        });
        Poll::Ready(Ok(id))
    }

    pub fn is_done(&self, now: SimTime, id: MoveId) -> bool {
        let now = self.clock(now);
        self.open.iter().all(|m| m.id != id || m.end <= now)
            && self.aside().all(|aside| aside != id)
    }

    pub fn is_standing(&self, now: SimTime) -> bool {
        let now = self.clock(now);
        self.open.back().is_none_or(|last| last.end <= now)
    }

    pub fn stop(&mut self, now: SimTime, reason: &str, events: &mut Vec<ControllerEvent>) {
        let at = now;
        let now = self.clock(now);
        self.held = None;
        if self.open.is_empty() {
            return;
        }
        self.rest = self.joints(now);
        events.push(ControllerEvent::MotionStopped {
            at,
            dropped: self.open.drain(..).map(|m| m.id).collect(),
            reason: reason.to_owned(),
        });
    }

    pub fn advance(
        &mut self,
        begin: SimTime,
        end: SimTime,
        events: &mut Vec<ControllerEvent>,
    ) -> Vec<Fired> {
        let end = self.clock(end);
        let mut due = Vec::new();
        for open in &mut self.open {
            due.extend(open.due(begin, end));
        }
        due.sort_by_key(|fired| fired.at);
        for open in &mut self.open {
            if !open.started && open.begin <= end {
                open.started = true;
                events.push(ControllerEvent::MoveStarted {
                    at: open.begin.max(begin),
                    id: open.id,
                    location: open.location.clone(),
                });
            }
            if open.end > end {
                break;
            }
            events.push(ControllerEvent::MoveReached {
                at: open.end.max(begin),
                id: open.id,
                location: open.location.clone(),
            });
        }
        while let Some(first) = self.open.front()
            && first.end <= end
        {
            self.rest = first.to;
            self.open.pop_front();
        }
        due
    }

    pub fn joints(&self, now: SimTime) -> JointPositions {
        let now = self.clock(now);
        let Some(m) = self.open.iter().find(|m| m.end > now) else {
            return self.planned_joints();
        };
        if m.begin >= now || m.end <= m.begin {
            return m.from;
        }
        let part = (now - m.begin).as_secs_f64() / (m.end - m.begin).as_secs_f64();
        m.at(part)
    }

    pub fn planned_joints(&self) -> JointPositions {
        self.open.back().map_or(self.rest, |last| last.to)
    }
}
