use serde::{Deserialize, Serialize};

/// Outer size of a carton, metres: `length >= width` lie in the top face, `height` is vertical.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BoxSize {
    /// Long side of the top face, along the box frame's X.
    pub length: f64,
    /// Short side of the top face, along the box frame's Y.
    pub width: f64,
    /// Vertical extent, along the box frame's Z.
    pub height: f64,
}

impl BoxSize {
    /// From millimetres; the two top-face sides may come in either order.
    pub fn from_mm(sides: [f64; 3]) -> Self {
        Self {
            length: sides[0].max(sides[1]) * 1e-3,
            width: sides[0].min(sides[1]) * 1e-3,
            height: sides[2] * 1e-3,
        }
    }

    /// Length, width and height in millimetres.
    pub fn to_mm(self) -> [f64; 3] {
        [self.length * 1e3, self.width * 1e3, self.height * 1e3]
    }

    /// Half extents (x, y, z), metres.
    pub fn half_extents(self) -> crate::Vector {
        crate::Vector::new(self.length, self.width, self.height) * 0.5
    }
}
