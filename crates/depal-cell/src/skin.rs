//! What the outside of a carton is made of: board, tape and label, for the picture alone.
//!
//! Tape and label are solids as thin as they really are, with the carton's own id: whatever hides, shades or
//! lights the carton does the same to them, and their material alone decides what the camera makes of their
//! pixels. The physics, the gripper's cups and the planner know nothing of them.

use depal_camera::{Material, RenderShape};
use depal_frames::{Pose, Rotation, Shape, Vector};

/// Film and adhesive of packing tape, metres: 28 and about 20 micrometres.
const TAPE_THICKNESS: f64 = 0.000_05;
/// A paper label with its adhesive, metres.
const LABEL_THICKNESS: f64 = 0.000_1;
/// How far the tape of a closed carton goes down its short sides, metres: the 50 to 75 mm that packers are told.
const TAPE_REACH: f64 = 0.06;
/// Less is a sharp edge, as for the camera, metres.
const SHARP: f64 = 1e-5;

/// The outside of one carton.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CartonSkin {
    /// Of all that neither tape nor label covers.
    pub board: Material,
    /// Tape over the flaps; absent: none.
    pub tape: Option<Tape>,
    /// A label on the top, over the tape; absent: none.
    pub label: Option<Label>,
}

impl Default for CartonSkin {
    /// Brown board.
    fn default() -> Self {
        Self {
            board: Material::KRAFT,
            tape: None,
            label: None,
        }
    }
}

/// A stripe along the middle of the top, along its long side, that goes 60 mm down both short sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tape {
    /// Its surface.
    pub material: Material,
    /// Its width, metres.
    pub width: f64,
}

/// A white paper rectangle on the top.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Label {
    /// Its sides, metres: the first along the carton's long side but for the turn.
    pub size: [f64; 2],
    /// Its middle from the middle of the top, along the long and the short side, metres.
    pub at: [f64; 2],
    /// Turn, counter-clockwise seen from above, radians.
    pub turn: f64,
}

impl CartonSkin {
    /// The carton in its board, then tape and label. A solid that is no box has neither of them.
    pub(crate) fn dress(&self, mut carton: RenderShape) -> Vec<RenderShape> {
        carton.material = self.board;
        let mut shapes = vec![carton];
        let carton = &shapes[0];
        let Shape::Cuboid { half_extents } = carton.shape else {
            return shapes;
        };
        let tape = self.tape.map(|tape| tape.on(carton, &half_extents));
        let label = self.label.map(|label| label.on(carton, &half_extents));
        shapes.extend(tape);
        shapes.extend(label);
        shapes
    }
}

impl Tape {
    /// A box around the middle of the carton's upper part, larger than it by the tape's thickness. Round edges of
    /// the carton are wrapped closely: those of the box have the same axes.
    fn on(&self, carton: &RenderShape, half: &Vector) -> RenderShape {
        let own_radius = carton.edge_radius.min(half.min());
        let edge_radius = if own_radius > SHARP {
            own_radius + TAPE_THICKNESS
        } else {
            0.0
        };
        // The box's own long edges are round too, and sink into the board: so far beside their flat part it has
        // fallen by the tape's thickness.
        let shown = (TAPE_THICKNESS * (2.0 * edge_radius - TAPE_THICKNESS))
            .max(0.0)
            .sqrt();
        let sunk = edge_radius - shown;
        let height = (TAPE_THICKNESS + TAPE_REACH + sunk).min(2.0 * (half.z + TAPE_THICKNESS));
        let size = Vector::new(
            2.0 * (half.x + TAPE_THICKNESS),
            self.width + 2.0 * sunk,
            height,
        );
        let middle = half.z + TAPE_THICKNESS - 0.5 * height;
        RenderShape {
            world_from_shape: carton.world_from_shape * Pose::translation(0.0, 0.0, middle),
            shape: Shape::cuboid(size.x, size.y, size.z),
            material: self.material,
            edge_radius,
            ..carton.clone()
        }
    }
}

impl Label {
    fn on(&self, carton: &RenderShape, half: &Vector) -> RenderShape {
        let [x, y] = self.at;
        let mut carton_from_label = Pose::translation(x, y, half.z + 0.5 * LABEL_THICKNESS);
        carton_from_label.rotation = Rotation::new(Vector::z() * self.turn);
        RenderShape {
            world_from_shape: carton.world_from_shape * carton_from_label,
            shape: Shape::cuboid(self.size[0], self.size[1], LABEL_THICKNESS),
            material: Material::LABEL,
            edge_radius: 0.0,
            ..carton.clone()
        }
    }
}

#[cfg(test)]
mod tests;
