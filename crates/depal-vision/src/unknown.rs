//! Cells of a patch of which nothing is known: hidden by something nearer, or not measured. Tape, shadows and
//! higher cartons are neither surface nor edge.

use crate::{
    edge_sums::{row_and_next, sums_along},
    gate::DepthImage,
    patch::Patch,
    resample::ResampledRow,
    scratch::Kept,
    widest::with_widest_vectors,
};

/// Sums over the unknown cells of a patch.
pub struct Unknown<'a> {
    patch: &'a Patch,
    /// Unknown cells of all cells below and left.
    sums: Kept<u32>,
    /// Height of each cell over the patch's plane, metres; NaN where it is no surface.
    heights: Kept<f32>,
}

impl<'a> Unknown<'a> {
    /// Looks at every cell of the patch once more; what was left out of it is not unknown.
    pub fn new(image: &DepthImage, patch: &'a Patch, tolerance: f64) -> Self {
        let (sums, heights) = with_widest_vectors(
            #[inline(always)]
            || sums_and_heights(image, patch, tolerance as f32),
        );
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

/// Unknown cells of all cells below and left, and the height of each cell.
#[inline(always)]
fn sums_and_heights(image: &DepthImage, patch: &Patch, tolerance: f32) -> (Kept<u32>, Kept<f32>) {
    let (columns, rows) = (patch.columns, patch.rows);
    let mut row = ResampledRow::new(columns);
    // All but the first row and column is written by and by.
    let mut sums = Kept::of_any((columns + 1) * (rows + 1), 0u32);
    sums[..=columns].fill(0);
    let mut cells = vec![0u8; columns];
    let mut heights = Kept::with_capacity(columns * rows);
    for j in 0..rows {
        let along = patch.bottom + (j as f64 + 0.5) * patch.pitch;
        let first = patch.frame.point(patch.left + 0.5 * patch.pitch, along);
        row.fetch(image, &patch.frame, first, patch.frame.x * patch.pitch);
        for (cell, unknown) in cells.iter_mut().zip(row.unknown(tolerance)) {
            *cell = unknown;
        }
        let before = heights.len();
        heights.extend(row.heights(tolerance));
        for blank in &patch.blanks {
            let blank = blank.cells(along, patch.left, patch.pitch, columns);
            cells[blank.clone()].fill(0);
            heights[before..][blank].fill(f32::NAN);
        }
        let (before, next) = row_and_next(&mut sums, j, columns + 1);
        next[0] = 0;
        sums_along(&cells, &before[1..], &mut next[1..], |sum, before| {
            before + sum
        });
    }
    (sums, heights)
}
