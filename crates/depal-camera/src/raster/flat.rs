//! Planes within spans.

use super::{Surface, TILE, Target};
use crate::row::{choose, mask};
use crate::view::{BAND, Drawable, FlatSpan};

/// Columns `from[r]..to[r]` of each row of a target, counted from its first column.
pub(super) struct Spans {
    pub from: [i32; BAND],
    pub to: [i32; BAND],
}

impl Spans {
    pub const NONE: Self = Self {
        from: [i32::MAX; BAND],
        to: [0; BAND],
    };

    /// Whole columns of `lo[r]..=hi[r]`, which lie in the target unless they are no span at all.
    #[inline(always)]
    pub fn within(
        lo: &[f64; BAND],
        hi: &[f64; BAND],
        origin: f64,
        rows: &std::ops::Range<usize>,
    ) -> Self {
        // Pushes the fraction out of the mantissa: nearest integer, half to even, and its low bits.
        const SHIFT: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52
        let mut spans = Self::NONE;
        let (first, end) = (rows.start as i32, rows.end as i32);
        for r in 0..BAND {
            let (lo, hi) = (lo[r] - origin, hi[r] - origin);
            let (low, high) = (lo + SHIFT, hi + SHIFT);
            let from = low.to_bits() as i32 + i32::from(low - SHIFT < lo);
            let to = high.to_bits() as i32 + 1 - i32::from(high - SHIFT > hi);
            let row = r as i32;
            let some = (lo <= hi) & (from < to) & (row >= first) & (row < end);
            spans.from[r] = if some { from } else { i32::MAX };
            spans.to[r] = if some { to } else { 0 };
        }
        spans
    }
}

/// 1/z of a plane over a target: `corner` at its first pixel.
#[derive(Clone, Copy)]
pub(super) struct Ramp {
    pub corner: f64,
    pub per_column: f64,
    pub per_row: f64,
}

impl Target<'_> {
    #[inline(always)]
    pub(super) fn polygon(&mut self, drawable: &Drawable, flat: &FlatSpan, surface: &Surface) {
        let Some((first, last)) = self.columns(drawable, surface) else {
            return;
        };
        let spans = self.sides(drawable, flat, (first, last));
        let ramp = Ramp {
            corner: flat.at_origin
                + flat.per_row * self.first_row as f64
                + flat.per_column * f64::from(self.first_column),
            per_column: flat.per_column,
            per_row: flat.per_row,
        };
        self.flat(&spans, &ramp, surface);
    }

    /// Columns `first..=last` within the sides of a polygon.
    #[inline(always)]
    pub(super) fn sides(
        &self,
        drawable: &Drawable,
        flat: &FlatSpan,
        (first, last): (f64, f64),
    ) -> Spans {
        let (left, count) = (flat.left_sides as usize, flat.side_count as usize);
        let (mut lo, mut hi) = ([first; BAND], [last; BAND]);
        let mut y = [0.0; BAND];
        for (r, y) in y.iter_mut().enumerate() {
            *y = f64::from((self.first_row + r) as i32);
        }
        for [a, b] in &flat.sides[..left] {
            for r in 0..BAND {
                let side = a + b * y[r];
                lo[r] = if side > lo[r] { side } else { lo[r] };
            }
        }
        for [a, b] in &flat.sides[left..count] {
            for r in 0..BAND {
                let side = a + b * y[r];
                hi[r] = if side < hi[r] { side } else { hi[r] };
            }
        }
        let origin = f64::from(self.first_column);
        Spans::within(&lo, &hi, origin, &self.rows_of(drawable))
    }

    /// Draws a plane within spans.
    #[inline(always)]
    pub(super) fn flat(&mut self, spans: &Spans, ramp: &Ramp, surface: &Surface) {
        let (mut least_from, mut most_from, mut least_to, mut most_to) = (i32::MAX, 0, i32::MAX, 0);
        let rows = self.rows as i32;
        for r in 0..BAND {
            let inside = (r as i32) < rows;
            let (from, to) = (spans.from[r], spans.to[r]);
            least_from = least_from.min(from);
            most_to = most_to.max(to);
            most_from = most_from.max(if inside { from } else { 0 });
            least_to = least_to.min(if inside { to } else { i32::MAX });
        }
        if least_from >= most_to {
            return;
        }
        // From the corner of a tile to its least and greatest value.
        let (across, down) = (
            ramp.per_column * (TILE - 1) as f64,
            ramp.per_row * (BAND - 1) as f64,
        );
        let (lower, upper) = (
            across.min(0.0) + down.min(0.0),
            across.max(0.0) + down.max(0.0),
        );
        let full = self.full_tile();
        // Spelt out once: with constant factors the compiler would fold some of the products.
        let slope = ramp.per_column as f32;
        let mut steps = [0.0_f32; TILE];
        for (k, step) in steps.iter_mut().enumerate() {
            *step = slope * (k as i32 as f32);
        }
        let steps = std::hint::black_box(steps);
        for tile in least_from as usize / TILE..=(most_to as usize - 1) / TILE {
            let start = tile * TILE;
            let corner = ramp.corner + ramp.per_column * f64::from(start as i32);
            let least = ((corner + lower) as f32).max(surface.least);
            let most = ((corner + upper) as f32).min(surface.most);
            let state = self.tiles[tile];
            if state.hides(most, surface.solid, full) {
                continue;
            }
            let all = state.drawn == full;
            let end = start + TILE;
            if most_from <= start as i32 && end as i32 <= least_to {
                let blind = least > state.seen.most;
                if !blind {
                    self.clear_if_unseen(tile);
                }
                self.cover(start, corner, ramp, &steps, surface.index, blind);
                let state = &mut self.tiles[tile];
                if blind {
                    (state.seen.face, state.seen.solid) = (surface.index, surface.solid);
                } else {
                    state.mix(surface.solid);
                }
                let before = state.seen.least;
                state.seen.least = if all { least.max(before) } else { least };
                state.seen.most = state.seen.most.max(most).max(f32::MIN_POSITIVE);
                state.drawn = full;
                continue;
            }
            self.clear_if_unseen(tile);
            let mut drawn = state.drawn;
            for r in 0..self.rows {
                let from = (spans.from[r].max(start as i32) - start as i32) as usize;
                let to = spans.to[r].min(end as i32) - start as i32;
                if to <= from as i32 {
                    continue;
                }
                let to = to as usize;
                let base = (corner + ramp.per_row * f64::from(r as i32)) as f32;
                self.part(r, start, (from, to), base, &steps, surface.index);
                drawn |= u128::from(((1_u32 << to) - 1) & !((1_u32 << from) - 1)) << (TILE * r);
            }
            let state = &mut self.tiles[tile];
            state.mix(surface.solid);
            if !all {
                state.seen.least = state.seen.least.min(least);
            }
            state.seen.most = state.seen.most.max(most).max(f32::MIN_POSITIVE);
            state.drawn = drawn;
        }
    }

    /// Draws a plane over a whole tile.
    #[inline(always)]
    fn cover(
        &mut self,
        start: usize,
        corner: f64,
        ramp: &Ramp,
        steps: &[f32; TILE],
        index: u32,
        blind: bool,
    ) {
        for r in 0..self.rows {
            let base = (corner + ramp.per_row * f64::from(r as i32)) as f32;
            let at = r * self.width + start;
            let (Some(depths), Some(surfaces)) = (
                self.inverse_depth[at..].first_chunk_mut::<TILE>(),
                self.surface[at..].first_chunk_mut::<TILE>(),
            ) else {
                return;
            };
            if blind {
                *depths = steps.map(|step| base + step);
                *surfaces = [index; TILE];
            } else {
                put_nearer(depths, surfaces, base, steps, index, &[u32::MAX; TILE]);
            }
        }
    }

    /// Draws a plane over pixels `from..to` of one row of a tile; `base` is its value at the tile's start.
    #[inline(always)]
    fn part(
        &mut self,
        row: usize,
        start: usize,
        (from, to): (usize, usize),
        base: f32,
        steps: &[f32; TILE],
        index: u32,
    ) {
        let at = row * self.width + start;
        let (Some(depths), Some(surfaces)) = (
            self.inverse_depth[at..].first_chunk_mut::<TILE>(),
            self.surface[at..].first_chunk_mut::<TILE>(),
        ) else {
            // The last tile of the last row may be narrow.
            for k in from..to {
                let w = base + steps[k];
                if w > self.inverse_depth[at + k] {
                    self.inverse_depth[at + k] = w;
                    self.surface[at + k] = index;
                }
            }
            return;
        };
        let (from, to) = (from as i32, to as i32);
        let mut inside = [0; TILE];
        for k in 0..TILE {
            let lane = k as i32;
            inside[k] = mask(lane >= from) & mask(lane < to);
        }
        put_nearer(depths, surfaces, base, steps, index, &inside);
    }
}

/// Draws a plane over the pixels of one row of a tile where `inside` is set and nothing nearer is.
#[inline(always)]
fn put_nearer(
    depths: &mut [f32; TILE],
    surfaces: &mut [u32; TILE],
    base: f32,
    steps: &[f32; TILE],
    index: u32,
    inside: &[u32; TILE],
) {
    let (mut own, mut nearer) = ([0.0; TILE], [0; TILE]);
    for k in 0..TILE {
        own[k] = base + steps[k];
    }
    for k in 0..TILE {
        nearer[k] = mask(own[k] > depths[k]) & inside[k];
    }
    for k in 0..TILE {
        let (own, before) = (own[k].to_bits(), depths[k].to_bits());
        depths[k] = f32::from_bits(choose(nearer[k], own, before));
    }
    for k in 0..TILE {
        surfaces[k] = choose(nearer[k], index, surfaces[k]);
    }
}
