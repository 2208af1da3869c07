//! Stage 8a: how far inside the real edges of this image the edges lie that its pixels show.
//!
//! At a step some of the outermost pixels are lost or lie between both surfaces, so a side seems to lie inside the
//! real one. How much is lost depends on the camera, and on whether it sees anything beyond the side: some cameras
//! tear only steps between two measured surfaces, others also those into a shadow. Both insets follow from rows of
//! cartons, since their lengths are known.

use nalgebra::{Matrix2, Vector2};

use crate::sides::{INSET_PIXELS, SIDE_PIXELS};

/// How much the insets of cameras differ, pixels: from next to nothing to most of the outermost pixels.
const SPREAD: f64 = 0.3;

/// Insets in pixels, of sides beyond which something deeper is seen, and of those beyond which nothing is.
#[derive(Debug, Clone, Copy)]
pub struct Insets {
    pub lit: f64,
    pub dark: f64,
}

impl Insets {
    /// What is expected of a camera before its image was looked at.
    pub const USUAL: Self = Self {
        lit: INSET_PIXELS,
        dark: INSET_PIXELS,
    };

    /// True when the two differ by more than a side is known: less comes of how sides lie to the pixel rows.
    pub fn differ(&self) -> bool {
        (self.lit - self.dark).abs() > SIDE_PIXELS
    }

    /// Of a side that is lit on a share of its length, pixels.
    pub fn of(&self, lit: f64) -> f64 {
        self.lit * lit + self.dark * (1.0 - lit)
    }
}

/// Least squares over observed insets, drawn to what is usual.
pub struct InsetSums {
    matrix: Matrix2<f64>,
    right: Vector2<f64>,
}

impl InsetSums {
    pub fn new() -> Self {
        let weight = 1.0 / (SPREAD * SPREAD);
        Self {
            matrix: Matrix2::identity() * weight,
            right: Vector2::repeat(INSET_PIXELS * weight),
        }
    }

    /// Takes in that `lit` times the one and `dark` times the other inset are so many pixels together.
    pub fn add(&mut self, lit: f64, dark: f64, pixels: f64, weight: f64) {
        let row = Vector2::new(lit, dark);
        self.matrix += row * row.transpose() * weight;
        self.right += row * (pixels * weight);
    }

    pub fn solve(&self) -> Insets {
        match self.matrix.cholesky() {
            Some(factor) => {
                let found = factor.solve(&self.right);
                Insets {
                    lit: found.x,
                    dark: found.y,
                }
            }
            None => Insets::USUAL,
        }
    }
}

#[cfg(test)]
mod tests;
