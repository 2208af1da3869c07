//! Solids with the boxes around them.

use depal_frames::{PlacedShape, Pose, Shape, convert};
use parry3d::{math::Pose as Pose32, shape::SharedShape};

use super::scene::PADDINGS;
use crate::world::solid;

/// A solid with the box around it.
pub(crate) struct Solid {
    pub shape: SharedShape,
    /// Where the shape sits in its frame.
    pub frame_from_shape: Pose32,
    /// Where the box around it sits in its frame.
    pub frame_from_box: Pose,
    /// Half of the box's sides, m.
    pub half: [f64; 3],
    /// The box is the solid.
    pub is_box: bool,
    /// The shape thicker by each padding; empty for boxes.
    padded: Vec<SharedShape>,
}

impl Solid {
    /// Boxes have no thick shapes of their own; they are made when something round comes near.
    pub fn thick_box(&self, thickness: usize) -> Option<SharedShape> {
        let padding = *PADDINGS.get(thickness)?;
        let [x, y, z] = self.half.map(|h| (h + padding) as f32);
        self.is_box.then(|| SharedShape::cuboid(x, y, z))
    }

    pub fn new(placed: &PlacedShape) -> Self {
        let (frame_from_shape, shape) = solid(placed, 0.0);
        if let Shape::Cuboid { half_extents } = &placed.shape {
            return Self {
                shape,
                frame_from_shape,
                frame_from_box: placed.pose,
                half: [half_extents.x, half_extents.y, half_extents.z],
                is_box: true,
                padded: Vec::new(),
            };
        }
        let around = shape.compute_local_aabb();
        let (centre, half) = (around.center(), around.half_extents());
        let offset = Pose::translation(
            f64::from(centre.x),
            f64::from(centre.y),
            f64::from(centre.z),
        );
        Self {
            frame_from_box: convert::from_glam(&frame_from_shape) * offset,
            half: [half.x, half.y, half.z].map(f64::from),
            is_box: false,
            padded: PADDINGS.iter().map(|&p| solid(placed, p).1).collect(),
            shape,
            frame_from_shape,
        }
    }

    /// Of this thickness, in the collision library's form.
    pub fn thick(&self, thickness: usize) -> &SharedShape {
        self.padded.get(thickness).unwrap_or(&self.shape)
    }
}
