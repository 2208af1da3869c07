//! How little plane the tops of a reading are: no two cartons lie quite level, and one carton is one plane.

use nalgebra::{Matrix3, Vector3};

use crate::{level::Level, misfit::Misfit, relief::noise_of, tiling::Tile};

/// Heights are averaged over squares of so many cells.
const BLOCK: usize = 5;
/// Of the surface around a block, more than this share.
const ALL: f64 = 0.97;
/// A block is off by no more than so many variances of the noise: what a step beside the top leaves of itself says
/// nothing of the top.
const MOST: f64 = 16.0;
/// Fewer blocks of a top say nothing.
const LEAST_BLOCKS: usize = 6;
/// So many blocks apart, along both axes, noise is looked at for whether it hangs together.
const REACH: isize = 5;

/// A square of surface.
struct Block {
    /// Its place in a list row by row.
    place: usize,
    /// Its middle along the level's axes, and its height, metres.
    at: [f64; 2],
    height: f64,
}

/// Mean heights of the blocks of a level.
pub struct TileRelief {
    blocks: Vec<Block>,
    /// Blocks along both axes, those that say nothing too.
    count: [usize; 2],
    half: f64,
    /// Variance of a block's height by noise, square metres: also by what undulates over half a carton.
    pub noise: f64,
    /// So far inside a top its sides are not seen, metres.
    margin: f64,
    /// Blocks over which noise hangs together.
    pub lump: f64,
}

impl TileRelief {
    /// `soft`: cells over which the picture is smeared or averaged.
    /// `shortest`: the shortest side of a carton; `sigma`: deviation of a depth by noise, metres.
    pub fn new(level: &Level, soft: usize, shortest: f64, sigma: f64) -> Self {
        let side = BLOCK as f64 * level.cell;
        let [x, y] = [0, 1].map(|axis| level.range(axis));
        let count = |r: [f64; 2]| ((r[1] - r[0]) / side) as usize;
        let margin = 0.5 * soft as f64 * level.cell;
        let mut blocks = Vec::new();
        let mut heights = Vec::new();
        for j in 0..count(y) {
            for i in 0..count(x) {
                let low = [x[0] + i as f64 * side, y[0] + j as f64 * side];
                // Beside what stands on the level, and beside its end, a step is smeared over it.
                let around =
                    |by: f64| level.flat_share(low.map(|v| v - by), low.map(|v| v + side + by));
                let height = (around(margin) > ALL)
                    .then(|| level.mean_height(low, low.map(|v| v + side)))
                    .flatten();
                blocks.extend(height.map(|height| Block {
                    place: heights.len(),
                    at: low.map(|v| v + 0.5 * side),
                    height,
                }));
                heights.push(height.map(|h| h as f32));
            }
        }
        Self {
            blocks,
            count: [count(x), count(y)],
            noise: noise_along_both(
                &heights,
                count(x),
                [soft.div_ceil(BLOCK), (0.4 * shortest / side) as usize],
            )
            .max(sigma * sigma),
            half: 0.5 * side,
            margin,
            lump: (soft as f64 / BLOCK as f64).powi(2).max(1.0),
        }
    }

    /// Distance of the blocks inside the tops from a plane for each of them.
    /// `None` where too little of a top is seen to tell.
    pub fn misfit(&self, tiles: &[Tile]) -> Option<Misfit> {
        let mut whole = Misfit {
            cartons: tiles.len(),
            ..Misfit::default()
        };
        for tile in tiles {
            let Some(residuals) = self.residuals(tile) else {
                if tile.hidden {
                    continue;
                }
                return None;
            };
            whole.squares += residuals
                .iter()
                .map(|(_, off)| off.powi(2).min(MOST * self.noise))
                .sum::<f64>();
            whole.blocks += residuals.len();
        }
        Some(whole)
    }

    /// Distance of each block inside a top from the top's plane, metres, with its place; `None` of too few.
    fn residuals(&self, tile: &Tile) -> Option<Vec<(usize, f64)>> {
        let inset = self.half + self.margin.min(0.25 * tile.half[0].min(tile.half[1]) * 2.0);
        let inside: Vec<(&Block, Vector3<f64>)> = self
            .blocks
            .iter()
            .filter(|block| tile.holds(block.at, -inset))
            .map(|block| {
                let [x, y] = [0, 1].map(|k| block.at[k] - tile.centre[k]);
                (block, Vector3::new(1.0, x, y))
            })
            .collect();
        if inside.len() < LEAST_BLOCKS {
            return None;
        }
        let normal: Matrix3<f64> = inside.iter().map(|(_, p)| p * p.transpose()).sum();
        let right: Vector3<f64> = inside.iter().map(|(b, p)| p * b.height).sum();
        // Blocks in a row have no plane.
        let Some(plane) = normal.cholesky().map(|c| c.solve(&right)) else {
            return Some(Vec::new());
        };
        let off = |(b, p): &(&Block, Vector3<f64>)| (b.place, b.height - plane.dot(p));
        Some(inside.iter().map(off).collect())
    }

    /// Over how many blocks noise hangs together, as what the planes of some tops leave shows: the sum of its
    /// correlations. A camera's window tells no more than about how many.
    pub fn lump_of(&self, tiles: &[Tile]) -> f64 {
        let [columns, rows] = self.count.map(|n| n as isize);
        let mut off = vec![f64::NAN; self.count[0] * self.count[1]];
        for (place, residual) in tiles.iter().filter_map(|t| self.residuals(t)).flatten() {
            off[place] = residual;
        }
        let at = |i: isize, j: isize| {
            let inside = (0..columns).contains(&i) && (0..rows).contains(&j);
            inside
                .then(|| off[(j * columns + i) as usize])
                .filter(|off| !off.is_nan())
        };
        let covariance = |di: isize, dj: isize| {
            let (mut sum, mut pairs) = (0.0, 0usize);
            for j in 0..rows {
                for i in 0..columns {
                    if let (Some(a), Some(b)) = (at(i, j), at(i + di, j + dj)) {
                        sum += a * b;
                        pairs += 1;
                    }
                }
            }
            sum / pairs.max(1) as f64
        };
        let variance = covariance(0, 0);
        if variance <= 0.0 {
            return self.lump;
        }
        // Each lag stands for its opposite, too.
        let half = (-REACH..=REACH).flat_map(|di| (0..=REACH).map(move |dj| (di, dj)));
        let beside: f64 = half
            .filter(|(di, dj)| *dj > 0 || *di > 0)
            .map(|(di, dj)| covariance(di, dj).max(0.0))
            .sum();
        1.0 + 2.0 * beside / variance
    }
}

/// The greatest of the variances along rows and columns, at some distances in blocks.
fn noise_along_both(heights: &[Option<f32>], columns: usize, lags: [usize; 2]) -> f64 {
    let rows = heights.len() / columns.max(1);
    let turned: Vec<Option<f32>> = (0..columns * rows)
        .map(|n| heights[n % rows * columns + n / rows])
        .collect();
    let of = |lag: usize| noise_of(heights, columns, lag).max(noise_of(&turned, rows, lag));
    lags.into_iter()
        .filter(|l| *l > 0)
        .map(of)
        .fold(0.0, f64::max)
}
