use std::collections::BTreeMap;

use depal_gripper::CupForce;
use rapier3d::prelude::{ColliderHandle, PhysicsWorld};

use crate::arm::Arm;
use crate::cartons::Carton;
use crate::engine::{Owner, touches};

/// Penetration of a kinematic into a fixed body that counts as contact, m.
const RIGID_DEPTH: f64 = 0.001;

/// Finds collisions: contact forces that stay above the limit for the given span.
pub(crate) struct CollisionWatch {
    limit: f64,
    span: f64,
    /// Impulses of the step in hand, N s; infinite between rigid bodies.
    impulses: BTreeMap<(Owner, Owner), f64>,
    presses: BTreeMap<(Owner, Owner), Press>,
}

/// A pair above the limit.
#[derive(Default)]
struct Press {
    span: f64,
    peak: f64,
    reported: bool,
}

impl CollisionWatch {
    pub fn new(limit: f64, span: f64) -> Self {
        Self {
            limit,
            span,
            impulses: BTreeMap::new(),
            presses: BTreeMap::new(),
        }
    }

    /// Adds the contacts of one engine step of `dt` seconds.
    pub fn collect(
        &mut self,
        physics: &PhysicsWorld,
        cartons: &BTreeMap<u32, Carton>,
        arm: &Arm,
        forces: &[CupForce],
        dt: f64,
    ) {
        let links = arm.names.len() as u32;
        for (index, follower) in arm.followers().enumerate() {
            let index = index as u32;
            let owner = if index < links {
                Owner::Link(index)
            } else {
                Owner::Tool
            };
            for &collider in &follower.colliders {
                self.collect_from(physics, owner, collider);
            }
        }
        for id in arm.state.held_cartons() {
            if let Some(carton) = cartons.get(&id) {
                self.collect_from(physics, Owner::Carton(id), carton.collider);
            }
        }
        for force in forces {
            if force.pull < 0.0 {
                self.add(Owner::Cups, Owner::Carton(force.carton), -force.pull * dt);
            }
        }
    }

    fn collect_from(&mut self, physics: &PhysicsWorld, owner: Owner, collider: ColliderHandle) {
        for touch in touches(physics, collider) {
            let moving = |owner| matches!(owner, Owner::Link(_) | Owner::Tool);
            let fixed = matches!(touch.other, Owner::Fixed(_) | Owner::Conveyor(_));
            if moving(owner) && fixed {
                if touch.depth > RIGID_DEPTH {
                    self.add(owner, touch.other, f64::INFINITY);
                }
            } else if !moving(touch.other) {
                self.add(owner, touch.other, touch.impulse);
            }
        }
    }

    fn add(&mut self, a: Owner, b: Owner, impulse: f64) {
        *self.impulses.entry((a, b)).or_default() += impulse;
    }

    /// Ends a step of `dt` seconds: the collisions that have now lasted long enough.
    pub fn finish(&mut self, dt: f64) -> Vec<(Owner, Owner, f64)> {
        let impulses = std::mem::take(&mut self.impulses);
        let above = |pair: &(Owner, Owner)| {
            let force = impulses.get(pair).copied().unwrap_or(0.0) / dt;
            (force > self.limit).then_some(force)
        };
        self.presses.retain(|pair, _| above(pair).is_some());
        let mut found = Vec::new();
        for &pair in impulses.keys() {
            let Some(force) = above(&pair) else { continue };
            let press = self.presses.entry(pair).or_default();
            press.span += dt;
            press.peak = press.peak.max(force);
            // Half a step of slack against rounding of the sum.
            if !press.reported && press.span + 0.5 * dt >= self.span {
                press.reported = true;
                found.push((pair.0, pair.1, press.peak));
            }
        }
        found
    }
}
