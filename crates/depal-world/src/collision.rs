use std::collections::BTreeMap;

use depal_frames::Vector;
use depal_gripper::CupForce;
use rapier3d::prelude::{ColliderHandle, PhysicsWorld};

use crate::WorldSpec;
use crate::arm::Arm;
use crate::cartons::Carton;
use crate::engine::{Owner, touches};

/// Penetration of a kinematic into a fixed body that counts as contact, m.
const RIGID_DEPTH: f64 = 0.001;
/// Cosine to the tool's axis from which a contact counts as pressing along it.
const ALONG: f64 = 0.7;

/// Forces above which a contact counts, N.
#[derive(Clone, Copy)]
struct Limits {
    arm: f64,
    held: f64,
    crush: f64,
}

/// Finds collisions: contact forces that stay above their limit for the given span.
pub(crate) struct CollisionWatch {
    limits: Limits,
    span: f64,
    /// The step in hand.
    loads: BTreeMap<(Owner, Owner), Load>,
    presses: BTreeMap<(Owner, Owner), Press>,
}

/// What acts between a pair during a step.
#[derive(Clone, Copy)]
struct Load {
    /// N s; infinite between rigid bodies.
    impulse: f64,
    /// Force that is too much for this pair, N.
    limit: f64,
}

/// A pair above its limit.
#[derive(Default)]
struct Press {
    span: f64,
    peak: f64,
    reported: bool,
}

impl CollisionWatch {
    pub fn new(spec: &WorldSpec) -> Self {
        Self {
            limits: Limits {
                arm: spec.collision_force,
                held: spec.held_collision_force,
                crush: spec.crush_force,
            },
            span: spec.collision_span.as_secs_f64(),
            loads: BTreeMap::new(),
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
        let axis = arm.tool.to.rotation * Vector::z();
        for id in arm.state.held_cartons() {
            let Some(carton) = cartons.get(&id) else {
                continue;
            };
            for touch in touches(physics, carton.collider) {
                let along = touch.normal.dot(&axis).abs() > ALONG;
                let limit = if along {
                    self.limits.crush
                } else {
                    self.limits.held
                };
                if !moves_with_arm(touch.other) {
                    self.add(Owner::Carton(id), touch.other, touch.impulse, limit);
                }
            }
        }
        for force in forces.iter().filter(|force| force.pull < 0.0) {
            let carton = Owner::Carton(force.carton);
            self.add(Owner::Cups, carton, -force.pull * dt, self.limits.crush);
        }
    }

    fn collect_from(&mut self, physics: &PhysicsWorld, owner: Owner, collider: ColliderHandle) {
        for touch in touches(physics, collider) {
            if matches!(touch.other, Owner::Fixed(_) | Owner::Conveyor(_)) {
                if touch.depth > RIGID_DEPTH {
                    self.add(owner, touch.other, f64::INFINITY, self.limits.arm);
                }
            } else {
                self.add(owner, touch.other, touch.impulse, self.limits.arm);
            }
        }
    }

    fn add(&mut self, a: Owner, b: Owner, impulse: f64, limit: f64) {
        let none = Load {
            impulse: 0.0,
            limit,
        };
        let load = self.loads.entry((a, b)).or_insert(none);
        load.impulse += impulse;
        load.limit = limit;
    }

    /// Ends a step of `dt` seconds: the collisions that have now lasted long enough.
    pub fn finish(&mut self, dt: f64) -> Vec<(Owner, Owner, f64)> {
        let loads = std::mem::take(&mut self.loads);
        let above = |load: &Load| load.impulse / dt > load.limit;
        self.presses
            .retain(|pair, _| loads.get(pair).is_some_and(above));
        let mut found = Vec::new();
        for (&pair, load) in loads.iter().filter(|(_, load)| above(load)) {
            let press = self.presses.entry(pair).or_default();
            press.span += dt;
            press.peak = press.peak.max(load.impulse / dt);
            // Half a step of slack against rounding of the sum.
            if !press.reported && press.span + 0.5 * dt >= self.span {
                press.reported = true;
                found.push((pair.0, pair.1, press.peak));
            }
        }
        found
    }
}

/// Links and tool move together.
fn moves_with_arm(owner: Owner) -> bool {
    matches!(owner, Owner::Link(_) | Owner::Tool)
}
