use depal_frames::convert::{from_glam, to_glam};
use depal_frames::{PlacedShape, Pose, Vector};
use depal_gripper::{GripperSpec, GripperState};
use rapier3d::prelude::*;

use crate::engine::{Owner, collider};

/// A chain of kinematic bodies: the links, and the tool last.
pub(crate) struct Arm {
    pub names: Vec<String>,
    links: Vec<Follower>,
    pub tool: Follower,
    pub gripper: GripperSpec,
    pub state: GripperState,
    /// Tool velocity in this step and the one before, m/s.
    pub tool_velocity: Vector,
    pub tool_acceleration: Vector,
    placed: bool,
}

/// A kinematic body that follows a pose.
pub(crate) struct Follower {
    body: RigidBodyHandle,
    pub colliders: Vec<ColliderHandle>,
    pub shapes: Vec<PlacedShape>,
    /// At the start of the step, and at its end.
    pub from: Pose,
    pub to: Pose,
}

impl Follower {
    fn insert(
        physics: &mut PhysicsWorld,
        shapes: &[PlacedShape],
        owner: Owner,
        friction: f64,
    ) -> Self {
        let body = physics.insert_body(RigidBodyBuilder::kinematic_position_based());
        // The base link stands on the floor: only the others can hit fixed bodies.
        let types = if owner == Owner::Link(0) {
            ActiveCollisionTypes::default()
        } else {
            ActiveCollisionTypes::default() | ActiveCollisionTypes::KINEMATIC_FIXED
        };
        let colliders = shapes.iter().map(|placed| {
            let built = collider(placed, owner, friction).active_collision_types(types);
            physics.insert_collider(built, Some(body))
        });
        Self {
            body,
            colliders: colliders.collect(),
            shapes: shapes.to_vec(),
            from: Pose::identity(),
            to: Pose::identity(),
        }
    }

    /// Pose at a share of the step: straight line and great arc between its ends.
    pub fn at(&self, share: f64) -> Pose {
        let line = self
            .from
            .translation
            .vector
            .lerp(&self.to.translation.vector, share);
        let turn = self.from.rotation.rotation_to(&self.to.rotation);
        Pose::from_parts(line.into(), turn.powf(share) * self.from.rotation)
    }

    /// Linear and angular velocity during a step of `dt` seconds, world frame.
    pub fn velocity(&self, dt: f64) -> (Vector, Vector) {
        let line = self.to.translation.vector - self.from.translation.vector;
        let turn = self.from.rotation.rotation_to(&self.to.rotation);
        (line / dt, turn.scaled_axis() / dt)
    }

    fn put(&mut self, physics: &mut PhysicsWorld, pose: Pose) {
        self.from = pose;
        self.to = pose;
        physics.bodies[self.body].set_position(to_glam(&pose), true);
    }

    fn aim(&self, physics: &mut PhysicsWorld, share: f64) {
        let target = if share >= 1.0 {
            self.to
        } else {
            self.at(share)
        };
        physics.bodies[self.body].set_next_kinematic_position(to_glam(&target));
    }

    /// Where the engine has it now.
    pub fn pose(&self, physics: &PhysicsWorld) -> Pose {
        from_glam(physics.bodies[self.body].position())
    }
}

impl Arm {
    pub fn insert(
        physics: &mut PhysicsWorld,
        links: &[(String, Vec<PlacedShape>)],
        gripper: &GripperSpec,
        friction: f64,
    ) -> Self {
        let followers = links.iter().enumerate().map(|(index, (_, shapes))| {
            Follower::insert(physics, shapes, Owner::Link(index as u32), friction)
        });
        Self {
            names: links.iter().map(|(name, _)| name.clone()).collect(),
            links: followers.collect(),
            tool: Follower::insert(physics, &gripper.bodies, Owner::Tool, friction),
            gripper: gripper.clone(),
            state: GripperState::new(gripper),
            tool_velocity: Vector::zeros(),
            tool_acceleration: Vector::zeros(),
            placed: false,
        }
    }

    /// Sets the poses at the end of the next step; the first call puts the arm there at once.
    pub fn set(&mut self, physics: &mut PhysicsWorld, links: &[Pose], tool: &Pose) {
        let poses = links.iter().chain([tool]);
        for (follower, pose) in self.links.iter_mut().chain([&mut self.tool]).zip(poses) {
            if self.placed {
                follower.to = *pose;
            } else {
                follower.put(physics, *pose);
            }
        }
        self.placed = true;
    }

    /// Gives the engine the poses at a share of the step.
    pub fn aim(&self, physics: &mut PhysicsWorld, share: f64) {
        for follower in self.followers() {
            follower.aim(physics, share);
        }
    }

    /// Measures the tool's motion at the start of a step of `dt` seconds.
    pub fn begin_step(&mut self, dt: f64) {
        let (velocity, _) = self.tool.velocity(dt);
        self.tool_acceleration = (velocity - self.tool_velocity) / dt;
        self.tool_velocity = velocity;
    }

    /// The step is over: without new poses the arm stands still.
    pub fn end_step(&mut self) {
        for follower in self.links.iter_mut().chain([&mut self.tool]) {
            follower.from = follower.to;
        }
    }

    /// True once the arm has been given a pose.
    pub fn is_placed(&self) -> bool {
        self.placed
    }

    /// Takes the arm out of the engine.
    pub fn remove(self, physics: &mut PhysicsWorld) {
        for follower in self.followers() {
            physics.remove_body(follower.body);
        }
    }

    /// Links in order, then the tool.
    pub fn followers(&self) -> impl Iterator<Item = &Follower> {
        self.links.iter().chain([&self.tool])
    }
}
