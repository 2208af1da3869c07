//! Whether cartons stand where a pattern wants them, by truth.

use depal_frames::{Pose, Vector};
use depal_world::World;

/// A carton farther than this from its place has missed it, metres.
const PLACE_DISTANCE: f64 = 0.020;
/// ... or turned by more than this, radians.
const PLACE_ANGLE: f64 = 0.052;

/// What a round aims at.
#[derive(Debug, Clone, Default)]
pub(crate) struct Aim {
    /// The cartons, by truth.
    pub(crate) cartons: Vec<u32>,
    /// `base_from_place` of a pattern: middle of the bottom face, X along the long side; none for the belt.
    pub(crate) place: Option<Pose>,
}

/// How far a carton is from its place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Deviation {
    /// Of the middle of the bottom face, metres.
    pub(crate) distance: f64,
    /// Of the long side about the vertical, and of the upright; the larger one, radians. Half turns do not count.
    pub(crate) angle: f64,
}

impl Deviation {
    /// Near enough to count as placed.
    pub(crate) fn is_small(self) -> bool {
        self.distance <= PLACE_DISTANCE && self.angle <= PLACE_ANGLE
    }
}

/// Deviation of a carton from a place; none when the carton is gone.
pub(crate) fn deviation(world: &World, carton: u32, world_from_place: &Pose) -> Option<Deviation> {
    let cartons = world.cartons();
    let carton = cartons.iter().find(|c| c.id.0 == carton)?;
    let bottom = carton.world_from_centre * Pose::translation(0.0, 0.0, -0.5 * carton.size.height);
    let here = world_from_place.inverse() * bottom;
    let long = here.rotation * Vector::x();
    let up = here.rotation * Vector::z();
    Some(Deviation {
        distance: here.translation.vector.norm(),
        angle: long
            .y
            .abs()
            .atan2(long.x.abs())
            .max(up.z.clamp(-1.0, 1.0).acos()),
    })
}
