//! Cells of a patch of which nothing is known: hidden by something nearer, or not measured. Tape, shadows and
//! higher cartons are neither surface nor edge.

use crate::{gate::DepthImage, patch::Patch, resample::ResampledRow};

/// Sums over the unknown cells of a patch.
pub struct Unknown<'a> {
    patch: &'a Patch,
    /// Unknown cells of all cells below and left.
    sums: Vec<u32>,
    /// Height of each cell over the patch's plane, metres; NaN where it is no surface.
    heights: Vec<f32>,
}

impl<'a> Unknown<'a> {
    /// Looks at every cell of the patch once more; what was left out of it is not unknown.
    pub fn new(image: &DepthImage, patch: &'a Patch, tolerance: f64) -> Self {
        let (columns, rows) = (patch.columns, patch.rows);
        let mut row = ResampledRow::new(columns);
        let mut above = vec![0u32; columns + 1];
        let mut sums = Vec::with_capacity((columns + 1) * (rows + 1));
        sums.extend_from_slice(&above);
        let mut cells = vec![0u8; columns];
        let mut heights = Vec::with_capacity(columns * rows);
        for j in 0..rows {
            let along = patch.bottom + (j as f64 + 0.5) * patch.pitch;
            let first = patch.frame.point(patch.left + 0.5 * patch.pitch, along);
            row.fetch(image, first, patch.frame.x * patch.pitch);
            for (cell, unknown) in cells.iter_mut().zip(row.unknown(tolerance as f32)) {
                *cell = unknown;
            }
            let first_height = heights.len();
            heights.extend(row.heights(tolerance as f32));
            for blank in &patch.blanks {
                let blank = blank.cells(along, patch.left, patch.pitch, columns);
                cells[blank.clone()].fill(0);
                heights[first_height..][blank].fill(f32::NAN);
            }
            let mut sum = 0;
            for (&cell, total) in cells.iter().zip(&mut above[1..]) {
                sum += u32::from(cell);
                *total += sum;
            }
            sums.extend_from_slice(&above);
        }
        Self {
            patch,
            sums,
            heights,
        }
    }

    /// Height of a cell over the patch's plane, metres; `None` where it is no surface.
    pub fn height(&self, i: isize, j: isize) -> Option<f64> {
        let (i, j) = (usize::try_from(i).ok()?, usize::try_from(j).ok()?);
        let inside = i < self.patch.columns && j < self.patch.rows;
        let height = inside.then(|| self.heights[j * self.patch.columns + i])?;
        (!height.is_nan()).then(|| f64::from(height))
    }

    /// Share of the cells `i0..i1` x `j0..j1` that is unknown; beyond the patch nothing is.
    pub fn share(&self, i0: isize, j0: isize, i1: isize, j1: isize) -> f64 {
        let Some(([i0, j0, i1, j1], cells)) = self.patch.clipped(i0, j0, i1, j1) else {
            return 0.0;
        };
        let sum = |i: usize, j: usize| self.sums[j * (self.patch.columns + 1) + i];
        let unknown = sum(i1, j1) + sum(i0, j0) - sum(i0, j1) - sum(i1, j0);
        f64::from(unknown) / cells
    }
}
