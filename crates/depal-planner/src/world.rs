use depal_frames::{PlacedShape, Point, Pose, Rotation, Shape, Vector, convert};
use nalgebra::Translation3;
use parry3d::{
    bounding_volume::Aabb,
    math::Pose as Pose32,
    partitioning::{Bvh, BvhBuildStrategy},
    query,
    shape::SharedShape,
};

use crate::{
    bodies::Body,
    bounds::{Bounds, BoxAround, meet, solids_meet, upright},
    refusal::Obstacle,
    request::{PlanRequest, SeenBox},
};

/// A shape of the collision library and where it sits on its parent.
///
/// The library's cylinders lie along Y, ours along Z.
pub(crate) fn solid(placed: &PlacedShape, padding: f64) -> (Pose32, SharedShape) {
    let pad = padding as f32;
    let turned = |turn: Rotation| convert::to_glam(&(placed.pose * turn));
    let upright = Rotation::identity();
    match &placed.shape {
        Shape::Cuboid { half_extents } => {
            let [x, y, z] = [0, 1, 2].map(|i| (half_extents[i] as f32 + pad).max(1e-4));
            (turned(upright), SharedShape::cuboid(x, y, z))
        }
        Shape::Capsule {
            half_length,
            radius,
        } => (
            turned(upright),
            SharedShape::capsule_z(*half_length as f32, *radius as f32 + pad),
        ),
        Shape::Cylinder {
            half_length,
            radius,
        } => (
            turned(Rotation::from_axis_angle(
                &Vector::x_axis(),
                std::f64::consts::FRAC_PI_2,
            )),
            SharedShape::cylinder(*half_length as f32 + pad, *radius as f32 + pad),
        ),
        Shape::Sphere { radius } => (turned(upright), SharedShape::ball(*radius as f32 + pad)),
        Shape::Hull(hull) => {
            let corners: Vec<_> = hull.vertices().iter().map(convert::point_to_glam).collect();
            let solid = if pad > 0.0 {
                SharedShape::round_convex_hull(&corners, pad)
            } else {
                SharedShape::convex_hull(&corners)
            };
            let half = hull.half_extents();
            let [x, y, z] = [0, 1, 2].map(|i| half[i] as f32 + pad);
            let boxed = || SharedShape::cuboid(x, y, z);
            (turned(upright), solid.unwrap_or_else(boxed))
        }
    }
}

/// Distance of two solids, m, 0 when they meet; none for shapes that cannot be measured.
///
/// For two boxes the library would look along the separating axis of largest gap only, which gives too much (some percent)
/// where an edge or a corner is nearest. The descent for convex solids is exact.
pub(crate) fn distance(
    pose: &Pose32,
    shape: &SharedShape,
    other_pose: &Pose32,
    other: &SharedShape,
) -> Option<f32> {
    if let (Some(a), Some(b)) = (shape.as_cuboid(), other.as_cuboid()) {
        let between = pose.inv_mul(other_pose);
        return Some(query::details::distance_support_map_support_map(
            &between, a, b,
        ));
    }
    query::distance(pose, shape.as_ref(), other_pose, other.as_ref())
        .ok()
        .map(|d| d.distance)
}

/// Whether a point lies in a seen box grown by `tolerance`, or in the unseen column below it.
fn belongs_to(point: &Point, seen: &SeenBox, tolerance: f64) -> bool {
    let in_box = seen.base_from_box.inverse() * point;
    in_box.x.abs() <= seen.size.length * 0.5 + tolerance
        && in_box.y.abs() <= seen.size.width * 0.5 + tolerance
        && in_box.z <= tolerance
}

struct Solid {
    what: Obstacle,
    pose: Pose32,
    shape: SharedShape,
    bounds: Bounds,
    is_box: bool,
}

impl Solid {
    fn is_one_of(&self, boxes: &[usize]) -> bool {
        matches!(self.what, Obstacle::Box(i) if boxes.contains(&i))
    }
}

/// Everything the arm must not touch, thickened by one padding.
pub(crate) struct World {
    solids: Vec<Solid>,
    tree: Bvh,
}

impl World {
    pub fn new(request: &PlanRequest, padding: f64) -> Self {
        let mut solids = Vec::new();
        let mut add = |what: Obstacle, placed: &PlacedShape| {
            let (pose, shape) = solid(placed, padding);
            let around = BoxAround::new(placed, &pose, &shape);
            solids.push(Solid {
                what,
                pose,
                shape,
                bounds: around.at(&Pose::identity()),
                is_box: around.is_solid,
            });
        };
        for (i, seen) in request.boxes.iter().enumerate() {
            let size = seen.size;
            let body = PlacedShape::cuboid(
                seen.base_from_box * Pose::translation(0.0, 0.0, -size.height * 0.5),
                Vector::new(size.length, size.width, size.height),
            );
            add(Obstacle::Box(i), &body);
            // Nobody sees what stands below: solid down to the floor, upright.
            let at = seen.base_from_box.translation.vector;
            let bottom = at.z - size.height;
            if bottom > 0.01 {
                let long = seen.base_from_box.rotation * Vector::x();
                let yaw = Rotation::from_axis_angle(&Vector::z_axis(), long.y.atan2(long.x));
                let middle = Translation3::new(at.x, at.y, bottom * 0.5);
                let column = PlacedShape::cuboid(
                    Pose::from_parts(middle, yaw),
                    Vector::new(size.length, size.width, bottom),
                );
                add(Obstacle::BelowBox(i), &column);
            }
        }
        for (i, known) in request.known_obstacles.iter().enumerate() {
            add(Obstacle::Known(i), known);
        }
        let side = request.settings.point_size;
        for point in request.obstacle_points {
            // Rims, tape and noise of a box go where the box goes; it is an obstacle itself.
            if request
                .boxes
                .iter()
                .any(|b| belongs_to(point, b, request.settings.stack_tolerance))
            {
                continue;
            }
            let cube = PlacedShape::cuboid(
                Pose::from_parts(Translation3::from(point.coords), Rotation::identity()),
                Vector::new(side, side, side),
            );
            add(Obstacle::SeenPoint(Point::from(point.coords)), &cube);
        }
        let leaves: Vec<Aabb> = solids
            .iter()
            .map(|s| s.shape.compute_aabb(&s.pose))
            .collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves);
        Self { solids, tree }
    }

    /// Highest point of what is known of the cell within `reach` metres of a place, seen from above; none if nothing is.
    pub fn rim(&self, at: &Vector, reach: f64) -> Option<f64> {
        let known = self
            .solids
            .iter()
            .filter(|s| matches!(s.what, Obstacle::Known(_)));
        let near = known.filter_map(|s| {
            let around = s.shape.compute_aabb(&s.pose);
            let beyond = |low: f32, high: f32, at: f64| {
                (f64::from(low) - at).max(at - f64::from(high)).max(0.0)
            };
            let x = beyond(around.mins.x, around.maxs.x, at.x);
            let y = beyond(around.mins.y, around.maxs.y, at.y);
            (x.hypot(y) <= reach).then_some(f64::from(around.maxs.z))
        });
        near.reduce(f64::max)
    }

    /// What a body meets, the first in a fixed order. `frames` are those of [`crate::bodies::Robot::frames`],
    /// `bounds` is the box around the body there.
    pub fn meets(
        &self,
        body: &Body,
        frames: &[Pose],
        bounds: &Bounds,
        without: &[usize],
    ) -> Option<Obstacle> {
        self.tree
            .intersect_aabb(&upright(bounds, 0.0))
            .map(|i| &self.solids[i as usize])
            .filter(|s| !s.is_one_of(without))
            .find(|s| {
                meet((bounds, &s.bounds), body.is_box() && s.is_box, || {
                    solids_meet(&body.pose(frames), &body.shape, &s.pose, &s.shape)
                })
            })
            .map(|s| s.what)
    }

    /// Distance of a body to the nearest obstacle, m, at most `cap`, and which it is.
    pub fn distance(
        &self,
        body: &Body,
        pose: &Pose32,
        bounds: &Bounds,
        without: &[usize],
        cap: f32,
    ) -> (f32, Option<Obstacle>) {
        let mut nearest = (cap, None);
        for i in self.tree.intersect_aabb(&upright(bounds, f64::from(cap))) {
            let s = &self.solids[i as usize];
            if s.is_one_of(without) || bounds.apart(&s.bounds, nearest.0) {
                continue;
            }
            if let Some(d) = distance(pose, &body.shape, &s.pose, &s.shape)
                && d < nearest.0
            {
                nearest = (d, Some(s.what));
            }
        }
        nearest
    }
}
