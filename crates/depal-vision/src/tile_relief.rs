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

/// Mean heights of the blocks of a level.
pub struct TileRelief {
    /// Middle (metres along the level's axes) and height of each block, metres.
    blocks: Vec<([f64; 2], f64)>,
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
                blocks.extend(height.map(|h| (low.map(|v| v + 0.5 * side), h)));
                heights.push(height.map(|h| h as f32));
            }
        }
        Self {
            blocks,
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
            let inset = self.half + self.margin.min(0.25 * tile.half[0].min(tile.half[1]) * 2.0);
            let inside: Vec<(Vector3<f64>, f64)> = self
                .blocks
                .iter()
                .filter(|(at, _)| tile.holds(*at, -inset))
                .map(|(at, h)| {
                    let [x, y] = [0, 1].map(|k| at[k] - tile.centre[k]);
                    (Vector3::new(1.0, x, y), *h)
                })
                .collect();
            if inside.len() < LEAST_BLOCKS {
                if tile.hidden {
                    continue;
                }
                return None;
            }
            let normal: Matrix3<f64> = inside.iter().map(|(p, _)| p * p.transpose()).sum();
            let right: Vector3<f64> = inside.iter().map(|(p, h)| p * *h).sum();
            // Blocks in a row have no plane.
            let Some(plane) = normal.cholesky().map(|c| c.solve(&right)) else {
                continue;
            };
            whole.squares += inside
                .iter()
                .map(|(p, h)| (h - plane.dot(p)).powi(2).min(MOST * self.noise))
                .sum::<f64>();
            whole.blocks += inside.len();
        }
        Some(whole)
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
