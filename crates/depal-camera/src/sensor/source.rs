//! What each pixel looks at: itself, or by the sideways jitter a neighbour.

use super::band::{LitRows, RowScratch, Sensor};
use crate::light::{Patch, unpack};
use crate::raster::TILE;

impl Sensor<'_> {
    /// Row `r` of a smooth tile: 1/z goes on as it does at the pixel itself.
    #[inline(always)]
    pub(super) fn look_at_patch(
        &self,
        v: usize,
        r: usize,
        column: usize,
        patch: &Patch,
        row: &mut RowScratch,
    ) {
        let from = column * TILE;
        let at = v * self.rendering.intrinsics.width + from;
        let down = r as i32 as f32;
        let line = |[a, b, c, d]: [f32; 4]| (a + c * down, b + d * down);
        let ((s0, s1), (g0, g1)) = (line(patch.sigma), line(patch.grey));
        let [per_column, per_row] = patch.slope;
        let inverse_depth = self.rendering.inverse_depth[at..].first_chunk::<TILE>();
        let across = row.across[from..].first_chunk::<TILE>();
        let down = row.down[from..].first_chunk::<TILE>();
        let (Some(w), Some(across), Some(down)) = (inverse_depth, across, down) else {
            return; // no smooth tile is narrower
        };
        let depth = row.depth[from..].first_chunk_mut::<TILE>();
        let sigma = row.sigma[from..].first_chunk_mut::<TILE>();
        let grey = row.grey[from..].first_chunk_mut::<TILE>();
        let (Some(depth), Some(sigma), Some(grey)) = (depth, sigma, grey) else {
            return;
        };
        for k in 0..TILE {
            let t = k as i32 as f32;
            let w = w[k] + per_column * across[k] as f32 + per_row * down[k] as f32;
            depth[k] = 1.0 / w;
            sigma[k] = s0 + s1 * t;
            grey[k] = g0 + g1 * t;
        }
        row.keep[from..from + TILE].fill(patch.keep);
    }

    /// Columns `from..to` of an image row. Beside the image there is nothing to look at: such a pixel
    /// looks at itself. Which row it is belongs to the pixel looked at, so that rows and columns are
    /// picked one after the other.
    #[inline(always)]
    pub(super) fn look_at_pixels(
        &self,
        v: usize,
        (from, to): (usize, usize),
        lit: &LitRows,
        row: &mut RowScratch,
    ) {
        let i = &self.rendering.intrinsics;
        let reach = self.jitter.len();
        let (first, end) = (from.saturating_sub(reach), (to + reach).min(i.width));
        let (depth, packed) = lit.depth(v);
        row.between[first..end].copy_from_slice(&depth[first..end]);
        row.packed[first..end].copy_from_slice(&packed[first..end]);
        for k in 1..=reach {
            for (shift, other) in [(-(k as i32), v.checked_sub(k)), (k as i32, Some(v + k))] {
                let Some(other) = other.filter(|other| *other < i.height) else {
                    continue;
                };
                let (depth, packed) = lit.depth(other);
                pick(
                    shift,
                    &row.down[first..end],
                    (&depth[first..end], &mut row.between[first..end]),
                    (&packed[first..end], &mut row.packed[first..end]),
                );
            }
        }
        // The deviation's words go through the chances' place.
        row.depth[from..to].copy_from_slice(&row.between[from..to]);
        row.keep[from..to].copy_from_slice(&row.packed[from..to]);
        for k in 1..=reach {
            let (start, stop) = (from.max(k), to.min(i.width - k.min(i.width)));
            if start < to {
                pick(
                    -(k as i32),
                    &row.across[start..to],
                    (&row.between[start - k..to - k], &mut row.depth[start..to]),
                    (&row.packed[start - k..to - k], &mut row.keep[start..to]),
                );
            }
            if from < stop {
                pick(
                    k as i32,
                    &row.across[from..stop],
                    (&row.between[from + k..stop + k], &mut row.depth[from..stop]),
                    (&row.packed[from + k..stop + k], &mut row.keep[from..stop]),
                );
            }
        }
        for (sigma, keep) in row.sigma[from..to].iter_mut().zip(&mut row.keep[from..to]) {
            (*sigma, *keep) = unpack(*keep);
        }
    }
}

/// Takes the other's values where the step is this one.
#[inline(always)]
fn pick(
    shift: i32,
    steps: &[i32],
    (from_depth, depth): (&[f32], &mut [f32]),
    (from_packed, packed): (&[u32], &mut [u32]),
) {
    for ((depth, other), step) in depth.iter_mut().zip(from_depth).zip(steps) {
        *depth = if *step == shift { *other } else { *depth };
    }
    for ((packed, other), step) in packed.iter_mut().zip(from_packed).zip(steps) {
        *packed = if *step == shift { *other } else { *packed };
    }
}
