//! What is predicted is what a cabinet does: the same moves, driven tick by tick as a program hands them over.

use std::sync::Arc;
use std::task::Poll;

use depal_arm::Load;
use depal_controller::{Controller, ControllerEvent, ControllerSpec, NoNetwork};
use depal_motion::{Interpolation, Segment, SegmentTarget, Zone};
use depal_time::{RandomStream, SimTime, TICK};
use depal_vm::execution::{RobotTask, RuntimeError, Step};
use depal_vm::system::{
    MoveId, MoveKind, MoveRequest, MoveSpeed, MoveTarget, MoveZone, ProgramLocation, System,
};

use super::*;

mod picks;
mod programs;
mod transfers;

/// A move with what the arm carries meanwhile: kg, and its centre in the flange frame.
#[derive(Clone)]
struct Driven {
    segment: Segment,
    carried: (f64, Point),
}

/// Hands moves over as a program does: ahead of the arm, waiting at stop points.
struct Program {
    moves: Vec<Driven>,
    at: usize,
    accepted: Option<MoveId>,
}

fn request(segment: &Segment) -> MoveRequest {
    MoveRequest {
        kind: match segment.interpolation {
            Interpolation::Joint => MoveKind::Joint,
            Interpolation::Linear => MoveKind::Linear,
        },
        target: match &segment.target {
            SegmentTarget::Joints(joints) => MoveTarget::Joints(*joints),
            SegmentTarget::Tcp(pose) => MoveTarget::Tcp(*pose),
            SegmentTarget::Arc { through, to } => MoveTarget::Arc {
                through: *through,
                to: *to,
            },
        },
        speed: MoveSpeed {
            tcp: segment.speed.tcp,
            orientation: segment.speed.orientation,
            joint_fraction: segment.speed.joint_fraction,
            acceleration_fraction: segment.speed.acceleration_fraction,
        },
        zone: match segment.zone {
            Zone::Fine => MoveZone::Fine,
            Zone::Fly { tcp, orientation } => MoveZone::Fly { tcp, orientation },
            Zone::Blend { .. } => panic!("no program asks for that"),
        },
        flange_from_tcp: segment.flange_from_tcp,
        configuration: None,
        location: ProgramLocation::default(),
    }
}

impl RobotTask for Program {
    fn step(&mut self, system: &mut dyn System) -> Step {
        let Some(next) = self.moves.get(self.at) else {
            return Step::Finished;
        };
        system.statement(&ProgramLocation::default());
        let request = request(&next.segment);
        if self.accepted.is_none() {
            let (mass, centre) = next.carried;
            system.set_payload(mass, request.flange_from_tcp.inverse() * centre);
            match system.start_move(&request) {
                Poll::Pending => return Step::Blocked,
                Poll::Ready(Ok(id)) => self.accepted = Some(id),
                Poll::Ready(Err(fault)) => {
                    return Step::Failed(RuntimeError {
                        name: String::new(),
                        message: format!("{fault:?}"),
                        call_stack: Vec::new(),
                    });
                }
            }
        }
        let id = self.accepted.expect("just set");
        if request.zone == MoveZone::Fine && system.is_move_done(id) == Ok(false) {
            return Step::Blocked;
        }
        self.accepted = None;
        self.at += 1;
        Step::Ran
    }

    fn location(&self) -> ProgramLocation {
        ProgramLocation::default()
    }
}

/// Seconds from the beginning of the first move to the end of the last.
fn executed(arm: &Arc<Arm>, start: JointPositions, mounted: Load, moves: &[Driven]) -> f64 {
    let mut spec = ControllerSpec::new("rob1", Arc::clone(arm), start);
    spec.mounted = mounted;
    let mut controller = Controller::new(spec).unwrap();
    controller.set_task(Box::new(Program {
        moves: moves.to_vec(),
        at: 0,
        accepted: None,
    }));
    let (mut now, mut begin, mut end) = (SimTime::ZERO, None, None);
    let mut reached = 0;
    for _ in 0..20_000 {
        controller.tick(now, &mut NoNetwork);
        now += TICK;
        while let Some(event) = controller.poll_event() {
            match event {
                ControllerEvent::MoveStarted { at, .. } => begin = begin.or(Some(at)),
                ControllerEvent::MoveReached { at, .. } => {
                    reached += 1;
                    end = Some(at);
                }
                ControllerEvent::CornerFailure { .. } => panic!("a corner became a stop"),
                _ => {}
            }
        }
        if reached == moves.len() {
            break;
        }
    }
    assert_eq!(reached, moves.len(), "{:?}", controller.state());
    end.unwrap().as_secs_f64() - begin.unwrap().as_secs_f64()
}

fn load(mass: f64) -> Load {
    Load::point(mass, Point::new(0.05, 0.0, 0.45))
}

/// The arm with axes that hold such a load in these postures, and give no more than that or this share of what one axis
/// alone would ask for.
fn weak(postures: &[JointPositions], load: &Load, share: f64) -> Arm {
    let arm = arm();
    let zero = JointPositions::zeros(6);
    let mut limits = [1.0_f64; 6];
    for q in postures {
        let held = arm.holding_torques(q, load);
        for (j, limit) in arm.limits().iter().enumerate() {
            let mut rise = zero;
            rise[j] = limit.max_acceleration;
            let asked = arm.joint_torques(q, &zero, &rise, load)[j] - held[j];
            limits[j] = limits[j].max((share * asked).max(1.05 * held[j].abs()));
        }
    }
    arm.with_torque_limits(&limits).unwrap()
}

fn posture(random: &mut RandomStream) -> JointPositions {
    let mut u = |low: f64, high: f64| random.uniform(low, high);
    JointPositions::from_degrees(&[
        u(-100.0, 100.0),
        u(-25.0, 40.0),
        u(-25.0, 35.0),
        u(-60.0, 60.0),
        u(30.0, 100.0),
        u(-120.0, 120.0),
    ])
}
