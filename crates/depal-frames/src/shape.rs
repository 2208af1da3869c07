use crate::{Pose, Vector};

/// A solid primitive in its own frame, metres. Physics, camera and planner all build from these.
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
}

impl Shape {
    /// A box from its full sides.
    pub fn cuboid(x: f64, y: f64, z: f64) -> Self {
        Self::Cuboid {
            half_extents: Vector::new(x, y, z) * 0.5,
        }
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
