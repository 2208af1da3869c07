//! Boxes and balls around solids: mostly they tell at once that two solids are apart.

use depal_frames::{PlacedShape, Pose, convert};
use parry3d::{
    bounding_volume::Aabb,
    math::{Pose as Pose32, Vector as Vector32},
    query,
    shape::SharedShape,
};

use crate::transfer::oriented::Oriented;

/// Boxes that seem apart by less than this may meet by rounding, m.
const ROUNDING: f64 = 1e-5;

/// The box around a solid, on the solid's parent.
pub(crate) struct BoxAround {
    frame_from_box: Pose,
    /// Half of its sides, m.
    half: [f64; 3],
    /// From its middle to a corner, m.
    reach: f64,
    /// It is the solid itself.
    pub is_solid: bool,
}

/// The box around a solid in the base frame, and the ball around that.
pub(crate) struct Bounds {
    pub around: Oriented,
    /// Radius of the ball, m.
    reach: f64,
}

impl Bounds {
    /// The solids cannot meet, which the balls tell at once; they may not be able to tell.
    #[inline]
    pub fn clear_of(&self, other: &Self) -> bool {
        self.balls_apart(other, ROUNDING)
    }

    /// The balls are more than `gap` metres apart.
    #[inline]
    fn balls_apart(&self, other: &Self, gap: f64) -> bool {
        let (a, b) = (&self.around.centre, &other.around.centre);
        let between = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let far = self.reach + other.reach + gap;
        between.iter().map(|d| d * d).sum::<f64>() > far * far
    }

    /// The solids in them are `distance` metres apart, or more.
    pub fn apart(&self, other: &Self, distance: f32) -> bool {
        let distance = f64::from(distance) + ROUNDING;
        self.balls_apart(other, distance) || self.around.least_distance(&other.around) >= distance
    }
}

impl BoxAround {
    /// Of a placed shape and what [`crate::world::solid`] made of it.
    pub fn new(placed: &PlacedShape, frame_from_shape: &Pose32, shape: &SharedShape) -> Self {
        let is_solid = shape.as_cuboid().is_some();
        let around = shape.compute_local_aabb();
        let (centre, half) = (around.center(), around.half_extents());
        let frame_from_box = if is_solid {
            placed.pose
        } else {
            let centre = [centre.x, centre.y, centre.z].map(f64::from);
            convert::from_glam(frame_from_shape)
                * Pose::translation(centre[0], centre[1], centre[2])
        };
        let half = [half.x, half.y, half.z].map(f64::from);
        Self {
            frame_from_box,
            half,
            reach: half.iter().map(|h| h * h).sum::<f64>().sqrt(),
            is_solid,
        }
    }

    /// Where it is when the parent is there.
    pub fn at(&self, base_from_frame: &Pose) -> Bounds {
        Bounds {
            around: Oriented::new(&(base_from_frame * self.frame_from_box), self.half),
            reach: self.reach,
        }
    }
}

/// The upright box around a box, `grown` metres on every side, a hair wider than what rounding takes away.
pub(crate) fn upright(bounds: &Bounds, grown: f64) -> Aabb {
    let (centre, half) = (bounds.around.centre, bounds.around.extents());
    let side = |i: usize, sign: f64| (centre[i] + sign * (half[i] + grown + ROUNDING)) as f32;
    let corner = |sign: f64| Vector32::new(side(0, sign), side(1, sign), side(2, sign));
    Aabb::new(corner(-1.0), corner(1.0))
}

/// Whether two solids meet. Their boxes tell first: they are much quicker, and mostly apart.
pub(crate) fn meet(
    bounds: (&Bounds, &Bounds),
    are_boxes: bool,
    solids_meet: impl FnOnce() -> bool,
) -> bool {
    if bounds.0.clear_of(bounds.1) {
        return false;
    }
    let (around, other) = (&bounds.0.around, &bounds.1.around);
    if are_boxes {
        return around.meets(other, 0.0);
    }
    around.meets(other, ROUNDING) && solids_meet()
}

/// The same by the solids alone.
pub(crate) fn solids_meet(
    pose: &Pose32,
    shape: &SharedShape,
    other_pose: &Pose32,
    other: &SharedShape,
) -> bool {
    query::intersection_test(pose, shape.as_ref(), other_pose, other.as_ref())
        .is_ok_and(|m| m.intersecting)
}
