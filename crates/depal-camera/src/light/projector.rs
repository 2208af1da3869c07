//! The scene from the projector: what its pattern does not reach.
//!
//! The projector stands on the camera's X axis, so rows correspond and a point at (u, z) lies in its
//! column u - fx * baseline / z. It is drawn band by band, and of each tile only what can throw a
//! shadow on a point that the camera sees: what is nearer than all of them and not their own solid.

use depal_frames::Pose;

use crate::raster::{EMPTY, MIXED, Seen, TILE, Target, Tile};
use crate::row::chunk_or;
use crate::view::{BAND, Grid, View};
use crate::{CameraSpec, Rendering};

/// Something this far before a point hides it from the projector, metres.
const SHADOW_DEPTH: f32 = 0.002;
/// The projector's picture is at most this many times wider than the camera's.
const MAX_WIDTHS: f32 = 8.0;

pub(super) struct Projector<'a> {
    rendering: &'a Rendering,
    view: View,
    /// fx * baseline, px m.
    disparity: f32,
    /// Nearest that counts for the strip's width, 1/m.
    nearest: f32,
}

/// A band of the projector's picture, and what it means for the camera's tiles.
#[derive(Default)]
pub(super) struct Strip {
    inverse_depth: Vec<f32>,
    surface: Vec<u32>,
    tiles: Vec<Tile>,
    /// First and last projector column of each camera tile.
    columns: Vec<(i32, i32)>,
    /// No pixel of the camera tile is in a shadow.
    reached: Vec<bool>,
}

impl Strip {
    pub fn is_reached(&self, column: usize) -> bool {
        self.reached[column]
    }
}

impl<'a> Projector<'a> {
    pub fn new(spec: &CameraSpec, rendering: &'a Rendering) -> Self {
        let i = rendering.intrinsics;
        let margin = (MAX_WIDTHS * i.width as f32) as i32;
        let grid = Grid {
            columns: (-margin, i.width as i32 + margin),
            rows: i.height,
            fx: i.fx,
            fy: i.fy,
            cx: i.cx,
            cy: i.cy,
        };
        let projector_from_world =
            Pose::translation(-spec.baseline, 0.0, 0.0) * rendering.camera_from_world;
        let mut view = View::default();
        view.show(
            grid,
            &projector_from_world,
            &rendering.shapes,
            &rendering.meshes,
        );
        Self {
            rendering,
            view,
            disparity: (i.fx * spec.baseline) as f32,
            nearest: 1.0 / spec.near as f32,
        }
    }

    /// Marks the pixels of a band that the projector does not reach.
    #[inline(always)]
    pub fn shade(&self, band: usize, strip: &mut Strip, shade: &mut [u16]) {
        let i = &self.rendering.intrinsics;
        let tiles = i.width.div_ceil(TILE);
        let seen = &self.rendering.tiles[band * tiles..(band + 1) * tiles];
        let first_row = band * BAND;
        let rows = (i.height - first_row).min(BAND);
        strip.reached.clear();
        strip.reached.resize(tiles, true);
        let Some((first_column, width)) = self.fit(seen, strip) else {
            return;
        };
        strip.tiles.clear();
        let nothing_to_shade = Tile {
            drawn: u128::MAX >> (128 - TILE * rows),
            ..Tile::BLANK
        };
        strip.tiles.resize(width.div_ceil(TILE), nothing_to_shade);
        for (tile, columns) in seen.iter().zip(&strip.columns) {
            if tile.most == 0.0 {
                continue;
            }
            let least = least_that_hides(tile);
            for target in &mut strip.tiles[tiles_of(*columns, first_column)] {
                target.seen.least = target.seen.least.min(least);
                target.spared = match target.spared {
                    EMPTY => tile.solid,
                    same if same == tile.solid => same,
                    _ => MIXED,
                };
            }
        }
        let pixels = width * rows;
        if strip.inverse_depth.len() < pixels {
            strip.inverse_depth.resize(pixels, 0.0);
            strip.surface.resize(pixels, EMPTY);
        }
        let mut target = Target {
            first_row,
            rows,
            first_column,
            width,
            inverse_depth: &mut strip.inverse_depth[..pixels],
            surface: &mut strip.surface[..pixels],
            tiles: &mut strip.tiles,
        };
        target.draw(&self.view);
        for (column, tile) in seen.iter().enumerate() {
            if tile.most == 0.0 {
                continue;
            }
            let range = tiles_of(strip.columns[column], first_column);
            // Nothing there, nothing but the tile's own solid, or nothing near enough to hide any of it.
            let least = least_that_hides(tile);
            let harmless = |there: &Seen| {
                let solid = there.solid;
                solid == EMPTY || (solid == tile.solid && solid != MIXED) || there.most <= least
            };
            if target.tiles[range.clone()]
                .iter()
                .all(|t| harmless(&t.seen))
            {
                continue;
            }
            for k in range {
                target.clear_if_unseen(k);
                target.tiles[k].seen.most = target.tiles[k].seen.most.max(f32::MIN_POSITIVE);
            }
            let mut hidden = 0;
            for row in 0..rows {
                let pixels = self.look(&target, row, column);
                shade[row * tiles + column] = pixels;
                hidden |= pixels;
            }
            strip.reached[column] = hidden == 0;
        }
    }

    /// Columns that the camera's tiles have in the projector's picture; its first column and width.
    #[inline(always)]
    fn fit(&self, seen: &[Seen], strip: &mut Strip) -> Option<(i32, usize)> {
        let width = self.rendering.intrinsics.width as f32;
        let farthest = MAX_WIDTHS * width - 4.0;
        let shift = |w: f32| (self.disparity * w.min(self.nearest)).clamp(-farthest, farthest);
        let (mut first, mut last) = (i32::MAX, i32::MIN);
        strip.columns.clear();
        for (column, tile) in seen.iter().enumerate() {
            let start = (column * TILE) as i32;
            if tile.most == 0.0 {
                strip.columns.push((start, start));
                continue;
            }
            let (a, b) = (shift(tile.least), shift(tile.most));
            // A pixel more for rounding, and the conversion cuts off towards zero.
            let from = start - a.max(b) as i32 - 2;
            let to = start + TILE as i32 - a.min(b) as i32 + 2;
            (first, last) = (first.min(from), last.max(to));
            strip.columns.push((from, to));
        }
        (first <= last).then(|| (first, (last - first + 1) as usize))
    }

    /// Bit k: pixel k of a row of a camera tile is hidden from the projector. A convex solid does not
    /// hide its own lit side, so its own surfaces do not count.
    #[inline(always)]
    fn look(&self, target: &Target, row: usize, column: usize) -> u16 {
        let r = self.rendering;
        let width = r.intrinsics.width;
        let start = column * TILE;
        let count = TILE.min(width - start);
        let at = (target.first_row + row) * width + start;
        let strip = row * target.width..(row + 1) * target.width;
        let depths = &target.inverse_depth[strip.clone()];
        let own: [f32; TILE] = chunk_or(&r.inverse_depth[at..at + count], 0, 0.0);
        // Pushes the fraction out of the mantissa.
        const SHIFT: f32 = 8_388_608.0; // 2^23
        let origin = (start as i32 - target.first_column) as f32;
        let most = (target.width - 1) as f32;
        let mut places = [0_u32; TILE];
        for k in 0..TILE {
            let place = origin + k as i32 as f32 - self.disparity * own[k];
            places[k] = (place.max(0.0).min(most) + SHIFT).to_bits() & 0x7f_ffff;
        }
        let mut others = [0.0_f32; TILE];
        for k in 0..TILE {
            others[k] = depths[places[k] as usize];
        }
        let mut bits = [0_u32; TILE];
        for k in 0..TILE {
            let (w, other) = (own[k], others[k]);
            // 1/w - 1/other > depth, without the divisions.
            let hides = (other - w > SHADOW_DEPTH * w * other) & (w > 0.0);
            bits[k] = u32::from(hides) << k;
        }
        let mut hidden = bits.iter().fold(0, |all, bit| all | bit) as u16;
        let (mut left, mut last) = (hidden, (EMPTY, EMPTY, false));
        while left != 0 {
            let k = left.trailing_zeros() as usize;
            left &= left - 1;
            let before = target.surface[strip.start + places[k] as usize];
            let own = r.surface[at + k];
            if (before, own) != (last.0, last.1) {
                let solid = self.view.faces[before as usize].solid;
                last = (before, own, solid == r.view.faces[own as usize].solid);
            }
            hidden &= !(u16::from(last.2) << k);
        }
        hidden
    }
}

/// What is nearer than this 1/z stands more than the least depth before some point of a tile.
#[inline(always)]
fn least_that_hides(tile: &Seen) -> f32 {
    tile.least / (1.0 - SHADOW_DEPTH * tile.least).max(1e-6)
}

/// Tiles of the projector's picture that hold columns `from..=to`.
fn tiles_of((from, to): (i32, i32), first_column: i32) -> std::ops::RangeInclusive<usize> {
    (from - first_column) as usize / TILE..=(to - first_column) as usize / TILE
}
