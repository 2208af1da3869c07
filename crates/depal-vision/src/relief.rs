//! Heights of a surface without gaps: no two cartons lie quite level, and one carton is one plane.

use nalgebra::{Matrix3, Vector3};

use crate::{
    patch::{BLOCK, Patch},
    search::Candidate,
};

/// Mean height of each block over the surface's plane, metres.
pub struct Relief {
    columns: usize,
    rows: usize,
    /// `None` where little of the block is surface.
    heights: Vec<Option<f32>>,
}

impl Relief {
    /// Averages the surface cells of each block.
    pub fn new(patch: &Patch) -> Self {
        const LEAST: u32 = (BLOCK * BLOCK / 2) as u32;
        let (columns, rows) = (patch.columns / BLOCK, patch.rows / BLOCK);
        let heights = patch
            .heights
            .iter()
            .enumerate()
            .map(|(n, sum)| {
                let count = patch.surface_cells_of_block(n % columns, n / columns);
                (count >= LEAST).then(|| sum / count as f32)
            })
            .collect();
        Self {
            columns,
            rows,
            heights,
        }
    }

    /// Variance of a block's height by noise, square metres, from how much blocks of a row `lag` apart bend.
    pub fn noise(&self, lag: usize) -> f64 {
        // Of a - 2 b + c for white noise: six variances; the median of a square is 0.455 of its mean.
        const PER_MEDIAN: f64 = 1.0 / (6.0 * 0.455);
        let mut bends: Vec<f64> = Vec::new();
        for row in self.heights.chunks(self.columns.max(1)) {
            for w in row.windows(2 * lag + 1) {
                if let (Some(a), Some(b), Some(c)) = (w[0], w[lag], w[2 * lag]) {
                    bends.push(f64::from(a - 2.0 * b + c).powi(2));
                }
            }
        }
        if bends.is_empty() {
            return 0.0;
        }
        let middle = bends.len() / 2;
        *bends.select_nth_unstable_by(middle, f64::total_cmp).1 * PER_MEDIAN
    }

    /// How badly one plane explains the heights within candidates: sum of squares over their whole
    /// blocks, square metres, and the number of blocks.
    pub fn misfit(&self, candidates: &[Candidate]) -> (f64, usize) {
        // A cell of margin, since a candidate may be one off.
        let range = |candidate: &Candidate, k: usize, count: usize| {
            let first = (candidate.first[k] + 1).div_ceil(BLOCK);
            let end = (candidate.first[k] + candidate.cells[k]).saturating_sub(1) / BLOCK;
            first..end.min(count)
        };
        let (mut normal, mut right) = (Matrix3::<f64>::zeros(), Vector3::<f64>::zeros());
        let (mut squares, mut count) = (0.0, 0);
        for candidate in candidates {
            for j in range(candidate, 1, self.rows) {
                for i in range(candidate, 0, self.columns) {
                    let Some(height) = self.heights[j * self.columns + i] else {
                        continue;
                    };
                    let at = Vector3::new(1.0, i as f64, j as f64);
                    let height = f64::from(height);
                    normal += at * at.transpose();
                    right += at * height;
                    squares += height * height;
                    count += 1;
                }
            }
        }
        if count < 6 {
            return (0.0, 0);
        }
        let Some(factor) = normal.cholesky() else {
            return (0.0, 0);
        };
        let explained = right.dot(&factor.solve(&right));
        ((squares - explained).max(0.0), count)
    }
}
