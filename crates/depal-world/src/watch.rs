//! What happens to cartons apart from the cups: belts, floor, disturbed neighbours.

use std::collections::BTreeSet;

use depal_frames::Point;
use depal_frames::convert::{from_glam, vector_from_glam};

use crate::engine::{Owner, touches};
use crate::{Body, CartonId, World, WorldEvent};

/// A carton closer to a surface than this lies on it, m.
const TOUCH: f64 = 0.001;
/// A carton that moved farther than this was disturbed, m.
const DISTURBED: f64 = 0.010;
/// A carton slower than this lies still, m/s ...
const STILL: f64 = 0.01;
/// ... if it stays so for this many steps: what is let go hangs still for an instant before it falls.
const STILL_STEPS: u32 = 25;

impl World {
    /// Ids of the cartons that touch a collider's owner, ascending.
    fn cartons_on(&self, colliders: &[rapier3d::prelude::ColliderHandle]) -> BTreeSet<u32> {
        let all = colliders.iter().flat_map(|&c| touches(&self.physics, c));
        all.filter_map(|touch| match touch.other {
            Owner::Carton(id) if touch.depth > -TOUCH => Some(id),
            _ => None,
        })
        .collect()
    }

    /// First touches of belts and deliveries.
    pub(crate) fn watch_belts(&mut self, events: &mut Vec<WorldEvent>) {
        for carton in self.cartons.values_mut() {
            carton.on_belt = false;
        }
        for index in 0..self.spec.conveyors.len() {
            let on = self.cartons_on(&self.conveyor_colliders[index..=index]);
            let conveyor = &self.spec.conveyors[index];
            let Some(direction) = conveyor.direction.try_normalize(0.0) else {
                continue;
            };
            for id in on {
                let Some(carton) = self.cartons.get_mut(&id) else {
                    continue;
                };
                carton.on_belt = true;
                if !carton.touched_belt {
                    carton.touched_belt = true;
                    events.push(WorldEvent::CartonTouchedBelt {
                        carton: CartonId(id),
                        conveyor: conveyor.name.clone(),
                    });
                }
                let centre = from_glam(self.physics.bodies[carton.body].position());
                let middle = conveyor.belt.pose.translation.vector;
                let travelled = (centre.translation.vector - middle).dot(&direction);
                if travelled >= conveyor.delivered_at && !carton.delivered {
                    carton.delivered = true;
                    events.push(WorldEvent::CartonDelivered {
                        carton: CartonId(id),
                        conveyor: conveyor.name.clone(),
                    });
                }
            }
        }
    }

    /// Cartons that reached the floor.
    pub(crate) fn watch_floor(&mut self, events: &mut Vec<WorldEvent>) {
        for id in self.cartons_on(&self.floor_colliders) {
            if let Some(carton) = self.cartons.get_mut(&id).filter(|c| !c.on_floor) {
                carton.on_floor = true;
                events.push(WorldEvent::CartonOnFloor {
                    carton: CartonId(id),
                });
            }
        }
    }

    /// Cartons that were moved though nobody holds them.
    pub(crate) fn watch_neighbours(&mut self, events: &mut Vec<WorldEvent>) {
        let at_cups = self.arm.as_ref().map(|arm| arm.state.cartons_at_cups());
        let at_cups = at_cups.unwrap_or_default();
        for (&id, carton) in &mut self.cartons {
            let body = &self.physics.bodies[carton.body];
            if body.is_sleeping() {
                continue;
            }
            let centre = Point::from(from_glam(body.position()).translation.vector);
            if at_cups.contains(&id) || carton.on_belt {
                // Let go, it may still fall or slide: that is no neighbour's disturbance.
                carton.rest = centre;
                carton.disturbed = true;
                carton.still_steps = 0;
                continue;
            }
            let distance = (centre - carton.rest).norm();
            if carton.disturbed || carton.on_floor || carton.delivered {
                let is_still = vector_from_glam(body.linvel()).norm() < STILL;
                carton.still_steps = if is_still { carton.still_steps + 1 } else { 0 };
                if carton.still_steps >= STILL_STEPS {
                    carton.rest = centre;
                    carton.disturbed = false;
                }
            } else if distance > DISTURBED {
                carton.disturbed = true;
                carton.still_steps = 0;
                events.push(WorldEvent::NeighbourMoved {
                    carton: CartonId(id),
                    distance,
                });
            }
        }
    }

    /// Contact forces above the limit.
    pub(crate) fn watch_collisions(&mut self, dt: f64, events: &mut Vec<WorldEvent>) {
        for (a, b, force_n) in self.collisions.finish(dt) {
            events.push(WorldEvent::Collision {
                a: self.body_of(a),
                b: self.body_of(b),
                force_n,
            });
        }
    }

    fn body_of(&self, owner: Owner) -> Body {
        match owner {
            Owner::Fixed(index) => Body::Fixed(self.spec.fixed[index as usize].name.clone()),
            Owner::Conveyor(index) => {
                Body::Conveyor(self.spec.conveyors[index as usize].name.clone())
            }
            Owner::Carton(id) => Body::Carton(CartonId(id)),
            Owner::Link(index) => {
                let names = self.arm.as_ref().map(|arm| &arm.names);
                Body::Link(names.map_or_else(String::new, |n| n[index as usize].clone()))
            }
            Owner::Tool => Body::Tool,
            Owner::Cups => Body::Cups,
        }
    }
}
