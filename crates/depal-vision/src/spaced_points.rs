//! Where evenly spaced points of a line lie in the image.

use depal_frames::{Intrinsics, Point, Vector};

/// Points at `first + i step` (camera frame): numerators of column and row, and the depth, each with what a step adds.
///
/// In f32, which places them to a thousandth of a pixel.
#[derive(Debug, Clone, Copy)]
pub struct SpacedPoints {
    column: [f32; 2],
    row: [f32; 2],
    depth: [f32; 2],
}

impl SpacedPoints {
    #[inline(always)]
    pub fn new(lens: &Intrinsics, first: Point, step: Vector) -> Self {
        // Half a pixel added, so that cutting off rounds to the nearest.
        let numerator = |x: f64, z: f64, f: f64, c: f64| (x * f + z * (c + 0.5)) as f32;
        Self {
            column: [
                numerator(first.x, first.z, lens.fx, lens.cx),
                numerator(step.x, step.z, lens.fx, lens.cx),
            ],
            row: [
                numerator(first.y, first.z, lens.fy, lens.cy),
                numerator(step.y, step.z, lens.fy, lens.cy),
            ],
            depth: [first.z as f32, step.z as f32],
        }
    }

    /// Column and row, to be cut off, and depth of a point.
    #[inline(always)]
    pub fn at(&self, i: usize) -> (f32, f32, f32) {
        let i = i as i32 as f32;
        let z = self.depth[0] + self.depth[1] * i;
        let inverse = 1.0 / z;
        let u = (self.column[0] + self.column[1] * i) * inverse;
        let v = (self.row[0] + self.row[1] * i) * inverse;
        (u, v, z)
    }
}
