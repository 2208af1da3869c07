//! Solids taken apart into surfaces whose image rows have a closed form, in a view's own frame.

use depal_frames::nalgebra::Matrix3;
use depal_frames::{Point, Pose, Shape, Vector};

use crate::TriangleMesh;
use crate::facets::{Facet, normal_of};
use crate::rounded::RoundedBox;

/// Edges of a smaller radius are sharp, metres.
const SHARP: f64 = 1e-5;
/// Nearer than this to the view's own plane no bounds are worked out, metres.
const BOUNDS_MIN_DEPTH: f64 = 1e-4;

/// A box in tangent space (x/z, y/z) that holds the image of a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TangentBounds {
    pub x: [f64; 2],
    pub y: [f64; 2],
    /// Bounds of 1/z.
    pub w: [f64; 2],
}

impl TangentBounds {
    const EVERYWHERE: Self = Self {
        x: [f64::NEG_INFINITY, f64::INFINITY],
        y: [f64::NEG_INFINITY, f64::INFINITY],
        w: [0.0, f64::INFINITY],
    };

    /// Bound of 1/z in single precision, a little wider than what is drawn may be off.
    pub fn least(&self) -> f32 {
        (self.w[0] * (1.0 - 2e-6)) as f32
    }

    pub fn most(&self) -> f32 {
        (self.w[1] * (1.0 + 2e-6)) as f32
    }
}

/// Convex outline of three or four corners, turned so that a ray `r` meets it when every
/// `edges[i] . r >= 0`; then 1/z = `normal . r / plane`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Polygon {
    pub normal: Vector,
    /// Distance of the eye from the plane, negative: the polygon faces the eye.
    pub plane: f64,
    pub edges: [Vector; 4],
    pub corners: usize,
}

/// A curved surface or a disk, outward side only (eye at the origin, Z forward).
#[derive(Debug, Clone, Copy)]
pub(crate) enum Round {
    /// Round plate.
    Disk {
        normal: Vector,
        plane: f64,
        centre: Vector,
        radius: f64,
    },
    Sphere {
        centre: Vector,
        radius: f64,
    },
    /// Mantle of a cylinder, without its ends.
    Mantle {
        centre: Vector,
        axis: Vector,
        half_length: f64,
        radius: f64,
    },
    /// All of a box with rounded edges.
    Rounded(RoundedBox),
}

impl Round {
    /// Outward unit normal at a point of the surface.
    pub fn normal_at(&self, point: &Vector) -> Vector {
        match self {
            Self::Disk { normal, .. } => *normal,
            Self::Sphere { centre, radius } => (point - centre) / *radius,
            Self::Mantle {
                centre,
                axis,
                radius,
                ..
            } => {
                let arm = point - centre;
                (arm - axis * arm.dot(axis)) / *radius
            }
            Self::Rounded(rounded) => rounded.normal_at(point),
        }
    }
}

/// A polygon and what holds its image.
pub(crate) type BoundedPolygon = (Polygon, TangentBounds);

/// Takes the surfaces of a solid that turn towards the eye.
pub(crate) trait Collect {
    fn polygon(&mut self, polygon: &Polygon, bounds: TangentBounds);
    fn round(&mut self, round: Round, bounds: TangentBounds);
    /// Takes a box with rounded edges; its faces follow.
    fn rounded(&mut self, rounded: RoundedBox);
    /// Takes a face of the rounded box taken last: that of the sharp box around it, and the part of it
    /// that is flat.
    fn rounded_face(&mut self, whole: &BoundedPolygon, flat: Option<&BoundedPolygon>);
}

/// Hands over the surfaces of a solid that turn towards the eye.
#[inline(always)]
pub(crate) fn collect_shape(
    out: &mut impl Collect,
    view_from_shape: &Pose,
    shape: &Shape,
    edge_radius: f64,
) {
    let centre = view_from_shape.translation.vector;
    if centre.z + shape.bounding_radius() <= 0.0 {
        return;
    }
    match shape {
        Shape::Cuboid { half_extents } => {
            // What is no number is not greater than any.
            if edge_radius > SHARP {
                let radius = edge_radius.min(half_extents.min());
                collect_rounded(out, view_from_shape, half_extents, radius);
            } else {
                collect_cuboid(out, view_from_shape, half_extents);
            }
        }
        Shape::Sphere { radius } => collect_sphere(out, centre, *radius),
        Shape::Hull(hull) => {
            let triangles = hull.triangles().iter().map(|[a, b, c]| [*a, *b, *c, *c]);
            collect_facets(out, view_from_shape, hull.vertices(), triangles);
        }
        Shape::Capsule {
            half_length,
            radius,
        } => {
            let axis = view_from_shape.rotation * Vector::z();
            let nearest = axis * (-centre.dot(&axis)).clamp(-*half_length, *half_length);
            if (centre + nearest).norm_squared() <= radius * radius {
                return; // the eye is inside, where the balls' inner halves would show
            }
            // The inner half of each ball lies inside the capsule and is hidden by its surface.
            collect_sphere(out, centre + axis * *half_length, *radius);
            collect_sphere(out, centre - axis * *half_length, *radius);
            collect_mantle(out, centre, axis, *half_length, *radius);
        }
        Shape::Cylinder {
            half_length,
            radius,
        } => {
            let axis = view_from_shape.rotation * Vector::z();
            collect_mantle(out, centre, axis, *half_length, *radius);
            for normal in [axis, -axis] {
                collect_disk(out, centre + normal * *half_length, normal, *radius);
            }
        }
    }
}

#[inline(always)]
fn collect_cuboid(out: &mut impl Collect, view_from_shape: &Pose, half: &Vector) {
    let rotation = view_from_shape.rotation.to_rotation_matrix();
    let centre = view_from_shape.translation.vector;
    let corners = corners_of(rotation.matrix(), &centre, half);
    for axis in 0..3 {
        for positive in [false, true] {
            if let Some((polygon, bounds)) = face_of(&corners, rotation.matrix(), axis, positive) {
                out.polygon(&polygon, bounds);
            }
        }
    }
}

/// A ray from outside enters the sharp box through one of its faces at most, so that these faces divide
/// up the image of the rounded one too.
#[inline(always)]
fn collect_rounded(out: &mut impl Collect, view_from_shape: &Pose, half: &Vector, radius: f64) {
    let rotation = view_from_shape.rotation.to_rotation_matrix();
    let centre = view_from_shape.translation.vector;
    let corners = corners_of(rotation.matrix(), &centre, half);
    out.rounded(RoundedBox::new(view_from_shape, half, radius));
    for axis in 0..3 {
        let mut flat = half.add_scalar(-radius);
        let is_flat = flat[(axis + 1) % 3].min(flat[(axis + 2) % 3]) > SHARP;
        flat[axis] = half[axis];
        for positive in [false, true] {
            let whole = face_of(&corners, rotation.matrix(), axis, positive);
            let Some(whole) = whole else { continue };
            let flat = if is_flat {
                let corners = corners_of(rotation.matrix(), &centre, &flat);
                face_of(&corners, rotation.matrix(), axis, positive)
            } else {
                None
            };
            out.rounded_face(&whole, flat.as_ref());
        }
    }
}

/// Corner k has the signs of its bits: x = 1, y = 2, z = 4.
#[inline(always)]
fn corners_of(rotation: &Matrix3<f64>, centre: &Vector, half: &Vector) -> [Vector; 8] {
    std::array::from_fn(|k| {
        let sign = |bit: usize| if k & bit == 0 { -1.0 } else { 1.0 };
        centre + rotation * Vector::new(sign(1) * half.x, sign(2) * half.y, sign(4) * half.z)
    })
}

/// A face of the box with these corners; none when it turns away from the eye, is seen edge on or lies
/// behind the eye.
#[inline(always)]
fn face_of(
    corners: &[Vector; 8],
    rotation: &Matrix3<f64>,
    axis: usize,
    positive: bool,
) -> Option<BoundedPolygon> {
    let (b, c) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
    let base = if positive { 1 << axis } else { 0 };
    let column = rotation.column(axis).into_owned();
    let normal = if positive { column } else { -column };
    let plane = normal.dot(&corners[base]);
    if plane >= 0.0 {
        return None;
    }
    // Round the face so that edge normals point inwards as seen from the eye.
    let round = if positive {
        [base, base | c, base | b | c, base | b]
    } else {
        [base, base | b, base | b | c, base | c]
    };
    let quad = round.map(|k| corners[k]);
    let edges = std::array::from_fn(|k| quad[k].cross(&quad[(k + 1) % 4]));
    let polygon = Polygon {
        normal,
        plane,
        edges,
        corners: 4,
    };
    Some((polygon, bounds_of(&quad)?))
}

/// Hands over the facets of a mesh that turn towards the eye.
#[inline(always)]
pub(crate) fn collect_mesh(out: &mut impl Collect, view_from_mesh: &Pose, mesh: &TriangleMesh) {
    if view_from_mesh.translation.z + mesh.bounding_radius() <= 0.0 {
        return;
    }
    let facets = mesh.facets().iter().copied();
    collect_facets(out, view_from_mesh, mesh.vertices(), facets);
}

#[inline(always)]
fn collect_facets(
    out: &mut impl Collect,
    view_from_mesh: &Pose,
    vertices: &[Point],
    facets: impl Iterator<Item = Facet>,
) {
    let rotation = view_from_mesh.rotation.to_rotation_matrix();
    let shift = view_from_mesh.translation.vector;
    let corners: Vec<Vector> = vertices
        .iter()
        .map(|p| rotation * p.coords + shift)
        .collect();
    for facet in facets {
        let quad = facet.map(|k| corners[k as usize]);
        let [a, b, c, d] = quad;
        let is_triangle = facet[2] == facet[3];
        let normal = if is_triangle {
            (b - a).cross(&(c - a))
        } else {
            normal_of(&quad)
        };
        let plane = normal.dot(&a);
        if plane >= 0.0 {
            continue;
        }
        // The last corner of a triangle stands there twice.
        let Some(bounds) = bounds_of(&quad) else {
            continue;
        };
        let scale = 1.0 / normal.norm();
        // Listed counter-clockwise from outside, inwards edges run the other way round.
        let (ba, cb) = (b.cross(&a), c.cross(&b));
        let (edges, count) = if is_triangle {
            ([a.cross(&c), cb, ba, Vector::zeros()], 3)
        } else {
            ([a.cross(&d), d.cross(&c), cb, ba], 4)
        };
        let polygon = Polygon {
            normal: normal * scale,
            plane: plane * scale,
            edges,
            corners: count,
        };
        out.polygon(&polygon, bounds);
    }
}

fn collect_sphere(out: &mut impl Collect, centre: Vector, radius: f64) {
    if centre.norm_squared() <= radius * radius {
        return; // the eye is inside
    }
    if let Some(bounds) = bounds_of(&cube(&centre, radius)) {
        out.round(Round::Sphere { centre, radius }, bounds);
    }
}

fn collect_mantle(
    out: &mut impl Collect,
    centre: Vector,
    axis: Vector,
    half_length: f64,
    radius: f64,
) {
    let off_axis = centre - axis * centre.dot(&axis);
    if off_axis.norm_squared() <= radius * radius {
        return; // the eye looks down the tube and sees its inside only
    }
    let ends = [
        cube(&(centre + axis * half_length), radius),
        cube(&(centre - axis * half_length), radius),
    ]
    .concat();
    if let Some(bounds) = bounds_of(&ends) {
        let mantle = Round::Mantle {
            centre,
            axis,
            half_length,
            radius,
        };
        out.round(mantle, bounds);
    }
}

fn collect_disk(out: &mut impl Collect, centre: Vector, normal: Vector, radius: f64) {
    let plane = normal.dot(&centre);
    if plane >= 0.0 {
        return;
    }
    if let Some(bounds) = bounds_of(&cube(&centre, radius)) {
        let disk = Round::Disk {
            normal,
            plane,
            centre,
            radius,
        };
        out.round(disk, bounds);
    }
}

fn cube(centre: &Vector, radius: f64) -> [Vector; 8] {
    std::array::from_fn(|k| {
        let side = |bit: usize| if k & bit == 0 { -radius } else { radius };
        centre + Vector::new(side(1), side(2), side(4))
    })
}

/// Bounds of the hull of points; everything where it reaches the eye's plane; none behind it.
#[inline(always)]
fn bounds_of(points: &[Vector]) -> Option<TangentBounds> {
    let nearest = points.iter().fold(f64::INFINITY, |z, p| z.min(p.z));
    let farthest = points.iter().fold(f64::NEG_INFINITY, |z, p| z.max(p.z));
    if farthest <= 0.0 || farthest.is_nan() {
        return None;
    }
    if nearest < BOUNDS_MIN_DEPTH {
        return Some(TangentBounds::EVERYWHERE);
    }
    let mut bounds = TangentBounds {
        x: [f64::INFINITY, f64::NEG_INFINITY],
        y: [f64::INFINITY, f64::NEG_INFINITY],
        w: [1.0 / farthest, 1.0 / nearest],
    };
    for p in points {
        let inverse = 1.0 / p.z;
        let (x, y) = (p.x * inverse, p.y * inverse);
        bounds.x = [bounds.x[0].min(x), bounds.x[1].max(x)];
        bounds.y = [bounds.y[0].min(y), bounds.y[1].max(y)];
    }
    Some(bounds)
}
