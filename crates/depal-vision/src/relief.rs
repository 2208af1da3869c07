//! Heights of a surface without gaps: no two cartons lie quite level, and one carton is one plane.

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use crate::{
    patch::{BLOCK, Patch},
    scratch::Kept,
    search::Candidate,
};

/// Sums over blocks: count, i, j, ii, ij, jj, then height times 1, i, j and itself.
type Sums = [f64; 10];

/// Mean height of each block over the surface's plane, metres.
pub struct Relief {
    columns: usize,
    rows: usize,
    /// `None` where little of the block is surface.
    heights: Vec<Option<f32>>,
    /// Sums over all blocks below and left.
    sums: Kept<Sums>,
    /// Variance of a block's height by noise, from neighbouring blocks, square metres.
    noise: f64,
}

/// How badly one plane explains the heights of some blocks.
#[derive(Debug, Clone, Copy, Default)]
pub struct PlaneMisfit {
    /// Sum of squared distances, square metres.
    pub squares: f64,
    pub blocks: usize,
}

impl Relief {
    /// Averages the surface cells of each block.
    pub fn new(patch: &Patch) -> Self {
        let (columns, rows) = (patch.columns / BLOCK, patch.rows / BLOCK);
        let heights = heights_of(patch);
        let noise = noise_of(&heights, columns, 1);
        // All but the first row and column is written below.
        let mut sums = Kept::of_any((columns + 1) * (rows + 1), [0.0; 10]);
        sums[..=columns].fill([0.0; 10]);
        for j in 0..rows {
            let mut row = [0.0; 10];
            sums[(j + 1) * (columns + 1)] = row;
            for i in 0..columns {
                if let Some(height) = heights[j * columns + i] {
                    let (x, y, h) = (i as f64, j as f64, f64::from(height));
                    let here = [1.0, x, y, x * x, x * y, y * y, h, x * h, y * h, h * h];
                    for (sum, term) in row.iter_mut().zip(here) {
                        *sum += term;
                    }
                }
                let below = sums[j * (columns + 1) + i + 1];
                sums[(j + 1) * (columns + 1) + i + 1] = std::array::from_fn(|k| below[k] + row[k]);
            }
        }
        Self {
            columns,
            rows,
            heights,
            sums,
            noise,
        }
    }

    /// The whole blocks of a candidate (columns, rows), a cell of margin left out, since it may be one off.
    pub fn blocks_of(&self, candidate: &Candidate) -> [Range<usize>; 2] {
        let range = |k: usize, count: usize| {
            let first = (candidate.first[k] + 1).div_ceil(BLOCK);
            let end = (candidate.first[k] + candidate.cells[k]).saturating_sub(1) / BLOCK;
            let end = end.min(count);
            first.min(end)..end
        };
        [range(0, self.columns), range(1, self.rows)]
    }

    /// Columns and rows of blocks.
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    fn sums_of(&self, candidate: &Candidate) -> Sums {
        let [i, j] = self.blocks_of(candidate);
        self.sums_within(&i, &j)
    }

    fn sums_within(&self, i: &Range<usize>, j: &Range<usize>) -> Sums {
        let at = |i: usize, j: usize| &self.sums[j * (self.columns + 1) + i];
        let (a, b, c, d) = (
            at(i.end, j.end),
            at(i.start, j.end),
            at(i.end, j.start),
            at(i.start, j.start),
        );
        std::array::from_fn(|k| a[k] - b[k] - c[k] + d[k])
    }

    /// Variance of a block's height by noise, square metres, from how much blocks of a row `lag` apart bend.
    pub fn noise(&self, lag: usize) -> f64 {
        if lag == 1 {
            self.noise
        } else {
            noise_of(&self.heights, self.columns, lag)
        }
    }

    /// The same of some columns and rows of blocks, of those next to each other or of every other one: the larger.
    pub fn noise_within(&self, i: &Range<usize>, j: &Range<usize>) -> f64 {
        let row = |j: usize| &self.heights[j * self.columns..][i.clone()];
        let heights: Vec<Option<f32>> = j.clone().flat_map(row).copied().collect();
        f64::max(
            noise_of(&heights, i.len(), 1),
            noise_of(&heights, i.len(), 2),
        )
    }

    /// How badly one plane explains the heights within candidates: over their whole blocks.
    pub fn misfit(&self, candidates: &[Candidate]) -> PlaneMisfit {
        let mut sums = [0.0; 10];
        for candidate in candidates {
            for (sum, more) in sums.iter_mut().zip(self.sums_of(candidate)) {
                *sum += more;
            }
        }
        misfit_of(&sums)
    }

    /// How badly one plane explains the heights of some columns and rows of blocks.
    pub fn misfit_within(&self, i: Range<usize>, j: Range<usize>) -> PlaneMisfit {
        misfit_of(&self.sums_within(&i, &j))
    }

    /// By how much less two planes, one for each of two rectangles of blocks, miss their heights than one plane for
    /// both does, square metres.
    pub fn gain_by_parting(&self, a: &[Range<usize>; 2], b: &[Range<usize>; 2]) -> f64 {
        let [a, b] = [a, b].map(|r| self.sums_within(&r[0], &r[1]));
        let both: Sums = std::array::from_fn(|k| a[k] + b[k]);
        let [both, a, b] = [both, a, b].map(|sums| misfit_of(&sums).squares);
        both - a - b
    }

    /// The plane through the heights of some columns and rows of blocks; `None` of too few.
    pub fn fit(&self, i: Range<usize>, j: Range<usize>) -> Option<Fit> {
        let sums = self.sums_within(&i, &j);
        Some(Fit {
            plane: plane_of(&sums)?,
            inverse: normal_of(&sums).try_inverse()?,
        })
    }

    /// How many of some blocks are surface.
    pub fn filled(&self, i: &Range<usize>, j: &Range<usize>) -> usize {
        self.sums_within(i, j)[0] as usize
    }

    /// True when all of some blocks are surface.
    pub fn is_full(&self, i: Range<usize>, j: Range<usize>) -> bool {
        self.filled(&i, &j) == i.len() * j.len()
    }

    /// Squared distance of each block within a candidate from the candidate's plane, square metres: (place in a
    /// list row by row, square).
    pub fn residuals(&self, candidate: &Candidate) -> Vec<(usize, f64)> {
        let Some(plane) = plane_of(&self.sums_of(candidate)) else {
            return Vec::new();
        };
        let [columns, rows] = self.blocks_of(candidate);
        rows.flat_map(|j| columns.clone().map(move |i| (i, j)))
            .filter_map(|(i, j)| {
                let at = j * self.columns + i;
                let off = f64::from(self.heights[at]?)
                    - plane[0]
                    - plane[1] * i as f64
                    - plane[2] * j as f64;
                Some((at, off * off))
            })
            .collect()
    }
}

/// A plane fitted to blocks.
pub struct Fit {
    plane: Vector3<f64>,
    inverse: Matrix3<f64>,
}

impl Fit {
    /// Height at a place (column, row of blocks), metres.
    pub fn height(&self, at: [f64; 2]) -> f64 {
        self.plane.dot(&Vector3::new(1.0, at[0], at[1]))
    }

    /// Variance of that height in variances of a block.
    pub fn spread(&self, at: [f64; 2]) -> f64 {
        let at = Vector3::new(1.0, at[0], at[1]);
        at.dot(&(self.inverse * at)).max(0.0)
    }
}

fn normal_of(&[n, x, y, xx, xy, yy, ..]: &Sums) -> Matrix3<f64> {
    Matrix3::new(n, x, y, x, xx, xy, y, xy, yy)
}

/// Height at the origin and per block along both axes; `None` of blocks too few or in a row.
fn plane_of(sums: &Sums) -> Option<Vector3<f64>> {
    let &[n, .., h, xh, yh, _] = sums;
    if n < 6.0 {
        return None;
    }
    let factor = normal_of(sums).cholesky()?;
    Some(factor.solve(&Vector3::new(h, xh, yh)))
}

fn misfit_of(sums: &Sums) -> PlaneMisfit {
    let &[count, .., squares] = sums;
    let Some(plane) = plane_of(sums) else {
        return PlaneMisfit::default();
    };
    let explained = plane[0] * sums[6] + plane[1] * sums[7] + plane[2] * sums[8];
    PlaneMisfit {
        squares: (squares - explained).max(0.0),
        blocks: count as usize,
    }
}

/// Mean height of each block over the patch's plane, metres; `None` where little of it is surface.
fn heights_of(patch: &Patch) -> Vec<Option<f32>> {
    const LEAST: u32 = (BLOCK * BLOCK / 2) as u32;
    let columns = patch.columns / BLOCK;
    patch
        .heights
        .iter()
        .enumerate()
        .map(|(n, sum)| {
            let count = patch.surface_cells_of_block(n % columns, n / columns);
            (count >= LEAST).then(|| sum / count as f32)
        })
        .collect()
}

/// Variance of a block's height by noise, square metres, from how much blocks of a row `lag` apart bend.
pub fn noise_of(heights: &[Option<f32>], columns: usize, lag: usize) -> f64 {
    // Of a - 2 b + c for white noise: six variances; the median of a square is 0.455 of its mean.
    const PER_MEDIAN: f64 = 1.0 / (6.0 * 0.455);
    let mut bends: Vec<f64> = Vec::new();
    for row in heights.chunks(columns.max(1)) {
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
