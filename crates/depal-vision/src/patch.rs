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

/// Side of a block whose heights are averaged, cells.
pub const BLOCK: usize = 8;

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
    /// Edge weight of vertical lines, summed over the rows below; wraps around.
    vertical: Vec<u16>,
    /// Edge weight of horizontal lines, summed over the columns to the left; wraps around.
    horizontal: Vec<u16>,
    /// For each whole block, row by row: sum of the heights over the plane (metres) of its surface cells.
    pub heights: Vec<f32>,
}

/// Where and how finely a plane is resampled.
pub struct Grid {
    pub frame: PlaneFrame,
    /// Ranges along the frame's axes, metres.
    pub x: [f64; 2],
    pub y: [f64; 2],
    pub pitch: f64,
}

/// One row of cells: where they lie in the image, then what is there.
struct ResampledRow {
    column: Vec<f32>,
    line: Vec<f32>,
    expected: Vec<f32>,
    /// Measured minus expected depth; [`NOTHING`] and [`BEYOND`] where there is none.
    deeper: Vec<f32>,
    /// 1 where it is so, else 0.
    on: Vec<u8>,
    deep: Vec<u8>,
    /// Height over the plane of surface cells, else 0.
    height: Vec<f32>,
}

/// Stands for the depth of a hole; larger than any depth.
const NOTHING: f32 = 1e6;
/// Stands for the depth beyond the image; nearer than any plane.
const BEYOND: f32 = -1e6;

impl ResampledRow {
    fn new(columns: usize) -> Self {
        Self {
            column: vec![0.0; columns],
            line: vec![0.0; columns],
            expected: vec![0.0; columns],
            deeper: vec![0.0; columns],
            on: vec![0; columns],
            deep: vec![0; columns],
            height: vec![0.0; columns],
        }
    }

    /// Cells at `first + i step` (camera frame). f32 places them to a thousandth of a pixel.
    fn fetch(&mut self, image: &DepthImage, first: Point, step: Vector) {
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
        let (width, height) = (image.width as f32, image.height as f32);
        let cells = self.column.iter().zip(&self.line).zip(&self.expected);
        for (((&u, &v), &expected), deeper) in cells.zip(&mut self.deeper) {
            // Also refuses NaN.
            let inside = u >= 0.0 && v >= 0.0 && u < width && v < height;
            *deeper = if inside {
                // Within the image, so i32 holds it; its cast is one instruction.
                let (u, v) = (u as i32 as usize, v as i32 as usize);
                let z = image.depth[v * image.width + u];
                if z == 0.0 { NOTHING } else { z - expected }
            } else {
                BEYOND
            };
        }
    }

    /// Tells surface, edge and the rest apart. `edge` is set to 1 where the surface ends or is not measured.
    fn classify(&mut self, tolerance: f32, edge: &mut [u8]) {
        let out = self
            .on
            .iter_mut()
            .zip(&mut self.deep)
            .zip(edge)
            .zip(&mut self.height);
        for (&deeper, (((on, deep), edge), height)) in self.deeper.iter().zip(out) {
            let surface = deeper.abs() <= tolerance;
            *on = u8::from(surface);
            *edge = u8::from(deeper > tolerance);
            *deep = u8::from((deeper > tolerance) & (deeper < NOTHING));
            *height = if surface { -deeper } else { 0.0 };
        }
    }

    /// Takes cells out of the picture: neither surface nor edge.
    fn blank(&mut self, cells: std::ops::Range<usize>, edge: &mut [u8]) {
        self.on[cells.clone()].fill(0);
        self.deep[cells.clone()].fill(0);
        self.height[cells.clone()].fill(0.0);
        edge[cells].fill(0);
    }
}

/// A rectangle in the axes of a grid that is no part of the surface.
pub struct Blank {
    /// Middle and half sides, metres.
    pub middle: [f64; 2],
    pub half: [f64; 2],
    /// Turn of the first side against the grid's X, radians.
    pub turn: f64,
}

impl Blank {
    /// The columns of a row (`y` metres) that lie inside.
    fn cells(&self, y: f64, left: f64, pitch: f64, columns: usize) -> std::ops::Range<usize> {
        let (s, c) = self.turn.sin_cos();
        let dy = y - self.middle[1];
        let (mut low, mut high) = (f64::MIN, f64::MAX);
        // |dx c + dy s| < half[0] and |dy c - dx s| < half[1], as bounds of dx.
        for (slope, shift, half) in [(c, dy * s, self.half[0]), (-s, dy * c, self.half[1])] {
            if slope.abs() < 1e-9 {
                if shift.abs() > half {
                    return 0..0;
                }
                continue;
            }
            let (a, b) = ((-half - shift) / slope, (half - shift) / slope);
            low = low.max(a.min(b));
            high = high.min(a.max(b));
        }
        let column = |x: f64| {
            ((x + self.middle[0] - left) / pitch)
                .round()
                .clamp(0.0, columns as f64) as usize
        };
        if high <= low {
            0..0
        } else {
            column(low)..column(high)
        }
    }
}

/// Weight of an edge cell that lies exactly on the line; one cell beside it counts 3, two count 1.
const FULL: u16 = 4;

/// Weight of five cells across a line, the middle one on it.
fn weight(cells: [u8; 5]) -> u8 {
    let full = cells[2] * FULL as u8;
    let near = (cells[1] | cells[3]) * 3;
    full.max(near).max(cells[0] | cells[4])
}

/// Side of the square on the plane that one pixel sees.
pub fn pixel_pitch(frame: &PlaneFrame, intrinsics: &Intrinsics) -> f64 {
    frame.origin.z / intrinsics.fx.max(intrinsics.fy)
}

impl Patch {
    /// Resamples the image over a grid; what lies in one of the blanks is left out.
    pub fn new(image: &DepthImage, grid: &Grid, blanks: &[Blank], tolerance: f64) -> Self {
        let Grid { frame, x, y, pitch } = *grid;
        let columns = ((x[1] - x[0]) / pitch).ceil().max(1.0) as usize;
        let rows = ((y[1] - y[0]) / pitch).ceil().max(1.0) as usize;
        let mut area = vec![0u64; (columns + 1) * (rows + 1)];
        // Two cells of margin all round.
        let stride = columns + 4;
        let mut edge = vec![0u8; stride * (rows + 4)];
        let mut row = ResampledRow::new(columns);
        let (block_columns, block_rows) = (columns / BLOCK, rows / BLOCK);
        let mut heights = vec![0.0f32; block_columns * block_rows];
        for j in 0..rows {
            let along = y[0] + (j as f64 + 0.5) * pitch;
            let first = frame.point(x[0] + 0.5 * pitch, along);
            row.fetch(image, first, frame.x * pitch);
            let edge = &mut edge[(j + 2) * stride + 2..(j + 2) * stride + 2 + columns];
            row.classify(tolerance as f32, edge);
            for blank in blanks {
                row.blank(blank.cells(along, x[0], pitch, columns), edge);
            }
            let (below, above) = area.split_at_mut((j + 1) * (columns + 1));
            let below = &below[j * (columns + 1) + 1..];
            let above = &mut above[1..=columns];
            let mut sum = 0u64;
            for (((&on, &deep), below), above) in row.on.iter().zip(&row.deep).zip(below).zip(above)
            {
                sum += u64::from(on) | (u64::from(deep) << 32);
                *above = *below + sum;
            }
            if j / BLOCK < block_rows {
                let heights = &mut heights[j / BLOCK * block_columns..][..block_columns];
                for (height, cells) in heights.iter_mut().zip(row.height.as_chunks::<BLOCK>().0) {
                    *height += cells.iter().sum::<f32>();
                }
            }
        }
        let mut vertical = vec![0u16; columns * (rows + 1)];
        let mut horizontal = vec![0u16; (columns + 1) * rows];
        let mut weights = vec![0u8; columns];
        for j in 0..rows {
            let here = &edge[(j + 2) * stride..(j + 3) * stride];
            let across: [&[u8]; 5] = std::array::from_fn(|k| &here[k..k + columns]);
            let (below, above) = vertical.split_at_mut((j + 1) * columns);
            let below = &below[j * columns..];
            for (i, (sum, below)) in above.iter_mut().zip(below).enumerate() {
                let w = weight([
                    across[0][i],
                    across[1][i],
                    across[2][i],
                    across[3][i],
                    across[4][i],
                ]);
                *sum = below.wrapping_add(u16::from(w));
            }
            // Five rows of the margin image around row j.
            let around: [&[u8]; 5] = std::array::from_fn(|k| {
                &edge[(j + k) * stride + 2..(j + k) * stride + 2 + columns]
            });
            for (i, w) in weights.iter_mut().enumerate() {
                *w = weight([
                    around[0][i],
                    around[1][i],
                    around[2][i],
                    around[3][i],
                    around[4][i],
                ]);
            }
            let mut sum = 0u16;
            let line = &mut horizontal[j * (columns + 1) + 1..(j + 1) * (columns + 1)];
            for (out, &w) in line.iter_mut().zip(&weights) {
                sum = sum.wrapping_add(u16::from(w));
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
            heights,
        }
    }

    /// Number of surface cells of a block (column, row of blocks).
    pub fn surface_cells_of_block(&self, i: usize, j: usize) -> u32 {
        let both = self.both(i * BLOCK, j * BLOCK, (i + 1) * BLOCK, (j + 1) * BLOCK);
        (both & 0xffff_ffff) as u32
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
        // Differences are right as long as a line has fewer than 16,384 cells.
        let sum = self.vertical[j1 * self.columns + i as usize]
            .wrapping_sub(self.vertical[j0 * self.columns + i as usize]);
        f64::from(sum) / (f64::from(FULL) * (j1 - j0) as f64)
    }

    /// Share 0..1 of edge along the horizontal line of cells `j`, columns `i0..i1`.
    pub fn horizontal_edge(&self, j: isize, i0: usize, i1: usize) -> f64 {
        if j < 0 || j >= self.rows as isize || i1 > self.columns || i1 <= i0 {
            return 0.0;
        }
        let row = j as usize * (self.columns + 1);
        let sum = self.horizontal[row + i1].wrapping_sub(self.horizontal[row + i0]);
        f64::from(sum) / (f64::from(FULL) * (i1 - i0) as f64)
    }
}
