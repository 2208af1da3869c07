//! The step loop: one clock, one fixed order.

use depal_camera::{Material, RenderShape};
use depal_controller::{Controller, ControllerEvent, ControllerState};
use depal_frames::{JointPositions, Pose};
use depal_interface::plc_port;
use depal_time::{SimDuration, SimTime, TICK};
use depal_vm::execution::RobotTask;
use depal_world::{VisibleKind, VisibleShape, World, WorldEvent};

use crate::digest::Digest;
use crate::error::CellError;
use crate::event::{Event, EventKind, FailureReason, round};
use crate::gripper_io;
use crate::link::Link;
use crate::observer::{CartonView, CartonViewState, Observer, Snapshot};
use crate::picks::PickKeeper;
use crate::picture::Seen;
use crate::plc_link::PlcLink;
use crate::score::{CartonFate, Score};
use crate::spec::CellSpec;
use crate::standing::deviation;
use crate::truth::TrueCarton;
use crate::vision_side::VisionSide;

/// A snapshot goes to the observers every so many ticks: 25 a second.
const SNAPSHOT_TICKS: u64 = 10;
/// A state digest goes into the log every so many ticks: once a second.
const DIGEST_TICKS: u64 = 250;
/// After the program's end the belt may run on for this long, to carry out what lies on it.
const RUN_OUT: SimDuration = SimDuration::from_millis(20_000);

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndState {
    /// The program's entry routine returned.
    Finished,
    /// The program stopped itself.
    Stopped,
    /// The program failed with an error of its own.
    Failed,
    /// The scene's time limit passed.
    TimeLimit,
}

impl EndState {
    /// The name in logs and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Stopped => "stopped",
            Self::Failed => "failed",
            Self::TimeLimit => "time_limit",
        }
    }
}

/// What a run came to.
#[derive(Debug, Clone)]
pub struct RunOutcome {
    /// How it ended.
    pub end: EndState,
    /// In words.
    pub end_detail: String,
    /// Simulated time of the run.
    pub sim_time: SimTime,
    /// Digest over the whole run, 16 hexadecimal digits.
    pub state_hash: String,
    /// Picks, losses and vision errors.
    pub score: Score,
}

/// The cell in motion.
pub struct Cell {
    spec: CellSpec,
    now: SimTime,
    tick: u64,
    world: World,
    controller: Controller,
    link: Link,
    vision: VisionSide,
    picks: PickKeeper,
    score: Score,
    digest: Digest,
    pending: Vec<EventKind>,
    program_end: Option<(SimTime, EndState, String)>,
    last_valves: Vec<bool>,
    last_message: String,
}

impl Cell {
    /// Builds the cell and lets the cartons settle. `stopwatch` gives wall seconds for the report's
    /// computing times; it influences nothing (tests give `|| 0.0`).
    pub fn new(
        mut spec: CellSpec,
        task: Box<dyn RobotTask>,
        stopwatch: fn() -> f64,
    ) -> Result<Self, CellError> {
        if spec.plc.is_some() {
            // The session behind a data block.
            for port in &mut spec.interface.ports {
                *port = plc_port(port);
            }
        }
        let mut world = World::new(&spec.world);
        for carton in &spec.cartons {
            world.add_carton(carton);
        }
        let links: Vec<_> = spec
            .arm
            .links()
            .iter()
            .map(|link| (link.name.clone(), link.collision.clone()))
            .collect();
        world.add_arm(&links, &spec.gripper);
        let mut controller = Controller::new(spec.controller.clone())?;
        check_wiring(&spec, &controller)?;
        let start = controller.commanded_joints();
        let (world_from_links, world_from_tcp) = arm_poses(&spec, &start);
        world.set_arm(&world_from_links, &world_from_tcp);
        world.settle(spec.settle_time);
        world.set_available_vacuum(spec.available_vacuum);
        controller.set_task(task);
        let score = Score::new(world.cartons().iter().map(|carton| carton.id.0));
        let settle_error = settle_error(&spec, &world);
        let mut cell = Self {
            now: SimTime::ZERO,
            tick: 0,
            controller,
            link: link(&spec),
            vision: VisionSide::new(&spec, stopwatch)?,
            picks: PickKeeper::default(),
            score,
            digest: Digest::new(),
            pending: Vec::new(),
            program_end: None,
            last_valves: vec![false; spec.gripper.sections.len()],
            last_message: String::new(),
            world,
            spec,
        };
        cell.pending.push(EventKind::RunStarted {
            scene: cell.spec.scene.clone(),
            seed: cell.spec.seed,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            cartons: cell.spec.cartons.len(),
            settle_error_mm: round(settle_error * 1e3, 1e3),
        });
        Ok(cell)
    }

    /// Simulated time so far.
    pub fn now(&self) -> SimTime {
        self.now
    }

    /// The score so far.
    pub fn score(&self) -> &Score {
        &self.score
    }

    /// Runs to the end. `progress` is called once a simulated second.
    pub fn run(
        mut self,
        observers: &mut [&mut dyn Observer],
        mut progress: impl FnMut(&Cell),
    ) -> RunOutcome {
        let (end, end_detail) = loop {
            self.step(observers);
            if self.tick.is_multiple_of(DIGEST_TICKS) {
                progress(&self);
            }
            if let Some(end) = self.end() {
                break end;
            }
        };
        let mut closing = Vec::new();
        self.picks.conclude(self.now, &mut self.score, &mut closing);
        self.picks.settle_places(
            |carton, place| deviation(&self.world, carton, &(self.spec.world_from_base * place)),
            self.now,
            &mut self.score,
            &mut closing,
        );
        self.score.run_failure = self.run_failure(end, &end_detail);
        self.digest_state();
        closing.push(EventKind::RunEnded {
            state: end.name(),
            detail: end_detail.clone(),
        });
        self.pending.append(&mut closing);
        self.log(observers);
        let snapshot = self.snapshot();
        for observer in observers.iter_mut() {
            observer.on_snapshot(&snapshot);
        }
        RunOutcome {
            end,
            end_detail,
            sim_time: self.now,
            state_hash: self.digest.hex(),
            score: self.score,
        }
    }

    /// One tick, in the order of `crates/README.md`.
    fn step(&mut self, observers: &mut [&mut dyn Observer]) {
        let now = self.now;
        // 1. Messages.
        self.vision.exchange(
            now,
            &self.spec,
            &mut self.link,
            &mut self.score,
            &mut self.pending,
        );
        // 2. Controller.
        self.controller.tick(now, &mut self.link);
        self.take_controller_events();
        for (address, port) in self.link.refused.drain(..) {
            self.pending.push(EventKind::Message {
                text: format!(
                    "nothing listens at {address}:{port}; the vision server's port is {}",
                    self.spec.port
                ),
            });
        }
        while let Some(text) = self.link.poll_notice() {
            self.pending.push(EventKind::Message { text });
        }
        // 3. Valves; seals, pressures and cup forces are solved inside the physics step.
        let valves = gripper_io::valves(&self.spec.gripper, &self.spec.wiring, &self.controller);
        // 4. Kinematic targets: where the arm is at the end of this tick.
        let joints = self.controller.commanded_joints();
        let (world_from_links, world_from_tcp) = arm_poses(&self.spec, &joints);
        self.world.set_arm(&world_from_links, &world_from_tcp);
        // 5. Physics.
        let world_events = self.world.step(&valves);
        self.now += TICK;
        self.tick += 1;
        // 6. Score.
        self.score_tick(&valves, &world_events);
        self.last_valves = valves;
        // 7. Camera, vision and planner.
        let base_from_flange = self.spec.arm.base_from_flange(&joints);
        let seen = self.vision.is_exposure_due(self.now).then(|| Seen {
            shapes: render_shapes(&self.world),
            base_from_flange: Some(base_from_flange),
            cartons: self.pickable_cartons(),
        });
        self.vision.advance(
            self.now,
            &self.spec,
            seen.as_ref(),
            &mut self.score,
            &mut self.pending,
            observers,
        );
        if self.vision.calibration.is_due(self.now) {
            let found = self.vision.calibration.advance(
                self.now,
                &self.spec,
                &render_shapes(&self.world),
                Some(base_from_flange),
                &mut self.pending,
            );
            if let Some(carrier_from_camera) = found {
                self.spec.recalibrate(carrier_from_camera);
            }
        }
        // 8. Log.
        if self.tick.is_multiple_of(DIGEST_TICKS) {
            self.digest.add(self.world.state_hash());
            for joint in joints.iter() {
                self.digest.add(joint.to_bits());
            }
            for section in 0..self.spec.gripper.sections.len() {
                let vacuum = self
                    .world
                    .gripper()
                    .map_or(0.0, |g| g.section_vacuum(section));
                self.digest.add(vacuum.to_bits());
            }
            self.digest.add(self.score.picks.len() as u64);
            self.pending.push(EventKind::StateHash {
                hash: self.digest.hex(),
            });
        }
        self.log(observers);
        if self.tick.is_multiple_of(SNAPSHOT_TICKS) {
            let snapshot = self.snapshot();
            for observer in observers.iter_mut() {
                observer.on_snapshot(&snapshot);
            }
        }
    }

    /// Adds bodies, arm, gripper and score to the running digest.
    fn digest_state(&mut self) {
        self.digest.add(self.world.state_hash());
        for joint in self.controller.commanded_joints().iter() {
            self.digest.add(joint.to_bits());
        }
        for section in 0..self.spec.gripper.sections.len() {
            let vacuum = self
                .world
                .gripper()
                .map_or(0.0, |g| g.section_vacuum(section));
            self.digest.add(vacuum.to_bits());
        }
        self.digest.add(self.score.picks.len() as u64);
    }

    fn score_tick(&mut self, valves: &[bool], world_events: &[WorldEvent]) {
        let vacuum_ok = self
            .world
            .gripper()
            .is_some_and(depal_gripper::GripperState::vacuum_ok);
        let input = self.spec.wiring.vacuum_ok.clone();
        self.controller
            .set_input(&input, f64::from(u8::from(vacuum_ok)))
            .expect("Cell::new found the input");
        self.picks.valves(
            self.now,
            valves,
            vacuum_ok,
            || self.vision.next_aim(),
            |carton, place| deviation(&self.world, carton, &(self.spec.world_from_base * place)),
            &mut self.score,
            &mut self.pending,
        );
        for event in world_events {
            let collision = self
                .picks
                .world_event(event, &mut self.score, &mut self.pending);
            if let Some(text) = collision {
                self.controller.report_collision(&text);
            }
            if let WorldEvent::CartonDelivered { carton, .. } = event {
                self.score.last_delivery = Some(self.now);
                self.world.remove_carton(*carton);
            }
        }
    }

    fn take_controller_events(&mut self) {
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

    /// Whether the run is over, and how.
    fn end(&mut self) -> Option<(EndState, String)> {
        if self.program_end.is_none() {
            let ended = match self.controller.state() {
                ControllerState::Idle | ControllerState::Running => None,
                ControllerState::Finished => {
                    Some((EndState::Finished, "the program came to its end".to_owned()))
                }
                ControllerState::Stopped(reason) => {
                    let at = self.controller.location().unwrap_or_default();
                    let said = match self.last_message.as_str() {
                        "" => String::new(),
                        said => format!("; its last message: {said}"),
                    };
                    Some((
                        EndState::Stopped,
                        format!("{reason} at {}/{}:{}{said}", at.module, at.routine, at.line),
                    ))
                }
                ControllerState::Failed(error) => {
                    let place = error.call_stack.first().map_or(String::new(), |at| {
                        format!("{}/{}:{}: ", at.module, at.routine, at.line)
                    });
                    Some((
                        EndState::Failed,
                        format!("{place}{}: {}", error.name, error.message),
                    ))
                }
            };
            self.program_end = ended.map(|(state, detail)| (self.now, state, detail));
        }
        if let Some((at, state, detail)) = &self.program_end {
            let on_belt = self.score.count(|fate| fate == CartonFate::OnConveyor);
            let settled = self.now - *at >= SimDuration::from_millis(500);
            let is_over = on_belt == 0 && settled && !self.picks.awaits_stand();
            if is_over || self.now - *at >= RUN_OUT {
                return Some((*state, detail.clone()));
            }
        }
        if self.now.as_nanos() >= self.spec.time_limit.as_nanos() {
            let at = self.controller.location().unwrap_or_default();
            return Some((
                EndState::TimeLimit,
                format!(
                    "{:.0} s have passed; the program stands at {}/{}:{}",
                    self.now.as_secs_f64(),
                    at.module,
                    at.routine,
                    at.line
                ),
            ));
        }
        None
    }

    /// What ended the run before the pallet was empty.
    fn run_failure(&self, end: EndState, detail: &str) -> Option<(FailureReason, String)> {
        let left = self
            .score
            .count(|fate| matches!(fate, CartonFate::InCell | CartonFate::OnConveyor));
        let reason = match end {
            EndState::TimeLimit => FailureReason::Timeout,
            _ if self.picks.collided() && end != EndState::Finished => FailureReason::Collision,
            // A program that gives up after failed picks ended for their reason, not for one of its own.
            EndState::Failed | EndState::Stopped => self
                .score
                .picks
                .last()
                .and_then(|(_, reason)| *reason)
                .or_else(|| self.vision.dialogue_failure())
                .unwrap_or(FailureReason::ProgramError),
            EndState::Finished if left == 0 || self.spec.may_leave_cartons => return None,
            EndState::Finished => self
                .vision
                .last_failure()
                .unwrap_or(FailureReason::NoDetection),
        };
        Some((reason, format!("{left} cartons left; {detail}")))
    }

    fn log(&mut self, observers: &mut [&mut dyn Observer]) {
        for kind in self.pending.drain(..) {
            let event = Event {
                time: self.now,
                kind,
            };
            for observer in observers.iter_mut() {
                observer.on_event(&event);
            }
        }
    }

    /// Cartons that a camera could be asked to find: not held, not on the belt, not lost.
    fn pickable_cartons(&self) -> Vec<TrueCarton> {
        let held = self
            .world
            .gripper()
            .map(depal_gripper::GripperState::held_cartons)
            .unwrap_or_default();
        self.world
            .cartons()
            .into_iter()
            .filter(|carton| {
                !held.contains(&carton.id.0)
                    && self.score.fates.get(&carton.id.0) == Some(&CartonFate::InCell)
            })
            .map(|carton| TrueCarton {
                id: carton.id.0,
                world_from_centre: carton.world_from_centre,
                size: [carton.size.length, carton.size.width, carton.size.height],
            })
            .collect()
    }

    fn snapshot(&self) -> Snapshot {
        let joints = self.controller.commanded_joints();
        let (world_from_links, world_from_tcp) = arm_poses(&self.spec, &joints);
        let gripper = self.world.gripper();
        let held = gripper
            .map(depal_gripper::GripperState::held_cartons)
            .unwrap_or_default();
        let targets = self.vision.targets();
        let cartons = self
            .world
            .cartons()
            .into_iter()
            .map(|carton| {
                let id = carton.id.0;
                let state = match self.score.fates.get(&id) {
                    Some(CartonFate::Lost(_)) => CartonViewState::Lost,
                    Some(CartonFate::OnConveyor | CartonFate::Placed) => CartonViewState::Placed,
                    _ if held.contains(&id) => CartonViewState::Gripped,
                    _ if targets.contains(&id) => CartonViewState::Target,
                    _ => CartonViewState::Waiting,
                };
                CartonView {
                    id,
                    world_from_centre: carton.world_from_centre,
                    size: [carton.size.length, carton.size.width, carton.size.height],
                    state,
                }
            })
            .collect();
        Snapshot {
            time: self.now,
            joints,
            world_from_links,
            world_from_tcp,
            section_vacuum: (0..self.spec.gripper.sections.len())
                .map(|section| gripper.map_or(0.0, |g| g.section_vacuum(section)))
                .collect(),
            valves: self.last_valves.clone(),
            cartons,
        }
    }
}

/// World poses of the links and of the tool centre point.
pub(crate) fn arm_poses(spec: &CellSpec, joints: &JointPositions) -> (Vec<Pose>, Pose) {
    let links = spec
        .arm
        .base_from_links(joints)
        .iter()
        .map(|base_from_link| spec.world_from_base * base_from_link)
        .collect();
    let world_from_tcp =
        spec.world_from_base * spec.arm.base_from_flange(joints) * spec.gripper.flange_from_tcp;
    (links, world_from_tcp)
}

/// What lies between the robot task and vision.
fn link(spec: &CellSpec) -> Link {
    let link = Link::new(spec.port, spec.latencies.network);
    match (&spec.plc, spec.interface.ports.first()) {
        (Some(plc), Some(port)) => link.with_plc(PlcLink::new(plc, port.profile.clone())),
        _ => link,
    }
}

/// The gripper's signals must be there before the first tick, not at the first pick.
fn check_wiring(spec: &CellSpec, controller: &Controller) -> Result<(), CellError> {
    let missing = |signal: &String| CellError::Wiring {
        signal: signal.clone(),
    };
    for output in spec.wiring.sections.names() {
        controller.output(output).map_err(|_| missing(output))?;
    }
    let input = &spec.wiring.vacuum_ok;
    controller.signal(input).map_err(|_| missing(input))?;
    Ok(())
}

/// Everything in view of a camera, with its surface; the ids are those of the world.
pub fn render_shapes(world: &World) -> Vec<RenderShape> {
    let shapes = world.visible_shapes().into_iter();
    shapes.map(drawn).collect()
}

/// The same without arm and tool.
pub(crate) fn scenery_shapes(world: &World) -> Vec<RenderShape> {
    let is_robot = |kind| matches!(kind, VisibleKind::Link(_) | VisibleKind::Tool);
    let shapes = world.visible_shapes().into_iter();
    shapes.filter(|s| !is_robot(s.kind)).map(drawn).collect()
}

fn drawn(visible: VisibleShape) -> RenderShape {
    RenderShape {
        world_from_shape: visible.shape.pose,
        shape: visible.shape.shape,
        id: visible.id,
        material: match visible.kind {
            VisibleKind::Carton(_) => Material::KRAFT,
            VisibleKind::Fixed(_) => Material::WOOD,
            VisibleKind::Conveyor(_) => Material::CONCRETE,
            VisibleKind::Link(_) | VisibleKind::Tool => Material::PAINT,
        },
    }
}

/// Largest height difference between the stack as specified and as settled, metres.
fn settle_error(spec: &CellSpec, world: &World) -> f64 {
    spec.cartons
        .iter()
        .zip(world.cartons())
        .map(|(nominal, settled)| {
            (nominal.world_from_centre.translation.z - settled.world_from_centre.translation.z)
                .abs()
        })
        .fold(0.0, f64::max)
}
