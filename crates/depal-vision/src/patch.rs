//! Stage 6: a flat surface resampled in its own axes, with sums that answer "how much of this
//! rectangle is surface" and "how much of this line is edge" in constant time.

use depal_frames::{Intrinsics, Point, Vector};

use crate::{gate::DepthImage, plane::PlaneFrame};

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

impl DepthImage {
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

/// Cells of side `pitch` on a plane frame; cell (i, j) covers
/// `left + i pitch .. left + (i + 1) pitch` along X and likewise along Y.
pub struct Patch {
    pub frame: PlaneFrame,
    pub pitch: f64,
    pub left: f64,
    pub bottom: f64,
    pub columns: usize,
    pub rows: usize,
    /// Surface cells (low half) and deep cells (high half) of all cells below and left.
    area: Vec<u64>,
    /// Edge weight of vertical lines, summed over the rows below.
    vertical: Vec<u32>,
    /// Edge weight of horizontal lines, summed over the columns to the left.
    horizontal: Vec<u32>,
}

/// One row of cells: where they lie in the image, then what is there.
struct ResampledRow {
    column: Vec<f32>,
    line: Vec<f32>,
    expected: Vec<f32>,
    classes: Vec<Class>,
}

impl ResampledRow {
    fn new(columns: usize) -> Self {
        Self {
            column: vec![0.0; columns],
            line: vec![0.0; columns],
            expected: vec![0.0; columns],
            classes: vec![Class::Outside; columns],
        }
    }

    /// Cells at `first + i step` (camera frame). f32 places them to a thousandth of a pixel.
    fn fetch(&mut self, image: &DepthImage, first: Point, step: Vector, tolerance: f64) {
        let k = &image.intrinsics;
        // Numerators of u and v, half a pixel added, so that cutting off rounds to the nearest.
        let affine = |x: f64, z: f64, f: f64, c: f64| (x * f + z * (c + 0.5)) as f32;
        let (u0, u1) = (
            affine(first.x, first.z, k.fx, k.cx),
            affine(step.x, step.z, k.fx, k.cx),
        );
        let (v0, v1) = (
            affine(first.y, first.z, k.fy, k.cy),
            affine(step.y, step.z, k.fy, k.cy),
        );
        let (z0, z1) = (first.z as f32, step.z as f32);
        let cells = self
            .column
            .iter_mut()
            .zip(&mut self.line)
            .zip(&mut self.expected);
        for (i, ((u, v), expected)) in cells.enumerate() {
            let i = i as i32 as f32;
            let z = z0 + z1 * i;
            let inverse = 1.0 / z;
            *u = (u0 + u1 * i) * inverse;
            *v = (v0 + v1 * i) * inverse;
            *expected = z;
        }
        let tolerance = tolerance as f32;
        let (width, height) = (image.width as f32, image.height as f32);
        let cells = self.column.iter().zip(&self.line).zip(&self.expected);
        for (((&u, &v), &expected), class) in cells.zip(&mut self.classes) {
            // Also refuses NaN.
            let inside = u >= 0.0 && v >= 0.0 && u < width && v < height;
            *class = if inside {
                // Within the image, so i32 holds it; its cast is one instruction.
                let (u, v) = (u as i32 as usize, v as i32 as usize);
                let z = image.depth[v * image.width + u];
                if z == 0.0 {
                    Class::Hole
                } else if z > expected + tolerance {
                    Class::Deep
                } else if z < expected - tolerance {
                    Class::Near
                } else {
                    Class::On
                }
            } else {
                Class::Outside
            };
        }
    }
}

/// Weight of an edge cell that lies exactly on the line; one cell beside it counts 3, two count 1.
const FULL: u32 = 4;

/// Weight of five cells across a line, the middle one on it.
fn weight(cells: [u8; 5]) -> u32 {
    let full = cells[2] * FULL as u8;
    let near = (cells[1] | cells[3]) * 3;
    u32::from(full.max(near).max(cells[0] | cells[4]))
}

/// Side of the square on the plane that one pixel sees.
pub fn pixel_pitch(frame: &PlaneFrame, intrinsics: &Intrinsics) -> f64 {
    frame.origin.z / intrinsics.fx.max(intrinsics.fy)
}

impl Patch {
    /// Resamples the image over `x` and `y` ranges (metres) of the frame.
    pub fn new(
        image: &DepthImage,
        frame: PlaneFrame,
        x: [f64; 2],
        y: [f64; 2],
        pitch: f64,
        tolerance: f64,
    ) -> Self {
        let columns = ((x[1] - x[0]) / pitch).ceil().max(1.0) as usize;
        let rows = ((y[1] - y[0]) / pitch).ceil().max(1.0) as usize;
        let mut area = vec![0u64; (columns + 1) * (rows + 1)];
        // Two cells of margin all round.
        let stride = columns + 4;
        let mut edge = vec![0u8; stride * (rows + 4)];
        let mut row = ResampledRow::new(columns);
        for j in 0..rows {
            let first = frame.point(x[0] + 0.5 * pitch, y[0] + (j as f64 + 0.5) * pitch);
            row.fetch(image, first, frame.x * pitch, tolerance);
            let (below, above) = area.split_at_mut((j + 1) * (columns + 1));
            let below = &below[j * (columns + 1) + 1..];
            let above = &mut above[1..=columns];
            let edge = &mut edge[(j + 2) * stride + 2..(j + 2) * stride + 2 + columns];
            let mut sum = 0u64;
            for (((&class, edge), below), above) in
                row.classes.iter().zip(edge).zip(below).zip(above)
            {
                sum += u64::from(class == Class::On) | (u64::from(class == Class::Deep) << 32);
                *above = *below + sum;
                *edge = u8::from(matches!(class, Class::Deep | Class::Hole));
            }
        }
        let mut vertical = vec![0u32; columns * (rows + 1)];
        let mut horizontal = vec![0u32; (columns + 1) * rows];
        for j in 0..rows {
            // Five rows of the margin image around row j, and this row five cells wide.
            let around: [&[u8]; 5] = std::array::from_fn(|k| {
                &edge[(j + k) * stride + 2..(j + k) * stride + 2 + columns]
            });
            let here = &edge[(j + 2) * stride..(j + 3) * stride];
            let (below, above) = vertical.split_at_mut((j + 1) * columns);
            let below = &below[j * columns..];
            for (i, (sum, window)) in above.iter_mut().zip(here.windows(5)).enumerate() {
                *sum = below[i] + weight([window[0], window[1], window[2], window[3], window[4]]);
            }
            let mut sum = 0;
            let line = &mut horizontal[j * (columns + 1) + 1..(j + 1) * (columns + 1)];
            for (i, out) in line.iter_mut().enumerate() {
                sum += weight(around.map(|row| row[i]));
                *out = sum;
            }
        }
        Self {
            frame,
            pitch,
            left: x[0],
            bottom: y[0],
            columns,
            rows,
            area,
            vertical,
            horizontal,
        }
    }

    fn both(&self, i0: usize, j0: usize, i1: usize, j1: usize) -> u64 {
        let n = self.columns + 1;
        let sum = |i: usize, j: usize| self.area[j * n + i];
        sum(i1, j1)
            .wrapping_sub(sum(i0, j1))
            .wrapping_sub(sum(i1, j0))
            .wrapping_add(sum(i0, j0))
    }

    /// Shares (surface, deep) of the cells `i0..i1` x `j0..j1`, clipped to the patch.
    pub fn shares(&self, i0: isize, j0: isize, i1: isize, j1: isize) -> (f64, f64) {
        let cells = ((i1 - i0).max(0) * (j1 - j0).max(0)) as f64;
        let clip = |v: isize, high: usize| v.clamp(0, high as isize) as usize;
        let (i0, i1) = (clip(i0, self.columns), clip(i1, self.columns));
        let (j0, j1) = (clip(j0, self.rows), clip(j1, self.rows));
        if cells == 0.0 || i1 <= i0 || j1 <= j0 {
            return (0.0, 0.0);
        }
        let both = self.both(i0, j0, i1, j1);
        (
            (both & 0xffff_ffff) as f64 / cells,
            (both >> 32) as f64 / cells,
        )
    }

    /// Share 0..1 of edge along the vertical line of cells `i`, rows `j0..j1`.
    pub fn vertical_edge(&self, i: isize, j0: usize, j1: usize) -> f64 {
        if i < 0 || i >= self.columns as isize || j1 > self.rows || j1 <= j0 {
            return 0.0;
        }
        let sum = self.vertical[j1 * self.columns + i as usize]
            - self.vertical[j0 * self.columns + i as usize];
        f64::from(sum) / f64::from(FULL * (j1 - j0) as u32)
    }

    /// Share 0..1 of edge along the horizontal line of cells `j`, columns `i0..i1`.
    pub fn horizontal_edge(&self, j: isize, i0: usize, i1: usize) -> f64 {
        if j < 0 || j >= self.rows as isize || i1 > self.columns || i1 <= i0 {
            return 0.0;
        }
        let row = j as usize * (self.columns + 1);
        let sum = self.horizontal[row + i1] - self.horizontal[row + i0];
        f64::from(sum) / f64::from(FULL * (i1 - i0) as u32)
    }
}
