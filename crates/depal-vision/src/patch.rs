//! Stage 6: a flat surface resampled in its own axes, with sums that answer "how much of this
//! rectangle is surface" and "how much of this line is edge" in constant time.

use depal_frames::Intrinsics;

use crate::{
    blank::Blank, gate::DepthImage, plane::PlaneFrame, resample::ResampledRow, scratch::Kept,
    search::left_out,
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
    area: Kept<u32>,
    /// Deep cells of all cells below and left, in squares of [`COARSE`] cells.
    deep: Kept<u32>,
    /// Edge weight of vertical lines, summed over the rows below; wraps around.
    vertical: Kept<u16>,
    /// Edge weight of horizontal lines, summed over the columns to the left; wraps around.
    horizontal: Kept<u16>,
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

/// Cells on both sides of a line that count as edge on it.
const AROUND: usize = 2;

/// The sums over edge cells, row after row.
struct EdgeSums {
    columns: usize,
    /// The last five rows of edge cells, in turn, each with a margin at both ends.
    last: [Vec<u8>; 2 * AROUND + 1],
    weights: Vec<u8>,
    nothing: Vec<u16>,
    vertical: Kept<u16>,
    horizontal: Kept<u16>,
}

impl EdgeSums {
    #[inline(always)]
    fn new(columns: usize, rows: usize) -> Self {
        // All but the first row and column is written by and by.
        let mut vertical = Kept::of_any(columns * (rows + 1), 0);
        vertical[..columns].fill(0);
        Self {
            columns,
            last: std::array::from_fn(|_| vec![0; columns + 2 * AROUND]),
            weights: vec![0; columns],
            nothing: vec![0; columns],
            vertical,
            horizontal: Kept::of_any((columns + 1) * rows, 0),
        }
    }

    /// Where the edge cells of row `j` are put, after those of all rows before.
    #[inline(always)]
    fn row(&mut self, j: usize) -> &mut [u8] {
        let place = j % self.last.len();
        &mut self.last[place][AROUND..AROUND + self.columns]
    }

    /// Sums up row `j`, once the two rows behind it are put.
    #[inline(always)]
    fn sum(&mut self, j: usize) {
        let columns = self.columns;
        let here = &self.last[j % self.last.len()];
        let across: [&[u8]; 5] = std::array::from_fn(|k| &here[k..k + columns]);
        weigh(across, &mut self.weights);
        let (before, next) = row_and_next(&mut self.vertical, j, columns);
        for ((sum, &before), &w) in next.iter_mut().zip(before).zip(&self.weights) {
            *sum = before.wrapping_add(u16::from(w));
        }
        // From two rows before to two behind.
        let around: [&[u8]; 5] = std::array::from_fn(|k| {
            let row = &self.last[(j + k + 1 + AROUND) % self.last.len()];
            &row[AROUND..AROUND + columns]
        });
        weigh(around, &mut self.weights);
        let row = &mut self.horizontal[j * (columns + 1)..(j + 1) * (columns + 1)];
        row[0] = 0;
        // The rows are summed up each by itself: of the one before nothing is needed.
        sums_along(&self.weights, &self.nothing, &mut row[1..], |sum, _| {
            sum as u16
        });
    }
}

/// Puts to each place what `put` makes of the sum of the cells up to there and of what stands there in the row before.
/// Cells are at most 31, so that eight of them, summed up by one multiplication, stay below 256.
#[inline(always)]
fn sums_along<T: Copy>(cells: &[u8], before: &[T], totals: &mut [T], put: impl Fn(u32, T) -> T) {
    const ONES: u64 = 0x0101_0101_0101_0101;
    let (chunks, rest) = cells.as_chunks::<8>();
    let (places, last) = totals.split_at_mut(8 * chunks.len());
    let (earlier, last_earlier) = before.split_at(8 * chunks.len());
    let mut sum = 0u32;
    for ((chunk, places), earlier) in chunks
        .iter()
        .zip(places.as_chunks_mut::<8>().0)
        .zip(earlier.as_chunks::<8>().0)
    {
        // Byte k of the product is the sum of bytes 0 to k.
        let sums = u64::from_le_bytes(*chunk).wrapping_mul(ONES).to_le_bytes();
        *places = std::array::from_fn(|k| put(sum + u32::from(sums[k]), earlier[k]));
        sum += u32::from(sums[7]);
    }
    for ((place, &before), &cell) in last.iter_mut().zip(last_earlier).zip(rest) {
        sum += u32::from(cell);
        *place = put(sum, before);
    }
}

/// Row `j` of a list of rows, and the one after it to be written.
#[inline(always)]
fn row_and_next<T>(rows: &mut [T], j: usize, width: usize) -> (&[T], &mut [T]) {
    let (before, next) = rows[j * width..(j + 2) * width].split_at_mut(width);
    (before, next)
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
        let mut edges = EdgeSums::new(columns, rows);
        let mut row = ResampledRow::new(columns);
        // Sums so far, one row; every array is written once, row after row.
        let mut area = Kept::of_any((columns + 1) * (rows + 1), 0u32);
        area[..=columns].fill(0);
        let coarse = columns / COARSE;
        let mut deep_cells = vec![0u8; columns];
        let mut deep_row = vec![0u32; coarse + 1];
        let mut deep = Kept::with_capacity((coarse + 1) * (rows / COARSE + 1));
        deep.extend_from_slice(&deep_row);
        let (block_columns, block_rows) = (columns / BLOCK, rows / BLOCK);
        let mut heights = Vec::with_capacity(block_columns * block_rows);
        let mut height_cells = vec![0.0f32; columns];
        for j in 0..rows {
            let along = y[0] + (j as f64 + 0.5) * pitch;
            let first = frame.point(x[0] + 0.5 * pitch, along);
            row.fetch(image, first, frame.x * pitch);
            let edge = edges.row(j);
            row.classify(tolerance as f32, edge);
            for blank in blanks {
                row.blank(blank.cells(along, x[0], pitch, columns), edge);
            }
            if let Some(done) = j.checked_sub(AROUND) {
                edges.sum(done);
            }
            let (before, next) = row_and_next(&mut area, j, columns + 1);
            next[0] = 0;
            sums_along(&row.on, &before[1..], &mut next[1..], |sum, before| {
                before + sum
            });
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
        for j in rows..rows + AROUND {
            edges.row(j).fill(0);
            if let Some(done) = j.checked_sub(AROUND) {
                edges.sum(done);
            }
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
            vertical: edges.vertical,
            horizontal: edges.horizontal,
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
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || self.count_seen_sides(j, cells, share, seen),
        );
    }

    #[inline(always)]
    fn count_seen_sides(&self, j: usize, cells: [usize; 2], share: f64, seen: &mut Vec<u8>) {
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
