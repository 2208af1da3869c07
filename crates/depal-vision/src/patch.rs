//! Stage 6: a flat surface resampled in its own axes, with sums that answer "how much of this
//! rectangle is surface" and "how much of this line is edge" in constant time.

use std::cell::OnceCell;

use depal_frames::Intrinsics;

use crate::{
    blank::Blank,
    edge_sums::{AROUND, EdgeSums, FULL, row_and_next, sums_along},
    gate::DepthImage,
    plane::PlaneFrame,
    relief::Relief,
    resample::ResampledRow,
    scratch::Kept,
    search::left_out,
    widest::with_widest_vectors,
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
    relief: OnceCell<Relief>,
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
            row.fetch(image, &frame, first, frame.x * pitch);
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
            relief: OnceCell::new(),
        }
    }

    /// The heights of its blocks, made when first asked for.
    pub fn relief(&self) -> &Relief {
        self.relief.get_or_init(|| Relief::new(self))
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
        with_widest_vectors(
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
        let shows =
            |sums: [u16; 2], enough: u16| u16::from(sums[1].wrapping_sub(sums[0]) >= enough.max(1));
        // Upright sides: all columns between two rows.
        let rows = [j + left_out(b), j + b - left_out(b)];
        let upright = least(rows[1] - rows[0]);
        let sums = rows.map(|j| &self.vertical[j * self.columns..(j + 1) * self.columns]);
        // Those along a row; beyond the patch there is none.
        let along = least(a - 2 * left_out(a));
        let lines = [j.checked_sub(1), (j + b < self.rows).then_some(j + b)].map(|line| {
            let (row, cut) = line.map_or((0, [0, 0]), |row| (row, [left_out(a), a - left_out(a)]));
            let row = &self.horizontal[row * (self.columns + 1)..(row + 1) * (self.columns + 1)];
            cut.map(|cut| &row[cut..][..places])
        });
        let of_lines = |i: usize| {
            shows(lines[0].map(|sums| sums[i]), along) + shows(lines[1].map(|sums| sums[i]), along)
        };
        let of_column = |i: usize| shows(sums.map(|sums| sums[i]), upright);
        let last = places - 1;
        if last == 0 {
            seen[0] = of_lines(0) as u8;
            return;
        }
        // The outer ones lie beyond the patch at its ends.
        seen[0] = (of_column(a) + of_lines(0)) as u8;
        seen[last] = (of_column(last - 1) + of_lines(last)) as u8;
        let inner = last - 1;
        let left = sums.map(|sums| &sums[..inner]);
        let right = sums.map(|sums| &sums[a + 1..][..inner]);
        let [below, above] = lines.map(|line| line.map(|sums| &sums[1..=inner]));
        for (k, seen) in seen[1..last].iter_mut().enumerate() {
            let sides = shows([left[0][k], left[1][k]], upright)
                + shows([right[0][k], right[1][k]], upright)
                + shows([below[0][k], below[1][k]], along)
                + shows([above[0][k], above[1][k]], along);
            *seen = sides as u8;
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
