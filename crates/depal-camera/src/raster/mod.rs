//! Draws a view into bands of rows: 1/z and surface index, the nearest wins.
//!
//! 1/z of a plane is affine in the pixel, its sides are straight lines, and the outline of a sphere,
//! a cylinder or a disk is the sign of a quadratic along a row, so every row of a surface is a span
//! in closed form. Sides are planes through the eye (homogeneous edge functions, Olano and Greer
//! 1997), which makes clipping at the near plane needless. A box with rounded edges is drawn as the flat
//! parts of its faces; only in the rims around them is the ray of each pixel followed.

mod flat;
mod quadratic;
mod rim;
mod round;
mod tile;

pub(crate) use tile::{EMPTY, MIXED, Seen, TILE, Tile};

use crate::view::{BAND, Drawable, Outline, View};

/// A band of rows that is drawn into.
pub(crate) struct Target<'a> {
    /// Image row of the first one, a multiple of [`BAND`].
    pub first_row: usize,
    /// Rows in it, at most [`BAND`].
    pub rows: usize,
    /// Column of the first pixel in a row.
    pub first_column: i32,
    /// Pixels in a row.
    pub width: usize,
    /// 1/z of the nearest surface, 1/m; 0 = nothing. What it held before does not matter.
    pub inverse_depth: &'a mut [f32],
    /// Its index, or [`EMPTY`].
    pub surface: &'a mut [u32],
    /// One for every [`TILE`] columns; they may hold what need not be drawn.
    pub tiles: &'a mut [Tile],
}

impl Target<'_> {
    /// Draws all that a view shows here. Pixels of tiles where nothing shows keep what they held
    /// before: see [`Self::clear_if_unseen`].
    #[inline(always)]
    pub fn draw(&mut self, view: &View) {
        for &index in view.band(self.first_row / BAND) {
            let drawable = &view.drawables[index as usize];
            let surface = Surface {
                index,
                solid: view.faces[index as usize].solid,
                least: drawable.least,
                most: drawable.most,
            };
            match &drawable.outline {
                Outline::Flat(flat) => self.polygon(drawable, flat, &surface),
                Outline::Round(round) => {
                    let round = &view.rounds[*round as usize];
                    self.round(&view.grid, drawable, round, &surface);
                }
                Outline::Rim(rim) => {
                    let rim = &view.rims[*rim as usize];
                    self.rim(view, drawable, rim, &surface);
                }
            }
        }
    }

    /// Makes the pixels of a tile empty when nothing was drawn into it.
    #[inline(always)]
    pub fn clear_if_unseen(&mut self, tile: usize) {
        if self.tiles[tile].seen.most == 0.0 {
            self.clear(tile);
        }
    }

    #[inline(always)]
    fn clear(&mut self, tile: usize) {
        let start = tile * TILE;
        let end = (start + TILE).min(self.width);
        for row in 0..self.rows {
            self.inverse_depth[row * self.width + start..row * self.width + end].fill(0.0);
            self.surface[row * self.width + start..row * self.width + end].fill(EMPTY);
        }
    }

    /// `drawn` of a tile of full width without an empty pixel.
    #[inline(always)]
    pub fn full_tile(&self) -> u128 {
        u128::MAX >> (128 - TILE * self.rows)
    }

    /// The drawable's rows, counted from the target's first.
    #[inline(always)]
    fn rows_of(&self, drawable: &Drawable) -> std::ops::Range<usize> {
        let first = (drawable.rows.0 as usize).max(self.first_row) - self.first_row;
        let end = (drawable.rows.1 as usize).min(self.first_row + self.rows);
        first..end.saturating_sub(self.first_row)
    }

    /// The drawable's columns that the target holds, first and last.
    #[inline(always)]
    fn held(&self, drawable: &Drawable) -> Option<(i32, i32)> {
        let first = drawable.columns.0.max(self.first_column);
        let last = drawable
            .columns
            .1
            .min(self.first_column + self.width as i32)
            - 1;
        (first <= last).then_some((first, last))
    }

    /// The same; none when all of them show something nearer or need not be drawn.
    #[inline(always)]
    fn columns(&self, drawable: &Drawable, surface: &Surface) -> Option<(f64, f64)> {
        let (first, last) = self.held(drawable)?;
        let tile = |column: i32| (column - self.first_column) as usize / TILE;
        let full = self.full_tile();
        let tiles = &self.tiles[tile(first)..=tile(last)];
        let shows = tiles
            .iter()
            .any(|tile| !tile.hides(surface.most, surface.solid, full));
        shows.then_some((f64::from(first), f64::from(last)))
    }
}

/// What is drawn, apart from its outline.
#[derive(Clone, Copy)]
struct Surface {
    index: u32,
    solid: u32,
    /// Bounds of 1/z on it.
    least: f32,
    most: f32,
}
