//! Heights of a surface without gaps: no two cartons lie quite level, and one carton is one plane.

use nalgebra::{Matrix3, Vector3};

use crate::{gate::DepthImage, patch::Patch, search::Candidate};

/// Side of a block whose heights are averaged, cells.
pub const BLOCK: usize = 8;
/// Samples along the side of a block.
const SAMPLES: usize = 4;

/// Mean height of each block over the surface's plane, metres.
pub struct Relief {
    columns: usize,
    rows: usize,
    /// `None` where little of the block is surface.
    heights: Vec<Option<f32>>,
}

impl Relief {
    /// Averages what lies within `tolerance` of the patch's plane.
    pub fn new(patch: &Patch, image: &DepthImage, tolerance: f64) -> Self {
        const LEAST: usize = SAMPLES * SAMPLES / 2;
        let (columns, rows) = (patch.columns / BLOCK, patch.rows / BLOCK);
        let k = &image.intrinsics;
        let spacing = BLOCK as f64 / SAMPLES as f64;
        let mut heights = Vec::with_capacity(columns * rows);
        for j in 0..rows {
            for i in 0..columns {
                let (mut sum, mut count) = (0.0, 0);
                for sample in 0..SAMPLES * SAMPLES {
                    let cell = |block: usize, n: usize| {
                        (block * BLOCK) as f64 + (n as f64 + 0.5) * spacing
                    };
                    let p = patch.frame.point(
                        patch.left + cell(i, sample % SAMPLES) * patch.pitch,
                        patch.bottom + cell(j, sample / SAMPLES) * patch.pitch,
                    );
                    let (u, v) = k.project(&p);
                    let (u, v) = (u + 0.5, v + 0.5);
                    let inside =
                        u >= 0.0 && v >= 0.0 && u < image.width as f64 && v < image.height as f64;
                    if !inside {
                        continue;
                    }
                    let (u, v) = (u as usize, v as usize);
                    let z = f64::from(image.depth[v * image.width + u]);
                    let expected = patch.frame.plane.depth(&k.ray(u as f64, v as f64));
                    if z > 0.0 && (z - expected).abs() <= tolerance {
                        sum += expected - z;
                        count += 1;
                    }
                }
                heights.push((count >= LEAST).then(|| (sum / f64::from(count as u32)) as f32));
            }
        }
        Self {
            columns,
            rows,
            heights,
        }
    }

    /// Variance of a block's height by noise, square metres, from how much the blocks of a row bend.
    pub fn noise(&self) -> f64 {
        // Of a - 2 b + c for white noise: six variances; the median of a square is 0.455 of its mean.
        const PER_MEDIAN: f64 = 1.0 / (6.0 * 0.455);
        let mut bends: Vec<f64> = Vec::new();
        for row in self.heights.chunks(self.columns.max(1)) {
            for w in row.windows(3) {
                if let [Some(a), Some(b), Some(c)] = w {
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
