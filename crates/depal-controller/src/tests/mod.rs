use std::sync::Arc;
use std::task::Poll;

use depal_arm::Arm;
use depal_frames::{JointPositions, Pose};
use depal_time::{SimDuration, SimTime, TICK};
use depal_vm::execution::{RobotTask, RuntimeError, Step};
use depal_vm::system::{
    Fault, MoveId, MoveKind, MoveRequest, MoveSpeed, MoveTarget, MoveZone, ProgramLocation, System,
};

use crate::{
    Controller, ControllerEvent, ControllerSpec, Network, NoNetwork, SignalFamily, SignalKind,
    SignalSpec,
};

mod cabinet;
mod configuration;
mod motion;
mod sockets;

const IRB6700: &str = include_str!("../../../../urdf/abb_irb6700_150_320.urdf");

/// What one instruction does when asked: wait, go on, or a fault.
type Ask = Poll<Result<(), Fault>>;
type Instruction = Box<dyn FnMut(&mut dyn System) -> Ask>;

/// A task from a list of instructions; a fault jumps to `handler`, or fails the task.
struct Script {
    instructions: Vec<Instruction>,
    at: usize,
    handler: Option<usize>,
}

impl Script {
    fn new() -> Self {
        Self {
            instructions: Vec::new(),
            at: 0,
            handler: None,
        }
    }

    fn then(mut self, instruction: impl FnMut(&mut dyn System) -> Ask + 'static) -> Self {
        self.instructions.push(Box::new(instruction));
        self
    }

    /// A move instruction: waits for room in the queue, and at a fine point for the arm.
    fn go(self, request: MoveRequest) -> Self {
        let mut accepted: Option<MoveId> = None;
        self.then(move |system| {
            if accepted.is_none() {
                match system.start_move(&request) {
                    Poll::Pending => return Poll::Pending,
                    Poll::Ready(Err(fault)) => return Poll::Ready(Err(fault)),
                    Poll::Ready(Ok(id)) => accepted = Some(id),
                }
            }
            let id = accepted.expect("just set");
            let done = request.zone != MoveZone::Fine
                || match system.is_move_done(id) {
                    Ok(done) => done,
                    Err(fault) => {
                        accepted = None;
                        return Poll::Ready(Err(fault));
                    }
                };
            if done {
                Poll::Ready(Ok(()))
            } else {
                Poll::Pending
            }
        })
    }

    fn set(self, name: &'static str, value: f64) -> Self {
        self.then(move |system| Poll::Ready(system.set_signal(name, value)))
    }

    /// From here on faults jump here.
    fn handler_here(mut self) -> Self {
        self.handler = Some(self.instructions.len());
        self
    }

    fn location(&self) -> ProgramLocation {
        ProgramLocation {
            task: "T_ROB1".into(),
            module: "Main".into(),
            routine: "main".into(),
            line: self.at as u32 + 1,
        }
    }
}

impl RobotTask for Script {
    fn step(&mut self, system: &mut dyn System) -> Step {
        let location = self.location();
        let Some(instruction) = self.instructions.get_mut(self.at) else {
            return Step::Finished;
        };
        system.statement(&location);
        match instruction(system) {
            Poll::Pending => Step::Blocked,
            Poll::Ready(Ok(())) => {
                self.at += 1;
                Step::Ran
            }
            Poll::Ready(Err(fault)) => match self.handler.filter(|h| *h > self.at) {
                Some(handler) => {
                    self.at = handler;
                    Step::Ran
                }
                None => Step::Failed(RuntimeError {
                    name: format!("{fault:?}"),
                    message: format!("{fault:?}"),
                    call_stack: vec![location],
                }),
            },
        }
    }

    fn location(&self) -> ProgramLocation {
        Script::location(self)
    }
}

fn arm() -> Arc<Arm> {
    let accelerations = [180.0, 180.0, 180.0, 400.0, 400.0, 500.0].map(f64::to_radians);
    Arc::new(Arm::from_urdf(IRB6700, "abb_irb6700_150_320.urdf", &accelerations).unwrap())
}

fn joints(j1: f64, j2: f64) -> JointPositions {
    JointPositions::from_degrees(&[j1, j2, 10.0, 0.0, 70.0, 0.0])
}

fn move_j(j1: f64, j2: f64, zone: MoveZone) -> MoveRequest {
    MoveRequest {
        kind: MoveKind::Joint,
        target: MoveTarget::Joints(joints(j1, j2)),
        speed: MoveSpeed {
            tcp: 7.0,
            orientation: 8.0,
            joint_fraction: 1.0,
            acceleration_fraction: 1.0,
        },
        zone,
        flange_from_tcp: Pose::translation(0.0, 0.0, 0.25),
        configuration: None,
        location: ProgramLocation::default(),
    }
}

const Z100: MoveZone = MoveZone::Fly {
    tcp: 0.1,
    orientation: 0.5,
};

fn spec() -> ControllerSpec {
    let mut spec = ControllerSpec::new("rob1", arm(), joints(0.0, 10.0));
    spec.signals = vec![
        SignalSpec::new("diReady", SignalKind::DigitalInput),
        SignalSpec::new("doVacuum", SignalKind::DigitalOutput),
        SignalSpec::new("goSections", SignalKind::GroupOutput { bits: 4 }),
    ];
    spec
}

fn controller(script: Script) -> Controller {
    let mut controller = Controller::new(spec()).unwrap();
    controller.set_task(Box::new(script));
    controller
}

/// Runs for so many cycles from the start; all events and the joints after each cycle.
fn run(
    controller: &mut Controller,
    network: &mut dyn Network,
    cycles: u32,
) -> (Vec<ControllerEvent>, Vec<JointPositions>) {
    run_from(controller, network, SimTime::ZERO, cycles)
}

fn run_from(
    controller: &mut Controller,
    network: &mut dyn Network,
    start: SimTime,
    cycles: u32,
) -> (Vec<ControllerEvent>, Vec<JointPositions>) {
    let mut events = Vec::new();
    let mut trace = vec![controller.commanded_joints()];
    let mut now = start;
    for _ in 0..cycles {
        controller.tick(now, network);
        now += TICK;
        trace.push(controller.commanded_joints());
        while let Some(event) = controller.poll_event() {
            events.push(event);
        }
    }
    (events, trace)
}

/// Time of the first event that fits.
fn time_of(events: &[ControllerEvent], what: impl Fn(&ControllerEvent) -> bool) -> SimTime {
    events
        .iter()
        .find(|e| what(e))
        .unwrap_or_else(|| panic!("no such event in {events:#?}"))
        .at()
}

fn edge(events: &[ControllerEvent], signal: &str) -> SimTime {
    time_of(
        events,
        |e| matches!(e, ControllerEvent::SignalEdge { name, .. } if name == signal),
    )
}

fn reached(events: &[ControllerEvent], move_id: u64) -> SimTime {
    time_of(
        events,
        |e| matches!(e, ControllerEvent::MoveReached { id, .. } if id.0 == move_id),
    )
}

/// Largest use of joint speed and acceleration limits over a trace of cycles; 1 is the limit.
fn use_of_limits(trace: &[JointPositions]) -> (f64, f64) {
    let (mut speed, mut acceleration) = (0.0_f64, 0.0_f64);
    let arm = arm();
    for w in trace.windows(3) {
        for (j, limit) in arm.limits().iter().enumerate() {
            speed = speed.max((w[2][j] - w[1][j]).abs() / 0.004 / limit.max_speed);
            let bend = (w[2][j] - 2.0 * w[1][j] + w[0][j]).abs() / 16e-6;
            acceleration = acceleration.max(bend / limit.max_acceleration);
        }
    }
    (speed, acceleration)
}
