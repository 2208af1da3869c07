//! The step loop: one clock, one fixed order.

use depal_camera::{Material, RenderShape};
use depal_controller::Controller;
use depal_interface::plc_port;
use depal_time::{SimTime, TICK};
use depal_vm::execution::RobotTask;
use depal_world::{VisibleKind, VisibleShape, World, WorldEvent};

use crate::at_rest::arm_poses;
use crate::digest::Digest;
use crate::error::CellError;
use crate::event::{Event, EventKind, round};
use crate::gripper_io;
use crate::link::Link;
use crate::observer::Observer;
use crate::picks::PickKeeper;
use crate::picture::Seen;
use crate::plc_link::PlcLink;
use crate::score::Score;
use crate::skin::CartonSkin;
use crate::spec::CellSpec;
use crate::standing::deviation;
use crate::vision_side::VisionSide;

mod ending;
mod program;
mod view;

pub use ending::{EndState, RunOutcome};

/// A snapshot goes to the observers every so many ticks: 25 a second.
const SNAPSHOT_TICKS: u64 = 10;
/// A state digest goes into the log every so many ticks: once a second.
const DIGEST_TICKS: u64 = 250;

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
        let mut controller = Controller::new(spec.controller.clone())?;
        check_wiring(&spec, &controller)?;
        let mut world = spec.world_at_rest();
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
            shapes: render_shapes(&self.world, &self.spec.skins),
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
                &render_shapes(&self.world, &self.spec.skins),
                Some(base_from_flange),
                &mut self.pending,
            );
            if let Some(carrier_from_camera) = found {
                self.spec.recalibrate(carrier_from_camera);
            }
        }
        // 8. Log.
        if self.tick.is_multiple_of(DIGEST_TICKS) {
            self.digest_state();
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

/// Everything in view of a camera, with its surface; the ids are those of the world. `skins`: what the cartons
/// are made of, as in [`CellSpec::skins`]. Tape and label are solids of their own, with their carton's id.
pub fn render_shapes(world: &World, skins: &[CartonSkin]) -> Vec<RenderShape> {
    let shapes = world.visible_shapes().into_iter();
    shapes.flat_map(|shape| drawn(shape, skins)).collect()
}

/// The same without arm and tool.
pub(crate) fn scenery_shapes(world: &World, skins: &[CartonSkin]) -> Vec<RenderShape> {
    let is_robot = |kind| matches!(kind, VisibleKind::Link(_) | VisibleKind::Tool);
    let shapes = world.visible_shapes().into_iter();
    let shapes = shapes.filter(|s| !is_robot(s.kind));
    shapes.flat_map(|shape| drawn(shape, skins)).collect()
}

fn drawn(visible: VisibleShape, skins: &[CartonSkin]) -> Vec<RenderShape> {
    let shape = RenderShape {
        world_from_shape: visible.shape.pose,
        shape: visible.shape.shape,
        id: visible.id,
        material: match visible.kind {
            VisibleKind::Carton(_) => Material::KRAFT,
            VisibleKind::Fixed(_) => Material::WOOD,
            VisibleKind::Conveyor(_) => Material::CONCRETE,
            VisibleKind::Link(_) | VisibleKind::Tool => Material::PAINT,
        },
        edge_radius: visible.edge_radius,
    };
    let skin = match visible.kind {
        // Cartons are numbered from 1.
        VisibleKind::Carton(id) => skins.get((id.0 as usize).wrapping_sub(1)),
        _ => None,
    };
    match skin {
        Some(skin) => skin.dress(shape),
        None => vec![shape],
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
