//! What each pixel looks at: itself, or by the sideways jitter a neighbour.

use super::band::{LitRows, RowScratch, Sensor};
use crate::light::{Patch, unpack};
use crate::noise::draw_steps;
use crate::raster::TILE;
use crate::row::{choose, chunk, chunk_mut, mask};
use crate::view::BAND;

impl Sensor<'_> {
    /// Draws the sideways steps of a row. Beside the image there is nothing to look at: such a pixel
    /// looks at itself.
    #[inline(always)]
    pub(super) fn draw_jitter(&self, row: &mut RowScratch) {
        let reach = self.jitter.len();
        if reach == 0 {
            return;
        }
        draw_steps(&self.jitter, &row.words[0], 16, &mut row.across);
        draw_steps(&self.jitter, &row.words[0], 0, &mut row.down);
        let width = self.rendering.intrinsics.width;
        for u in (0..reach.min(width)).chain(width.saturating_sub(reach)..width) {
            let to = u as i64 + i64::from(row.across[u]);
            if !(0..width as i64).contains(&to) {
                row.across[u] = 0;
            }
        }
    }

    /// A row of a smooth tile: 1/z goes on as it does at the pixel itself.
    #[inline(always)]
    pub(super) fn look_at_patch(&self, v: usize, tile: usize, patch: &Patch, row: &mut RowScratch) {
        let from = tile * TILE;
        let ((s0, s1), (g0, g1)) = patch.row(v % BAND);
        let [per_column, per_row] = patch.slope;
        let width = self.rendering.intrinsics.width;
        let w = chunk(&self.rendering.inverse_depth, v * width + from);
        let across = chunk(&row.across, from);
        let down = chunk(&row.down, from);
        let (mut depth, mut sigma, mut grey) = ([0.0; TILE], [0.0; TILE], [0.0; TILE]);
        for k in 0..TILE {
            let t = k as i32 as f32;
            let w = w[k] + per_column * across[k] as f32 + per_row * down[k] as f32;
            depth[k] = 1.0 / w;
            sigma[k] = s0 + s1 * t;
            grey[k] = g0 + g1 * t;
        }
        *chunk_mut(&mut row.depth, from) = depth;
        *chunk_mut(&mut row.sigma, from) = sigma;
        *chunk_mut(&mut row.grey, from) = grey;
        *chunk_mut(&mut row.keep, from) = [patch.keep; TILE];
    }

    /// For another tile, the row that each of its pixels looks at, and of the pixels beside it, which it may
    /// look at. Which row that is belongs to the pixel looked at, so that rows and columns are picked one
    /// after the other. Up to column `done` it is picked already.
    #[inline(always)]
    pub(super) fn pick_rows(
        &self,
        v: usize,
        tile: usize,
        lit: &LitRows,
        done: &mut usize,
        row: &mut RowScratch,
    ) {
        let width = row.depth.len();
        let (from, reach) = (tile * TILE, self.jitter.len());
        // In pieces that may overlap.
        let end = (from + TILE + reach).min(width);
        let mut at = from.saturating_sub(reach).max(*done);
        while at < end {
            self.look_up_and_down(v, at.min(end - TILE), lit, row);
            at += TILE;
        }
        *done = end;
    }

    /// What the pixels of such a tile look at.
    #[inline(always)]
    pub(super) fn pick_columns(&self, tile: usize, row: &mut RowScratch) {
        let from = tile * TILE;
        let across = chunk(&row.across, from);
        // The buffers start a tile before the row.
        let at = from + TILE;
        let (mut depth, mut packed) = (*chunk(&row.between, at), *chunk(&row.packed, at));
        for k in 1..=self.jitter.len().min(TILE) {
            let step = k as i32;
            let before = (chunk(&row.between, at - k), chunk(&row.packed, at - k));
            pick(-step, across, before, (&mut depth, &mut packed));
            let behind = (chunk(&row.between, at + k), chunk(&row.packed, at + k));
            pick(step, across, behind, (&mut depth, &mut packed));
        }
        let (mut sigma, mut keep) = ([0.0; TILE], [0; TILE]);
        for k in 0..TILE {
            (sigma[k], keep[k]) = unpack(packed[k]);
        }
        *chunk_mut(&mut row.depth, from) = depth;
        *chunk_mut(&mut row.sigma, from) = sigma;
        *chunk_mut(&mut row.keep, from) = keep;
    }

    /// Picks the row that each of [`TILE`] pixels from column `at` on looks at.
    #[inline(always)]
    fn look_up_and_down(&self, v: usize, at: usize, lit: &LitRows, row: &mut RowScratch) {
        let height = self.rendering.intrinsics.height;
        let down = chunk(&row.down, at);
        let (depth, packed) = lit.depth(v);
        let (mut depth, mut packed) = (*chunk(depth, at), *chunk(packed, at));
        for k in 1..=self.jitter.len() {
            if v >= k {
                let (above, above_packed) = lit.depth(v - k);
                let above = (chunk(above, at), chunk(above_packed, at));
                pick(-(k as i32), down, above, (&mut depth, &mut packed));
            }
            if v + k < height {
                let (below, below_packed) = lit.depth(v + k);
                let below = (chunk(below, at), chunk(below_packed, at));
                pick(k as i32, down, below, (&mut depth, &mut packed));
            }
        }
        *chunk_mut(&mut row.between, at + TILE) = depth;
        *chunk_mut(&mut row.packed, at + TILE) = packed;
    }
}

/// Takes the other's values where the step is this one.
#[inline(always)]
fn pick(
    shift: i32,
    steps: &[i32; TILE],
    (from_depth, from_packed): (&[f32; TILE], &[u32; TILE]),
    (depth, packed): (&mut [f32; TILE], &mut [u32; TILE]),
) {
    let mut here = [0; TILE];
    for k in 0..TILE {
        here[k] = mask(steps[k] == shift);
    }
    for k in 0..TILE {
        let (there, own) = (from_depth[k].to_bits(), depth[k].to_bits());
        depth[k] = f32::from_bits(choose(here[k], there, own));
    }
    for k in 0..TILE {
        packed[k] = choose(here[k], from_packed[k], packed[k]);
    }
}
