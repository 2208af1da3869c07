//! Solids taken apart into surfaces whose image rows have a closed form, in a view's own frame.

use depal_frames::{Pose, Shape, Vector};

/// Nearer than this to the view's own plane no bounds are worked out, metres.
const BOUNDS_MIN_DEPTH: f64 = 1e-4;

/// A box in tangent space (x/z, y/z) that holds the image of a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TangentBounds {
    pub x: [f64; 2],
    pub y: [f64; 2],
}

/// One surface, outward side only, in the frame of the view (eye at the origin, Z forward).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surface {
    /// Index of the solid that it belongs to.
    pub shape: u32,
    pub bounds: TangentBounds,
    pub kind: SurfaceKind,
}

#[derive(Debug, Clone, Copy)]
pub(crate) enum SurfaceKind {
    /// Convex quadrilateral. A ray `r` meets it when every `edges[i] . r >= 0`;
    /// then 1/z = `inverse_depth . r`.
    Quad {
        normal: Vector,
        inverse_depth: Vector,
        edges: [Vector; 4],
    },
    /// Round plate.
    Disk {
        normal: Vector,
        inverse_depth: Vector,
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
}

impl SurfaceKind {
    /// Outward unit normal at a point of the surface, as a function of the point.
    pub fn normal_at(&self, point: &Vector) -> Vector {
        match self {
            Self::Quad { normal, .. } | Self::Disk { normal, .. } => *normal,
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
        }
    }

    /// The normal where it is the same all over the surface.
    pub fn constant_normal(&self) -> Option<Vector> {
        match self {
            Self::Quad { normal, .. } | Self::Disk { normal, .. } => Some(*normal),
            _ => None,
        }
    }
}

/// Appends the surfaces of a solid that turn towards the eye.
pub(crate) fn push_surfaces(
    out: &mut Vec<Surface>,
    index: u32,
    view_from_shape: &Pose,
    shape: &Shape,
) {
    let centre = view_from_shape.translation.vector;
    match shape {
        Shape::Cuboid { half_extents } => push_cuboid(out, index, view_from_shape, half_extents),
        Shape::Sphere { radius } => push_sphere(out, index, centre, *radius),
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
            push_sphere(out, index, centre + axis * *half_length, *radius);
            push_sphere(out, index, centre - axis * *half_length, *radius);
            push_mantle(out, index, centre, axis, *half_length, *radius);
        }
        Shape::Cylinder {
            half_length,
            radius,
        } => {
            let axis = view_from_shape.rotation * Vector::z();
            push_mantle(out, index, centre, axis, *half_length, *radius);
            for normal in [axis, -axis] {
                push_disk(out, index, centre + normal * *half_length, normal, *radius);
            }
        }
    }
}

fn push_cuboid(out: &mut Vec<Surface>, index: u32, view_from_shape: &Pose, half: &Vector) {
    let rotation = view_from_shape.rotation.to_rotation_matrix();
    let centre = view_from_shape.translation.vector;
    // Corner k has the signs of its bits: x = 1, y = 2, z = 4.
    let corners: [Vector; 8] = std::array::from_fn(|k| {
        let sign = |bit: usize| if k & bit == 0 { -1.0 } else { 1.0 };
        centre + rotation * Vector::new(sign(1) * half.x, sign(2) * half.y, sign(4) * half.z)
    });
    for axis in 0..3 {
        let (b, c) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        for positive in [false, true] {
            let base = if positive { 1 << axis } else { 0 };
            let column = rotation.matrix().column(axis).into_owned();
            let normal = if positive { column } else { -column };
            let plane = normal.dot(&corners[base]);
            if plane >= 0.0 {
                continue; // turned away from the eye, or seen edge on
            }
            // Round the face so that edge normals point inwards as seen from the eye.
            let round = if positive {
                [base, base | c, base | b | c, base | b]
            } else {
                [base, base | b, base | b | c, base | c]
            };
            let quad = round.map(|k| corners[k]);
            let edges = std::array::from_fn(|k| quad[k].cross(&quad[(k + 1) % 4]));
            let Some(bounds) = bounds_of(&quad) else {
                continue;
            };
            out.push(Surface {
                shape: index,
                bounds,
                kind: SurfaceKind::Quad {
                    normal,
                    inverse_depth: normal / plane,
                    edges,
                },
            });
        }
    }
}

fn push_sphere(out: &mut Vec<Surface>, index: u32, centre: Vector, radius: f64) {
    if centre.norm_squared() <= radius * radius {
        return; // the eye is inside
    }
    let Some(bounds) = bounds_of(&cube(&centre, radius)) else {
        return;
    };
    out.push(Surface {
        shape: index,
        bounds,
        kind: SurfaceKind::Sphere { centre, radius },
    });
}

fn push_mantle(
    out: &mut Vec<Surface>,
    index: u32,
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
    let Some(bounds) = bounds_of(&ends) else {
        return;
    };
    out.push(Surface {
        shape: index,
        bounds,
        kind: SurfaceKind::Mantle {
            centre,
            axis,
            half_length,
            radius,
        },
    });
}

fn push_disk(out: &mut Vec<Surface>, index: u32, centre: Vector, normal: Vector, radius: f64) {
    let plane = normal.dot(&centre);
    if plane >= 0.0 {
        return;
    }
    let Some(bounds) = bounds_of(&cube(&centre, radius)) else {
        return;
    };
    out.push(Surface {
        shape: index,
        bounds,
        kind: SurfaceKind::Disk {
            normal,
            inverse_depth: normal / plane,
            centre,
            radius,
        },
    });
}

fn cube(centre: &Vector, radius: f64) -> [Vector; 8] {
    std::array::from_fn(|k| {
        let side = |bit: usize| if k & bit == 0 { -radius } else { radius };
        centre + Vector::new(side(1), side(2), side(4))
    })
}

/// Bounds of the hull of points; everything where it reaches the eye's plane; none behind it.
fn bounds_of(points: &[Vector]) -> Option<TangentBounds> {
    let nearest = points.iter().fold(f64::INFINITY, |z, p| z.min(p.z));
    let farthest = points.iter().fold(f64::NEG_INFINITY, |z, p| z.max(p.z));
    if farthest <= 0.0 || farthest.is_nan() {
        return None;
    }
    let all = [f64::NEG_INFINITY, f64::INFINITY];
    if nearest < BOUNDS_MIN_DEPTH {
        return Some(TangentBounds { x: all, y: all });
    }
    let mut bounds = TangentBounds {
        x: [f64::INFINITY, f64::NEG_INFINITY],
        y: [f64::INFINITY, f64::NEG_INFINITY],
    };
    for p in points {
        let (x, y) = (p.x / p.z, p.y / p.z);
        bounds.x = [bounds.x[0].min(x), bounds.x[1].max(x)];
        bounds.y = [bounds.y[0].min(y), bounds.y[1].max(y)];
    }
    Some(bounds)
}
