//! Stage 6: a flat surface resampled in its own axes, with sums that answer "how much of this
//! rectangle is surface" and "how much of this line is edge" in constant time.

use depal_frames::Intrinsics;

use crate::{
    blank::Blank, gate::DepthImage, plane::PlaneFrame, resample::ResampledRow, search::left_out,
};

/// Side of a block whose heights are averaged, cells.
pub const BLOCK: usize = 8;

/// Cells along a carton's sides that say nothing of its inside, with a camera that does not smear steps.
pub const SHARP_RIM: usize = 3;

/// Side of the squares in which deep cells are counted, cells.
const COARSE: usize = 4;

/// Cells of side `pitch` on a plane frame; cell (i, j) covers
/// `left + i pitch .. left + (i + 1) pitch` along X and likewise along Y.
pub struct Patch {
    pub frame: PlaneFrame,
    pub pitch: f64,
    pub left: f64,
    pub bottom: f64,
    pub columns: usize,
    pub rows: usize,
    /// Cells along a carton's sides that say nothing of its inside.
    pub rim: usize,
    /// Blocks over which noise hangs together; 1 where each has its own.
    pub lump: f64,
    /// Depths were averaged: their noise is more than the heights by which cartons differ.
    pub averaged: bool,
    /// Surface cells of all cells below and left.
    area: Vec<u32>,
    /// Deep cells of all cells below and left, in squares of [`COARSE`] cells.
    deep: Vec<u32>,
    /// Edge weight of vertical lines, summed over the rows below; wraps around.
    vertical: Vec<u16>,
    /// Edge weight of horizontal lines, summed over the columns to the left; wraps around.
    horizontal: Vec<u16>,
    /// What was left out.
    pub blanks: Vec<Blank>,
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
    /// Cells along a carton's sides that say nothing of its inside.
    pub rim: usize,
    /// Over how many pixels the picture was smeared or averaged, and with it its noise.
    pub soft_px: usize,
    /// It was averaged.
    pub averaged: bool,
}

/// Weight of an edge cell that lies exactly on the line; one cell beside it counts 3, two count 1.
const FULL: u16 = 4;

/// Weight of five cells across a line, the middle one on it.
#[inline(always)]
fn weight(cells: [u8; 5]) -> u8 {
    let full = cells[2] * FULL as u8;
    let near = (cells[1] | cells[3]) * 3;
    full.max(near).max(cells[0] | cells[4])
}

/// Weights of a line of cells; five rows of edge cells lie across it.
#[inline(always)]
fn weigh(edge: [&[u8]; 5], weights: &mut [u8]) {
    let count = weights.len();
    let edge = edge.map(|row| &row[..count]);
    for (i, w) in weights.iter_mut().enumerate() {
        *w = weight([edge[0][i], edge[1][i], edge[2][i], edge[3][i], edge[4][i]]);
    }
}

/// Side of the square on the plane that one pixel sees.
pub fn pixel_pitch(frame: &PlaneFrame, intrinsics: &Intrinsics) -> f64 {
    frame.origin.z / intrinsics.fx.max(intrinsics.fy)
}

/// The loops over cells for the widest vectors that the machine has; the same bits with any.
struct PatchJob<'a> {
    image: &'a DepthImage<'a>,
    grid: &'a Grid,
    blanks: &'a [Blank],
    tolerance: f64,
}

impl pulp::WithSimd for PatchJob<'_> {
    type Output = Patch;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Patch {
        Patch::resample(self.image, self.grid, self.blanks, self.tolerance)
    }
}

impl Patch {
    /// Resamples the image over a grid; what lies in one of the blanks is left out.
    pub fn new(image: &DepthImage, grid: &Grid, blanks: &[Blank], tolerance: f64) -> Self {
        pulp::Arch::new().dispatch(PatchJob {
            image,
            grid,
            blanks,
            tolerance,
        })
    }

    #[inline(always)]
    fn resample(image: &DepthImage, grid: &Grid, blanks: &[Blank], tolerance: f64) -> Self {
        let Grid {
            frame,
            x,
            y,
            pitch,
            rim,
            soft_px,
            averaged,
        } = *grid;
        let columns = ((x[1] - x[0]) / pitch).ceil().max(1.0) as usize;
        let rows = ((y[1] - y[0]) / pitch).ceil().max(1.0) as usize;
        // Two cells of margin all round.
        let stride = columns + 4;
        let mut edge = vec![0u8; stride * (rows + 4)];
        let mut row = ResampledRow::new(columns);
        // Sums so far, one row; every array is written once, row after row.
        let mut area_row = vec![0u32; columns + 1];
        let mut area = Vec::with_capacity((columns + 1) * (rows + 1));
        area.extend_from_slice(&area_row);
        let coarse = columns / COARSE;
        let mut deep_cells = vec![0u8; columns];
        let mut deep_row = vec![0u32; coarse + 1];
        let mut deep = Vec::with_capacity((coarse + 1) * (rows / COARSE + 1));
        deep.extend_from_slice(&deep_row);
        let (block_columns, block_rows) = (columns / BLOCK, rows / BLOCK);
        let mut heights = Vec::with_capacity(block_columns * block_rows);
        let mut height_cells = vec![0.0f32; columns];
        for j in 0..rows {
            let along = y[0] + (j as f64 + 0.5) * pitch;
            let first = frame.point(x[0] + 0.5 * pitch, along);
            row.fetch(image, &frame.plane, first, frame.x * pitch);
            let edge = &mut edge[(j + 2) * stride + 2..(j + 2) * stride + 2 + columns];
            row.classify(tolerance as f32, frame.origin.z as f32, edge);
            for blank in blanks {
                row.blank(blank.cells(along, x[0], pitch, columns), edge);
            }
            let mut sum = 0u32;
            for (&on, total) in row.on.iter().zip(&mut area_row[1..]) {
                sum += u32::from(on);
                *total += sum;
            }
            area.extend_from_slice(&area_row);
            for (count, &deep) in deep_cells.iter_mut().zip(&row.deep) {
                *count += deep;
            }
            if j % COARSE == COARSE - 1 {
                let mut sum = 0u32;
                let squares = deep_cells.as_chunks::<COARSE>().0;
                for (cells, total) in squares.iter().zip(&mut deep_row[1..]) {
                    sum += cells.iter().map(|&d| u32::from(d)).sum::<u32>();
                    *total += sum;
                }
                deep_cells.fill(0);
                deep.extend_from_slice(&deep_row);
            }
            for (sum, &height) in height_cells.iter_mut().zip(&row.height) {
                *sum += height;
            }
            if j % BLOCK == BLOCK - 1 {
                let blocks = height_cells.as_chunks::<BLOCK>().0;
                heights.extend(blocks.iter().map(|cells| cells.iter().sum::<f32>()));
                height_cells.fill(0.0);
            }
        }
        let mut vertical_row = vec![0u16; columns];
        let mut vertical = Vec::with_capacity(columns * (rows + 1));
        vertical.extend_from_slice(&vertical_row);
        let mut horizontal_row = vec![0u16; columns + 1];
        let mut horizontal = Vec::with_capacity((columns + 1) * rows);
        let mut weights = vec![0u8; columns];
        for j in 0..rows {
            let here = &edge[(j + 2) * stride..(j + 3) * stride];
            let across: [&[u8]; 5] = std::array::from_fn(|k| &here[k..k + columns]);
            weigh(across, &mut weights);
            for (sum, &w) in vertical_row.iter_mut().zip(&weights) {
                *sum = sum.wrapping_add(u16::from(w));
            }
            vertical.extend_from_slice(&vertical_row);
            // Five rows of the margin image around row j.
            let around: [&[u8]; 5] = std::array::from_fn(|k| {
                &edge[(j + k) * stride + 2..(j + k) * stride + 2 + columns]
            });
            weigh(around, &mut weights);
            let mut sum = 0u16;
            for (out, &w) in horizontal_row[1..].iter_mut().zip(&weights) {
                sum = sum.wrapping_add(u16::from(w));
                *out = sum;
            }
            horizontal.extend_from_slice(&horizontal_row);
        }
        Self {
            frame,
            pitch,
            left: x[0],
            bottom: y[0],
            columns,
            rows,
            rim,
            lump: (soft_px as f64 / BLOCK as f64).powi(2).max(1.0),
            averaged,
            area,
            deep,
            vertical,
            horizontal,
            blanks: blanks.to_vec(),
            heights,
        }
    }

    /// True when the camera smears steps, and with them its noise, or its depths were averaged.
    pub fn is_smeared(&self) -> bool {
        self.rim > SHARP_RIM || self.averaged
    }

    /// Number of surface cells of a block (column, row of blocks).
    pub fn surface_cells_of_block(&self, i: usize, j: usize) -> u32 {
        self.surface_cells(i * BLOCK, j * BLOCK, (i + 1) * BLOCK, (j + 1) * BLOCK)
    }

    fn surface_cells(&self, i0: usize, j0: usize, i1: usize, j1: usize) -> u32 {
        let n = self.columns + 1;
        let sum = |i: usize, j: usize| self.area[j * n + i];
        sum(i1, j1)
            .wrapping_sub(sum(i0, j1))
            .wrapping_sub(sum(i1, j0))
            .wrapping_add(sum(i0, j0))
    }

    /// What of the cells `i0..i1` x `j0..j1` lies on the patch (i0, j0, i1, j1), and how many they are with what lies
    /// beyond; `None` where nothing is left.
    pub fn clipped(&self, i0: isize, j0: isize, i1: isize, j1: isize) -> Option<([usize; 4], f64)> {
        let cells = ((i1 - i0).max(0) * (j1 - j0).max(0)) as f64;
        let clip = |v: isize, high: usize| v.clamp(0, high as isize) as usize;
        let (i0, i1) = (clip(i0, self.columns), clip(i1, self.columns));
        let (j0, j1) = (clip(j0, self.rows), clip(j1, self.rows));
        (i1 > i0 && j1 > j0).then_some(([i0, j0, i1, j1], cells))
    }

    /// Share of surface of the cells `i0..i1` x `j0..j1`, clipped to the patch.
    pub fn surface(&self, i0: isize, j0: isize, i1: isize, j1: isize) -> f64 {
        let Some(([i0, j0, i1, j1], cells)) = self.clipped(i0, j0, i1, j1) else {
            return 0.0;
        };
        f64::from(self.surface_cells(i0, j0, i1, j1)) / cells
    }

    /// Share of deep cells in the whole squares of four within `i0..i1` x `j0..j1`.
    pub fn deep(&self, i0: usize, j0: usize, i1: usize, j1: usize) -> f64 {
        let coarse = self.columns / COARSE;
        let (i0, j0) = (i0.div_ceil(COARSE), j0.div_ceil(COARSE));
        let (i1, j1) = (
            (i1 / COARSE).min(coarse),
            (j1 / COARSE).min(self.rows / COARSE),
        );
        if i1 <= i0 || j1 <= j0 {
            return 0.0;
        }
        let sum = |i: usize, j: usize| self.deep[j * (coarse + 1) + i];
        let cells = sum(i1, j1)
            .wrapping_sub(sum(i0, j1))
            .wrapping_sub(sum(i1, j0))
            .wrapping_add(sum(i0, j0));
        f64::from(cells) / ((i1 - i0) * (j1 - j0) * COARSE * COARSE) as f64
    }

    /// For rectangles of `cells` whose first row is `j` and whose first column is the place in the list:
    /// how many of their four sides show at least `share` of edge.
    pub fn seen_sides(&self, j: usize, cells: [usize; 2], share: f64, seen: &mut Vec<u8>) {
        let [a, b] = cells;
        seen.clear();
        if a > self.columns || j + b > self.rows {
            return;
        }
        let places = self.columns - a + 1;
        seen.resize(places, 0);
        let least = |length: usize| (share * f64::from(FULL) * length as f64).ceil() as u16;
        // Upright sides: all columns between two rows; the outer ones lie beyond the patch at its ends.
        let (low, high) = (j + left_out(b), j + b - left_out(b));
        let enough = least(high - low);
        let row = |j: usize| &self.vertical[j * self.columns..(j + 1) * self.columns];
        let (below, above) = (row(low), row(high));
        let shows = |i: usize| u8::from(above[i].wrapping_sub(below[i]) >= enough);
        for (i, seen) in seen[1..].iter_mut().enumerate() {
            *seen = shows(i);
        }
        for (i, seen) in seen[..places - 1].iter_mut().enumerate() {
            *seen += shows(i + a);
        }
        let enough = least(a - 2 * left_out(a));
        for line in [j.checked_sub(1), (j + b < self.rows).then_some(j + b)] {
            let Some(line) = line else { continue };
            let line = &self.horizontal[line * (self.columns + 1)..(line + 1) * (self.columns + 1)];
            let starts = &line[left_out(a)..][..places];
            let ends = &line[a - left_out(a)..][..places];
            for (seen, (start, end)) in seen.iter_mut().zip(starts.iter().zip(ends)) {
                *seen += u8::from(end.wrapping_sub(*start) >= enough);
            }
        }
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
