//! Stage 6: a flat surface resampled in its own axes, with sums that answer "how much of this
//! rectangle is surface" and "how much of this line is edge" in constant time.

use depal_frames::Intrinsics;

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
        let (u, v) = ((u + 0.5).floor(), (v + 0.5).floor());
        if u < 0.0 || v < 0.0 || u >= self.width as f64 || v >= self.height as f64 {
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

/// Weight of an edge cell that lies exactly on the line; one cell beside it counts 3, two count 1.
const FULL: u32 = 4;

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
        let mut edge = vec![0u8; columns * rows];
        let k = &image.intrinsics;
        for j in 0..rows {
            let mut sum = 0u64;
            for i in 0..columns {
                let p = frame.point(
                    x[0] + (i as f64 + 0.5) * pitch,
                    y[0] + (j as f64 + 0.5) * pitch,
                );
                let inverse = 1.0 / p.z;
                let class = image.class(
                    p.x * inverse * k.fx + k.cx,
                    p.y * inverse * k.fy + k.cy,
                    p.z,
                    tolerance,
                );
                sum += u64::from(class == Class::On) | (u64::from(class == Class::Deep) << 32);
                area[(j + 1) * (columns + 1) + i + 1] = area[j * (columns + 1) + i + 1] + sum;
                edge[j * columns + i] = u8::from(matches!(class, Class::Deep | Class::Hole));
            }
        }
        let at = |i: isize, j: isize| -> u32 {
            if i < 0 || j < 0 || i >= columns as isize || j >= rows as isize {
                0
            } else {
                u32::from(edge[j as usize * columns + i as usize])
            }
        };
        let weight = |far1: u32, near1: u32, on: u32, near2: u32, far2: u32| {
            (on * FULL).max((near1 | near2) * 3).max(far1 | far2)
        };
        let mut vertical = vec![0u32; columns * (rows + 1)];
        let mut horizontal = vec![0u32; (columns + 1) * rows];
        for j in 0..rows {
            for i in 0..columns {
                let (ii, jj) = (i as isize, j as isize);
                let here = at(ii, jj);
                vertical[(j + 1) * columns + i] = vertical[j * columns + i]
                    + weight(
                        at(ii - 2, jj),
                        at(ii - 1, jj),
                        here,
                        at(ii + 1, jj),
                        at(ii + 2, jj),
                    );
                horizontal[j * (columns + 1) + i + 1] = horizontal[j * (columns + 1) + i]
                    + weight(
                        at(ii, jj - 2),
                        at(ii, jj - 1),
                        here,
                        at(ii, jj + 1),
                        at(ii, jj + 2),
                    );
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
