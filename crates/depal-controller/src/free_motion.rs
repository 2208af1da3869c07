use std::collections::VecDeque;
use std::task::Poll;

use depal_frames::nalgebra::Translation3;
use depal_frames::{JointPositions, Pose, Rotation, Vector};
use depal_time::{SimDuration, SimTime};
use depal_vm::system::{Fault, MoveId, MoveRequest, MoveTarget, ProgramLocation};

use crate::ControllerEvent;

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
    open: VecDeque<FreeMove>,
    rest: JointPositions,
}

#[derive(Debug, Clone)]
struct FreeMove {
    id: MoveId,
    location: ProgramLocation,
    begin: SimTime,
    end: SimTime,
    from: JointPositions,
    to: JointPositions,
    started: bool,
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
        }
    }

    pub fn start(&mut self, now: SimTime, request: &MoveRequest) -> Poll<Result<MoveId, Fault>> {
        let unfinished = self.open.iter().filter(|m| m.end > now).count();
        if unfinished > self.depth {
            return Poll::Pending;
        }
        let from = self.planned_joints();
        let (to, seconds) = match &request.target {
            MoveTarget::Joints(joints) => (*joints, from.max_distance(joints) / JOINT_SPEED),
            MoveTarget::Tcp(base_from_tcp) => {
                let begin = free_forward(&from) * request.flange_from_tcp;
                let way = (base_from_tcp.translation.vector - begin.translation.vector).norm();
                let turn = begin.rotation.angle_to(&base_from_tcp.rotation);
                let seconds = (way / request.speed.tcp).max(turn / request.speed.orientation);
                let flange = base_from_tcp * request.flange_from_tcp.inverse();
                (free_inverse(&flange), seconds)
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
        });
        Poll::Ready(Ok(id))
    }

    pub fn is_done(&self, now: SimTime, id: MoveId) -> bool {
        self.open.iter().all(|m| m.id != id || m.end <= now)
    }

    pub fn is_standing(&self, now: SimTime) -> bool {
        self.open.back().is_none_or(|last| last.end <= now)
    }

    pub fn stop(&mut self, now: SimTime, reason: &str, events: &mut Vec<ControllerEvent>) {
        if self.open.is_empty() {
            return;
        }
        self.rest = self.joints(now);
        events.push(ControllerEvent::MotionStopped {
            at: now,
            dropped: self.open.drain(..).map(|m| m.id).collect(),
            reason: reason.to_owned(),
        });
    }

    pub fn advance(&mut self, begin: SimTime, end: SimTime, events: &mut Vec<ControllerEvent>) {
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
    }

    pub fn joints(&self, now: SimTime) -> JointPositions {
        let Some(m) = self.open.iter().find(|m| m.end > now) else {
            return self.planned_joints();
        };
        if m.begin >= now || m.end <= m.begin {
            return m.from;
        }
        let part = (now - m.begin).as_secs_f64() / (m.end - m.begin).as_secs_f64();
        m.from.lerp(&m.to, part)
    }

    pub fn planned_joints(&self) -> JointPositions {
        self.open.back().map_or(self.rest, |last| last.to)
    }
}
