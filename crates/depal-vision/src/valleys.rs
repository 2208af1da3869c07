//! What the gaps between cartons leave of themselves in a smeared picture: shallow valleys, seen only over their whole
//! length.

use crate::level::Level;

/// A seam's evidence is at most so many deviations: what a camera does along its own rows and columns is no noise.
const MOST: f64 = 6.0;

/// Looks for valleys on a level.
pub struct Valleys<'a> {
    level: &'a Level,
    /// How far beside a line its shoulders are, and over how much each is averaged, metres.
    beside: f64,
    wide: f64,
    /// Deviation of a valley's depth by chance, metres, over a length of `length` metres.
    noise: f64,
    length: f64,
}

impl<'a> Valleys<'a> {
    /// `smear`: metres over which the camera smears; `shortest`: the shortest side of a carton.
    pub fn new(level: &'a Level, smear: f64, shortest: f64) -> Self {
        let mut valleys = Self {
            level,
            beside: 0.5 * smear + 3.0 * level.cell,
            wide: 3.0 * level.cell,
            noise: f64::MAX,
            length: 0.5 * shortest,
        };
        let mut depths: Vec<f64> = Vec::new();
        let step = 0.25 * shortest;
        for axis in 0..2 {
            let [low, high] = level.range(axis);
            let [first, last] = level.range(1 - axis);
            let mut along = first;
            while along + valleys.length < last {
                let mut at = low + valleys.beside;
                while at + valleys.beside < high {
                    let range = [along, along + valleys.length];
                    if valleys.is_whole(axis, at, range) {
                        depths.extend(valleys.depth(axis, at, range));
                    }
                    at += 0.37 * step;
                }
                along += step;
            }
        }
        if depths.len() >= 20 {
            depths.sort_by(f64::total_cmp);
            let quartile = |k: usize| depths[k * (depths.len() - 1) / 4];
            valleys.noise = ((quartile(3) - quartile(1)) / 1.349).max(1e-4);
        }
        valleys
    }

    fn is_whole(&self, axis: usize, at: f64, range: [f64; 2]) -> bool {
        let (mut low, mut high) = ([0.0; 2], [0.0; 2]);
        let reach = self.beside + self.wide;
        (low[axis], high[axis]) = (at - reach, at + reach);
        (low[1 - axis], high[1 - axis]) = (range[0], range[1]);
        self.level.shares(low, high)[0] > 0.97
    }

    fn depth(&self, axis: usize, at: f64, range: [f64; 2]) -> Option<f64> {
        self.level.valley(axis, at, range, self.beside, self.wide)
    }

    /// How much speaks for a seam across `axis` at `at` over `range`, squared deviations.
    pub fn evidence(&self, axis: usize, at: f64, range: [f64; 2]) -> f64 {
        let length = range[1] - range[0];
        let inner = [range[0] + 0.1 * length, range[1] - 0.1 * length];
        let Some(depth) = self.depth(axis, at, inner) else {
            return 0.0;
        };
        let noise = self.noise * (self.length / (0.8 * length)).sqrt();
        (depth / noise).clamp(0.0, MOST).powi(2)
    }
}
