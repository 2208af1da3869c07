//! What the pixels of an image are with respect to a plane.

use crate::gate::DepthImage;

/// What a pixel is with respect to a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Class {
    /// On the plane.
    On,
    /// Behind it: the surface ends here.
    Deep,
    /// No measurement: unknown.
    Hole,
    /// In front of it: something hides the plane.
    Near,
    /// Beyond the image.
    Outside,
}

impl DepthImage<'_> {
    /// Class of the pixel nearest to (u, v) where the plane lies at depth `expected`.
    pub fn class(&self, u: f64, v: f64, expected: f64, tolerance: f64) -> Class {
        let (u, v) = (u + 0.5, v + 0.5);
        // Also refuses NaN; the casts below cut off, which is floor for what passes.
        let inside = u >= 0.0 && v >= 0.0 && u < self.width as f64 && v < self.height as f64;
        if !inside {
            return Class::Outside;
        }
        let z = f64::from(self.depth[v as usize * self.width + u as usize]);
        if z == 0.0 {
            Class::Hole
        } else if z > expected + tolerance {
            Class::Deep
        } else if z < expected - tolerance {
            Class::Near
        } else {
            Class::On
        }
    }
}
