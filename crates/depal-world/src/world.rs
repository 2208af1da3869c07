use std::collections::BTreeMap;

use depal_frames::convert::from_glam;
use depal_frames::{PlacedShape, Point, Pose};
use depal_gripper::{CupContact, GripperSpec, GripperState};
use depal_time::SimDuration;
use rapier3d::prelude::{ActiveHooks, ColliderHandle, PhysicsWorld};

use crate::arm::Arm;
use crate::cartons::Carton;
use crate::collision::CollisionWatch;
use crate::conveyor::Belts;
use crate::engine::{Owner, collider, physics};
use crate::grip_report::{LoadHistory, world_event};
use crate::{CartonId, CartonSpec, CartonState, WorldEvent, WorldSpec, cups};

/// The physical cell: advances by one step at a time and says what happened.
pub struct World {
    pub(crate) spec: WorldSpec,
    pub(crate) physics: PhysicsWorld,
    pub(crate) cartons: BTreeMap<u32, Carton>,
    pub(crate) arm: Option<Arm>,
    pub(crate) conveyor_colliders: Vec<ColliderHandle>,
    pub(crate) floor_colliders: Vec<ColliderHandle>,
    pub(crate) collisions: CollisionWatch,
    belts: Belts,
    loads: LoadHistory,
    next_carton: u32,
}

impl World {
    /// The cell without cartons and arm.
    pub fn new(spec: &WorldSpec) -> Self {
        let mut physics = physics(spec);
        let mut floor_colliders = Vec::new();
        for (index, body) in spec.fixed.iter().enumerate() {
            for shape in &body.shapes {
                let built = collider(shape, Owner::Fixed(index as u32), body.friction);
                let handle = physics.insert_collider(built, None);
                if body.is_floor {
                    floor_colliders.push(handle);
                }
            }
        }
        let mut conveyor_colliders = Vec::new();
        for (index, conveyor) in spec.conveyors.iter().enumerate() {
            let owner = Owner::Conveyor(index as u32);
            let built = collider(&conveyor.belt, owner, conveyor.friction);
            let built = built.active_hooks(ActiveHooks::MODIFY_SOLVER_CONTACTS);
            conveyor_colliders.push(physics.insert_collider(built, None));
        }
        Self {
            physics,
            cartons: BTreeMap::new(),
            arm: None,
            conveyor_colliders,
            floor_colliders,
            collisions: CollisionWatch::new(spec),
            belts: Belts::new(&spec.conveyors),
            loads: LoadHistory::default(),
            next_carton: 1,
            spec: spec.clone(),
        }
    }

    /// Puts a carton into the world, at rest.
    pub fn add_carton(&mut self, spec: &CartonSpec) -> CartonId {
        let id = CartonId(self.next_carton);
        self.next_carton += 1;
        let carton = Carton::insert(&mut self.physics, id, spec);
        self.cartons.insert(id.0, carton);
        id
    }

    /// Takes a carton out of the world; false when there is no such carton.
    pub fn remove_carton(&mut self, id: CartonId) -> bool {
        let carton = self.cartons.remove(&id.0);
        carton.is_some_and(|carton| self.physics.remove_body(carton.body).is_some())
    }

    /// Puts the arm into the world: its links with their solids in link frames, base first,
    /// and the tool with its bodies in the `tcp` frame. It replaces an arm that was there.
    /// It stands nowhere before the first [`set_arm`](Self::set_arm).
    pub fn add_arm(&mut self, links: &[(String, Vec<PlacedShape>)], gripper: &GripperSpec) {
        if let Some(arm) = self.arm.take() {
            arm.remove(&mut self.physics);
        }
        let friction = self.spec.arm_friction;
        self.arm = Some(Arm::insert(&mut self.physics, links, gripper, friction));
    }

    /// Where the arm stands at the end of the next step: one pose per link, and the tool's.
    /// The first call puts it there at once; without a new call it stands still.
    ///
    /// # Panics
    /// When the number of poses is not the number of links.
    pub fn set_arm(&mut self, world_from_links: &[Pose], world_from_tcp: &Pose) {
        if let Some(arm) = &mut self.arm {
            assert_eq!(world_from_links.len(), arm.names.len(), "one pose per link");
            arm.set(&mut self.physics, world_from_links, world_from_tcp);
        }
    }

    /// Lets cartons come to rest before the start: nobody sleeps, nothing is reported.
    pub fn settle(&mut self, span: SimDuration) {
        let dt = self.spec.timestep.as_secs_f64();
        let steps = span.as_nanos() / self.spec.timestep.as_nanos().max(1);
        self.physics.integration_parameters.dt = dt as f32;
        self.physics.integration_parameters.num_solver_iterations = self.spec.substeps.max(1);
        for _ in 0..steps {
            self.physics.wake_up_all(true);
            self.physics.step_with_events(&self.belts, &());
        }
        for carton in self.cartons.values_mut() {
            let pose = from_glam(self.physics.bodies[carton.body].position());
            carton.rest = Point::from(pose.translation.vector);
        }
    }

    /// Advances the world by one time step and reports what happened, in a fixed order:
    /// grips, belts, floor, neighbours, collisions; each by carton id.
    ///
    /// `valves`: one command per section of the gripper, in its order.
    ///
    /// Near cartons the step is solved in parts of one solver iteration each, so that the cups'
    /// springs see short steps; elsewhere in one part with as many iterations.
    /// Contacts are solved over equal spans in both cases.
    pub fn step(&mut self, valves: &[bool]) -> Vec<WorldEvent> {
        let dt = self.spec.timestep.as_secs_f64();
        let substeps = self.spec.substeps.max(1);
        let close = self.begin_step(dt);
        let parts = if close { substeps } else { 1 };
        let part_dt = dt / parts as f64;
        self.physics.integration_parameters.dt = part_dt as f32;
        self.physics.integration_parameters.num_solver_iterations = substeps / parts;
        for part in 0..parts {
            let share = (part + 1) as f64 / parts as f64;
            self.step_part(valves, share, dt, part_dt);
        }
        let mut events = Vec::new();
        if let Some(arm) = &mut self.arm {
            arm.end_step();
            for event in arm.state.take_events() {
                let carton = event.carton();
                if let Some(carton) = self.cartons.get(&carton) {
                    events.push(world_event(event, &self.loads, carton.mass));
                }
            }
        }
        self.watch_belts(&mut events);
        self.watch_floor(&mut events);
        self.watch_neighbours(&mut events);
        self.watch_collisions(dt, &mut events);
        events
    }

    /// Measures the tool's motion; true when a carton is close to the cups.
    fn begin_step(&mut self, dt: f64) -> bool {
        let Some(arm) = &mut self.arm else {
            return false;
        };
        if !arm.is_placed() {
            return false;
        }
        arm.begin_step(dt);
        self.loads.add(arm, &self.spec.gravity, dt);
        let velocity = arm.tool.velocity(dt);
        cups::probe(&self.physics, &self.cartons, arm, velocity).close
    }

    /// One part of a step: cup forces of this instant, then the engine.
    fn step_part(&mut self, valves: &[bool], share: f64, dt: f64, part_dt: f64) {
        let Some(arm) = self.arm.as_mut().filter(|arm| arm.is_placed()) else {
            self.physics.step_with_events(&self.belts, &());
            return;
        };
        let velocity = arm.tool.velocity(dt);
        let contacts: Vec<CupContact> =
            cups::probe(&self.physics, &self.cartons, arm, velocity).contacts;
        let forces = arm.state.update(&arm.gripper, valves, &contacts, part_dt);
        cups::apply(&mut self.physics, &self.cartons, arm, &contacts, &forces);
        arm.aim(&mut self.physics, share);
        self.physics.step_with_events(&self.belts, &());
        self.collisions
            .collect(&self.physics, &self.cartons, arm, &forces, part_dt);
    }

    /// All cartons by ascending id.
    pub fn cartons(&self) -> Vec<CartonState> {
        let all = self.cartons.iter();
        all.map(|(&id, carton)| carton.state(&self.physics, CartonId(id)))
            .collect()
    }

    /// One carton.
    pub fn carton(&self, id: CartonId) -> Option<CartonState> {
        let carton = self.cartons.get(&id.0)?;
        Some(carton.state(&self.physics, id))
    }

    /// The gripper's pressures, switches and seals; `None` without an arm.
    pub fn gripper(&self) -> Option<&GripperState> {
        self.arm.as_ref().map(|arm| &arm.state)
    }

    /// What the vacuum pump can reach from now on, Pa below ambient: a failing supply.
    pub fn set_available_vacuum(&mut self, vacuum: f64) {
        if let Some(arm) = &mut self.arm {
            arm.state.set_available_vacuum(vacuum);
        }
    }

    /// What the world was made from.
    pub fn spec(&self) -> &WorldSpec {
        &self.spec
    }
}
