use std::sync::Arc;

use crate::{Point, Pose, Vector};

/// A convex solid: corners and the triangles between them. Shared by whatever shows, simulates or avoids it.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexHull {
    vertices: Vec<Point>,
    triangles: Vec<[u32; 3]>,
}

impl ConvexHull {
    /// From corners, metres, and triangles that list them counter-clockwise as seen from outside.
    ///
    /// # Panics
    /// If a triangle names a corner that is not there.
    pub fn new(vertices: Vec<Point>, triangles: Vec<[u32; 3]>) -> Self {
        let known = triangles
            .iter()
            .flatten()
            .all(|&i| (i as usize) < vertices.len());
        assert!(known, "triangles of {} corners name others", vertices.len());
        Self {
            vertices,
            triangles,
        }
    }

    /// Corners, metres.
    pub fn vertices(&self) -> &[Point] {
        &self.vertices
    }

    /// Corners of each triangle by index, counter-clockwise as seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Largest extent from the origin along each axis, m.
    pub fn half_extents(&self) -> Vector {
        let far = |i: usize| self.vertices.iter().map(|p| p[i].abs()).fold(0.0, f64::max);
        Vector::new(far(0), far(1), far(2))
    }
}

/// A solid in its own frame, metres. Physics, camera and planner all build from these.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Box centred on the origin.
    Cuboid {
        /// Half of each side.
        half_extents: Vector,
    },
    /// Capsule along Z, centred on the origin.
    Capsule {
        /// Half of the cylindrical part's length.
        half_length: f64,
        /// Radius of cylinder and caps.
        radius: f64,
    },
    /// Cylinder along Z, centred on the origin.
    Cylinder {
        /// Half of the length.
        half_length: f64,
        /// Radius.
        radius: f64,
    },
    /// Sphere centred on the origin.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// Convex hull of corners, for instance of a mesh file.
    Hull(Arc<ConvexHull>),
}

impl Shape {
    /// A box from its full sides.
    pub fn cuboid(x: f64, y: f64, z: f64) -> Self {
        Self::Cuboid {
            half_extents: Vector::new(x, y, z) * 0.5,
        }
    }

    /// A convex hull.
    pub fn hull(hull: ConvexHull) -> Self {
        Self::Hull(Arc::new(hull))
    }

    /// Distance from the shape's origin to its farthest point.
    pub fn bounding_radius(&self) -> f64 {
        match self {
            Self::Cuboid { half_extents } => half_extents.norm(),
            Self::Capsule {
                half_length,
                radius,
            } => half_length + radius,
            Self::Cylinder {
                half_length,
                radius,
            } => half_length.hypot(*radius),
            Self::Sphere { radius } => *radius,
            Self::Hull(hull) => hull
                .vertices()
                .iter()
                .map(|p| p.coords.norm())
                .fold(0.0, f64::max),
        }
    }
}

/// A shape and where it sits in the frame of what carries it (a link, the world, a tool).
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedShape {
    /// `parent_from_shape`.
    pub pose: Pose,
    /// The solid.
    pub shape: Shape,
}

impl PlacedShape {
    /// A box of full sides `size` whose centre is at `pose`.
    pub fn cuboid(pose: Pose, size: Vector) -> Self {
        Self {
            pose,
            shape: Shape::Cuboid {
                half_extents: size * 0.5,
            },
        }
    }

    /// The same shape seen from the parent's parent: `grandparent_from_parent * pose`.
    pub fn moved(&self, grandparent_from_parent: &Pose) -> Self {
        Self {
            pose: grandparent_from_parent * self.pose,
            shape: self.shape.clone(),
        }
    }
}
