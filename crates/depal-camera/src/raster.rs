//! Draws a view into strips of rows: 1/z and surface index, the nearest wins.
//!
//! 1/z of a plane is affine in the pixel, its sides are straight lines, and the outline of a sphere,
//! a cylinder or a disk is the sign of a quadratic along a row, so every row of a surface is a span
//! in closed form. Sides are planes through the eye (homogeneous edge functions, Olano and Greer
//! 1997), which makes clipping at the near plane needless.
//!
//! The image is kept in tiles of [`TILE`] columns and one band of rows, each with the farthest depth
//! drawn in it once it is full: what lies behind is passed over without a look at its pixels (Greene,
//! Kass and Miller 1993).

use depal_frames::Vector;

use crate::surface::Round;
use crate::view::{BAND, Drawable, FlatSpan, Grid, Outline, View};

/// Surface index of a pixel where nothing was drawn.
pub(crate) const EMPTY: u32 = u32::MAX;
/// Columns of a tile.
const TILE: usize = 16;

/// What is known of the pixels of a tile without a look at them.
#[derive(Debug, Clone, Copy)]
struct Tile {
    /// No pixel has a smaller 1/z, once `drawn` is full.
    least: f32,
    /// No pixel has a greater 1/z; 0 = the tile holds no pixel of this picture yet.
    most: f32,
    /// Bit 16 r + k: pixel k of row r is drawn.
    drawn: u128,
}

/// Scratch memory of a worker.
#[derive(Default)]
pub(crate) struct Tiles(Vec<Tile>);

/// Rows that are drawn together.
pub(crate) struct Strip<'a> {
    /// Image row of the first one.
    pub first_row: usize,
    /// Column of the first pixel in a row.
    pub first_column: i32,
    /// Pixels in a row.
    pub width: usize,
    /// 1/z of the nearest surface, 1/m; 0 = nothing. What it held before does not matter.
    pub inverse_depth: &'a mut [f32],
    /// Its index, or [`EMPTY`].
    pub surface: &'a mut [u32],
}

/// Draws all that a view shows in a strip.
#[inline(always)]
pub(crate) fn draw(view: &View, strip: &mut Strip, tiles: &mut Tiles) {
    let width = strip.width;
    let end_row = strip.first_row + strip.inverse_depth.len() / width.max(1);
    for band in strip.first_row / BAND..end_row.div_ceil(BAND) {
        let first_row = (band * BAND).max(strip.first_row);
        let rows = ((band + 1) * BAND).min(end_row) - first_row;
        let start = (first_row - strip.first_row) * width;
        tiles.0.clear();
        tiles.0.resize(
            width.div_ceil(TILE),
            Tile {
                least: f32::INFINITY,
                most: 0.0,
                drawn: 0,
            },
        );
        let mut target = Target {
            first_row,
            rows,
            first_column: strip.first_column,
            width,
            inverse_depth: &mut strip.inverse_depth[start..start + rows * width],
            surface: &mut strip.surface[start..start + rows * width],
            tiles: &mut tiles.0,
        };
        for &index in view.band(band) {
            let drawable = &view.drawables[index as usize];
            match &drawable.outline {
                Outline::Flat(flat) => target.polygon(drawable, flat, index),
                Outline::Round(round) => {
                    let round = &view.rounds[*round as usize];
                    target.round(&view.grid, drawable, round, index);
                }
            }
        }
        for tile in 0..target.tiles.len() {
            if target.tiles[tile].most == 0.0 {
                target.clear(tile);
            }
        }
    }
}

/// The part of a strip within one band of rows.
struct Target<'a> {
    first_row: usize,
    rows: usize,
    first_column: i32,
    width: usize,
    inverse_depth: &'a mut [f32],
    surface: &'a mut [u32],
    tiles: &'a mut [Tile],
}

/// Columns `from[r]..to[r]` of each row of a target, counted from its first column.
struct Spans {
    from: [i32; BAND],
    to: [i32; BAND],
}

impl Spans {
    const NONE: Self = Self {
        from: [i32::MAX; BAND],
        to: [0; BAND],
    };
}

/// 1/z of a plane over a target: `corner` at its first pixel.
#[derive(Clone, Copy)]
struct Ramp {
    corner: f64,
    per_column: f64,
    per_row: f64,
}

impl Target<'_> {
    /// The drawable's rows, counted from the target's first.
    #[inline(always)]
    fn rows_of(&self, drawable: &Drawable) -> std::ops::Range<usize> {
        let first = (drawable.rows.0 as usize).max(self.first_row) - self.first_row;
        let end = (drawable.rows.1 as usize).min(self.first_row + self.rows);
        first..end.saturating_sub(self.first_row)
    }

    /// The drawable's columns that the target holds: first and last.
    #[inline(always)]
    fn columns(&self, drawable: &Drawable) -> (f64, f64) {
        let end = self.first_column + self.width as i32;
        (
            f64::from(drawable.columns.0.max(self.first_column)),
            f64::from(drawable.columns.1.min(end) - 1),
        )
    }

    /// Whole columns of `lo..=hi`, which lie in the target, counted from its first column.
    #[inline(always)]
    fn whole(&self, lo: f64, hi: f64) -> (i32, i32) {
        // Not negative, so that cutting off is rounding down.
        let origin = f64::from(self.first_column);
        let (lo, hi) = (lo - origin, hi - origin);
        let cut = lo as i32;
        (cut + i32::from(f64::from(cut) < lo), hi as i32 + 1)
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

    #[inline(always)]
    fn polygon(&mut self, drawable: &Drawable, flat: &FlatSpan, index: u32) {
        let (first, last) = self.columns(drawable);
        if first > last {
            return;
        }
        let rows = self.rows_of(drawable);
        let (left, count) = (flat.left_sides as usize, flat.side_count as usize);
        let mut spans = Spans::NONE;
        for r in rows.clone() {
            let y = (self.first_row + r) as i32 as f64;
            let (mut lo, mut hi) = (first, last);
            for [a, b] in &flat.sides[..left] {
                lo = lo.max(a + b * y);
            }
            for [a, b] in &flat.sides[left..count] {
                hi = hi.min(a + b * y);
            }
            if lo <= hi {
                (spans.from[r], spans.to[r]) = self.whole(lo, hi);
            }
        }
        let ramp = Ramp {
            corner: flat.at_origin
                + flat.per_row * self.first_row as f64
                + flat.per_column * f64::from(self.first_column),
            per_column: flat.per_column,
            per_row: flat.per_row,
        };
        self.flat(rows, &spans, &ramp, index);
    }

    /// Draws a plane within spans.
    #[inline(always)]
    fn flat(&mut self, rows: std::ops::Range<usize>, spans: &Spans, ramp: &Ramp, index: u32) {
        let (mut least_from, mut most_from, mut least_to, mut most_to) = (i32::MAX, 0, i32::MAX, 0);
        for r in rows.clone() {
            let (from, to) = (spans.from[r], spans.to[r]);
            most_from = most_from.max(from);
            least_to = least_to.min(to);
            if from < to {
                least_from = least_from.min(from);
                most_to = most_to.max(to);
            }
        }
        if least_from >= most_to {
            return;
        }
        if rows.len() < self.rows {
            least_to = 0; // no tile is covered whole
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
            let (least, most) = ((corner + lower) as f32, (corner + upper) as f32);
            let state = self.tiles[tile];
            let all = state.drawn == full;
            if all && most <= state.least {
                continue;
            }
            let end = start + TILE;
            if most_from <= start as i32 && end as i32 <= least_to {
                let blind = least > state.most;
                self.cover(start, corner, ramp, &steps, index, blind);
                let state = &mut self.tiles[tile];
                state.least = if all { least.max(state.least) } else { least };
                state.most = state.most.max(most);
                state.drawn = full;
                continue;
            }
            if state.most == 0.0 {
                self.clear(tile);
            }
            let mut drawn = state.drawn;
            for r in rows.clone() {
                let from = (spans.from[r].max(start as i32) - start as i32) as usize;
                let to = spans.to[r].min(end as i32) - start as i32;
                if to <= from as i32 {
                    continue;
                }
                let to = to as usize;
                let base = (corner + ramp.per_row * f64::from(r as i32)) as f32;
                self.part(r, start, (from, to), base, &steps, index);
                drawn |= u128::from(((1_u32 << to) - 1) & !((1_u32 << from) - 1)) << (TILE * r);
            }
            let state = &mut self.tiles[tile];
            if !all {
                state.least = state.least.min(least);
            }
            state.most = state.most.max(most).max(f32::MIN_POSITIVE);
            state.drawn = drawn;
        }
    }

    /// `drawn` of a tile of full width without an empty pixel.
    fn full_tile(&self) -> u128 {
        u128::MAX >> (128 - TILE * self.rows)
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
                for k in 0..TILE {
                    let w = base + steps[k];
                    let nearer = w > depths[k];
                    depths[k] = if nearer { w } else { depths[k] };
                    surfaces[k] = if nearer { index } else { surfaces[k] };
                }
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
        for k in 0..TILE {
            let lane = k as i32;
            let w = base + steps[k];
            let nearer = (lane >= from) & (lane < to) & (w > depths[k]);
            depths[k] = if nearer { w } else { depths[k] };
            surfaces[k] = if nearer { index } else { surfaces[k] };
        }
    }

    #[inline(always)]
    fn round(&mut self, grid: &Grid, drawable: &Drawable, round: &Round, index: u32) {
        let (first, last) = self.columns(drawable);
        if first > last {
            return;
        }
        let rows = self.rows_of(drawable);
        let step = 1.0 / grid.fx;
        let first_row = self.first_row;
        let ray = |r: usize| {
            let y = ((first_row + r) as f64 - grid.cy) / grid.fy;
            Vector::new(-grid.cx / grid.fx, y, 1.0)
        };
        match round {
            Round::Disk {
                normal,
                plane,
                centre,
                radius,
            } => {
                // Inside when |r - w c|^2 <= (R w)^2 with w = 1/z, affine in u.
                let inverse = normal / *plane;
                let w1 = inverse.x * step;
                let g1 = Vector::new(step, 0.0, 0.0) - centre * w1;
                let r2 = radius * radius;
                let mut parts = [Spans::NONE, Spans::NONE];
                for r in rows.clone() {
                    let start = ray(r);
                    let w0 = inverse.dot(&start);
                    let g0 = start - centre * w0;
                    let inside = Quadratic {
                        c0: r2 * w0 * w0 - g0.norm_squared(),
                        c1: 2.0 * (r2 * w0 * w1 - g0.dot(&g1)),
                        c2: r2 * w1 * w1 - g1.norm_squared(),
                    };
                    let found = inside.spans(first, last);
                    for (part, span) in parts.iter_mut().zip(found) {
                        if let Some((lo, hi)) = span {
                            (part.from[r], part.to[r]) = self.whole(lo, hi);
                        }
                    }
                }
                let ramp = Ramp {
                    corner: inverse.dot(&ray(0)) + w1 * f64::from(self.first_column),
                    per_column: w1,
                    per_row: inverse.y / grid.fy,
                };
                for part in &parts {
                    self.flat(rows.clone(), part, &ramp, index);
                }
            }
            Round::Sphere { centre, radius } => {
                let rest = centre.norm_squared() - radius * radius;
                for r in rows {
                    let start = ray(r);
                    let curved = Curved {
                        b0: centre.dot(&start),
                        b1: centre.x * step,
                        a0: start.norm_squared(),
                        a1: start.x * step,
                        a2: step * step,
                        rest,
                    };
                    self.curved(r, &curved, &Slab::EVERYWHERE, (first, last), index);
                }
            }
            Round::Mantle {
                centre,
                axis,
                half_length,
                radius,
            } => {
                let along = centre.dot(axis);
                let off_axis = centre - axis * along;
                let rest = off_axis.norm_squared() - radius * radius;
                let s1 = axis.x * step;
                for r in rows {
                    let start = ray(r);
                    let s0 = start.dot(axis);
                    let curved = Curved {
                        b0: off_axis.dot(&start),
                        b1: off_axis.x * step,
                        a0: start.norm_squared() - s0 * s0,
                        a1: start.x * step - s0 * s1,
                        a2: step * step - s1 * s1,
                        rest,
                    };
                    let slab = Slab {
                        s0,
                        s1,
                        along,
                        half_length: *half_length,
                    };
                    self.curved(r, &curved, &slab, (first, last), index);
                }
            }
        }
    }

    #[inline(always)]
    fn curved(
        &mut self,
        row: usize,
        curved: &Curved,
        slab: &Slab,
        (first, last): (f64, f64),
        index: u32,
    ) {
        let root = curved.root();
        for (lo, hi) in root.spans(first, last).into_iter().flatten() {
            let (from, to) = self.whole(lo, hi);
            let mut at = from as usize;
            while (at as i32) < to {
                let tile = at / TILE;
                let stop = (to as usize).min((tile + 1) * TILE);
                self.curved_part(row, curved, &root, slab, (at, stop), index);
                at = stop;
            }
        }
    }

    /// Pixels `from..to` of a row, which lie in one tile.
    #[inline(always)]
    fn curved_part(
        &mut self,
        row: usize,
        curved: &Curved,
        root: &Quadratic,
        slab: &Slab,
        (from, to): (usize, usize),
        index: u32,
    ) {
        let column = f64::from(self.first_column) + from as f64;
        let scale = 1.0 / curved.rest;
        let (b0, b1) = (
            ((curved.b0 + curved.b1 * column) * scale) as f32,
            (curved.b1 * scale) as f32,
        );
        // The discriminant from this column on: small near the outline, so f64 until the root.
        let square = scale * scale;
        let q0 = root.at(column) * square;
        let q1 = (2.0 * root.c2 * column + root.c1) * square;
        let q2 = root.c2 * square;
        let mut values = [0.0_f32; TILE];
        for (k, w) in values[..to - from].iter_mut().enumerate() {
            let x = f64::from(k as i32);
            let discriminant = ((q2 * x + q1) * x + q0) as f32;
            *w = b0 + b1 * (k as i32 as f32) + discriminant.max(0.0).sqrt();
        }
        if slab.half_length.is_finite() {
            let (s0, s1) = (slab.s0 + slab.s1 * column, slab.s1);
            // A micrometre more, so that no pixel is lost between mantle and cap.
            let half = slab.half_length + 1e-6;
            for (k, w) in values[..to - from].iter_mut().enumerate() {
                let wide = f64::from(*w);
                let beyond = (s0 + s1 * f64::from(k as i32) - wide * slab.along).abs();
                *w = if beyond <= half * wide { *w } else { 0.0 };
            }
        }
        let tile = from / TILE;
        if self.tiles[tile].most == 0.0 {
            self.clear(tile);
        }
        let state = &mut self.tiles[tile];
        let full = u128::MAX >> (128 - TILE * self.rows);
        let range = row * self.width + from..row * self.width + to;
        let depths = &mut self.inverse_depth[range.clone()];
        let pixels = depths.iter_mut().zip(&mut self.surface[range]);
        for (k, ((depth, surface), &w)) in pixels.zip(&values).enumerate() {
            if w > 0.0 {
                let nearer = w > *depth;
                *depth = if nearer { w } else { *depth };
                *surface = if nearer { index } else { *surface };
                state.most = state.most.max(w);
                if state.drawn != full {
                    state.least = state.least.min(w);
                }
                state.drawn |= 1 << (TILE * row + from % TILE + k);
            }
        }
        state.most = state.most.max(f32::MIN_POSITIVE);
    }
}

/// The part of a tube between its ends: |s0 + s1 u - w along| <= half_length w.
struct Slab {
    s0: f64,
    s1: f64,
    along: f64,
    half_length: f64,
}

impl Slab {
    const EVERYWHERE: Self = Self {
        s0: 0.0,
        s1: 0.0,
        along: 0.0,
        half_length: f64::INFINITY,
    };
}

/// A sphere or tube along a row: a z^2 - 2 b z + rest = 0, so that the nearer root has
/// 1/z = (b + sqrt(b^2 - a rest)) / rest. `rest` > 0: the eye is outside.
struct Curved {
    a0: f64,
    a1: f64,
    a2: f64,
    b0: f64,
    b1: f64,
    rest: f64,
}

impl Curved {
    /// b^2 - a rest.
    fn root(&self) -> Quadratic {
        Quadratic {
            c0: self.b0 * self.b0 - self.a0 * self.rest,
            c1: 2.0 * (self.b0 * self.b1 - self.a1 * self.rest),
            c2: self.b1 * self.b1 - self.a2 * self.rest,
        }
    }
}

/// c0 + c1 u + c2 u^2.
struct Quadratic {
    c0: f64,
    c1: f64,
    c2: f64,
}

impl Quadratic {
    fn at(&self, x: f64) -> f64 {
        (self.c2 * x + self.c1) * x + self.c0
    }

    /// Whole columns of `first..=last` where it is not negative: at most two spans.
    fn spans(&self, first: f64, last: f64) -> [Option<(f64, f64)>; 2] {
        let cut = |lo: f64, hi: f64| {
            let (lo, hi) = (lo.ceil().max(first), hi.floor().min(last));
            (lo <= hi).then_some((lo, hi))
        };
        let (all_lo, all_hi) = (f64::NEG_INFINITY, f64::INFINITY);
        let discriminant = self.c1 * self.c1 - 4.0 * self.c2 * self.c0;
        if discriminant <= 0.0 || (self.c2 == 0.0 && self.c1 == 0.0) {
            return [
                if self.c2 > 0.0 || (self.c2 == 0.0 && self.c0 >= 0.0) {
                    cut(all_lo, all_hi)
                } else {
                    None
                },
                None,
            ];
        }
        // The form without cancellation; one root may be infinite when c2 = 0.
        let q = -0.5 * (self.c1 + discriminant.sqrt().copysign(self.c1));
        let (r, s) = (q / self.c2, self.c0 / q);
        if self.c2 == 0.0 {
            return [
                if self.c1 > 0.0 {
                    cut(s, all_hi)
                } else {
                    cut(all_lo, s)
                },
                None,
            ];
        }
        let (lo, hi) = (r.min(s), r.max(s));
        if self.c2 < 0.0 {
            [cut(lo, hi), None]
        } else {
            [cut(all_lo, lo), cut(hi, all_hi)]
        }
    }
}
