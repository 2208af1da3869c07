//! Draws a view into strips of rows: 1/z and surface index, the nearest wins.
//!
//! 1/z of a plane is affine in the pixel, its sides are straight lines, and the outline of a sphere,
//! a cylinder or a disk is the sign of a quadratic along a row, so every row of a surface is a span
//! in closed form. Sides are planes through the eye (homogeneous edge functions, Olano and Greer
//! 1997), which makes clipping at the near plane needless.
//!
//! A row is kept in cells of [`CELL`] pixels, each with the farthest depth drawn in it once it is
//! full: what lies behind is passed over without a look at its pixels (Greene, Kass and Miller 1993).

use depal_frames::Vector;

use crate::surface::Round;
use crate::view::{BAND, Drawable, FlatSpan, Grid, Outline, View};

/// Surface index of a pixel where nothing was drawn.
pub(crate) const EMPTY: u32 = u32::MAX;
/// Pixels of a cell.
const CELL: usize = 16;

/// What is known of the pixels of a cell without a look at them.
#[derive(Debug, Clone, Copy)]
struct Cell {
    /// No pixel has a smaller 1/z, once `drawn` is full.
    least: f32,
    /// No pixel has a greater 1/z; 0 = the cell holds no pixel of this picture yet.
    most: f32,
    /// Bit k: pixel k is drawn.
    drawn: u32,
    full: u32,
}

/// Scratch memory of a worker.
#[derive(Default)]
pub(crate) struct Cells(Vec<Cell>);

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
pub(crate) fn draw(view: &View, strip: &mut Strip, cells: &mut Cells) {
    let width = strip.width;
    let rows = strip.inverse_depth.len() / width.max(1);
    let cells_per_row = width.div_ceil(CELL);
    cells.0.clear();
    for _ in 0..rows {
        cells.0.extend((0..cells_per_row).map(|k| {
            let pixels = CELL.min(width - k * CELL);
            Cell {
                least: f32::INFINITY,
                most: 0.0,
                drawn: 0,
                full: (1 << pixels) - 1,
            }
        }));
    }
    let end_row = strip.first_row + rows;
    for band in strip.first_row / BAND..end_row.div_ceil(BAND) {
        let band_rows = (band * BAND).max(strip.first_row)..((band + 1) * BAND).min(end_row);
        for &index in view.band(band) {
            let drawable = &view.drawables[index as usize];
            let first = band_rows.start.max(drawable.rows.0 as usize);
            let end = band_rows.end.min(drawable.rows.1 as usize);
            for v in first..end {
                let k = v - strip.first_row;
                let mut row = Row {
                    first_column: strip.first_column,
                    inverse_depth: &mut strip.inverse_depth[k * width..(k + 1) * width],
                    surface: &mut strip.surface[k * width..(k + 1) * width],
                    cells: &mut cells.0[k * cells_per_row..(k + 1) * cells_per_row],
                };
                match &drawable.outline {
                    Outline::Flat(flat) => row.polygon(drawable, flat, v, index),
                    Outline::Round(round) => {
                        let round = &view.rounds[*round as usize];
                        row.round(&view.grid, drawable, round, v, index);
                    }
                }
            }
        }
    }
    for (k, cell) in cells.0.iter().enumerate() {
        if cell.most == 0.0 {
            let at = k / cells_per_row * width + k % cells_per_row * CELL;
            let end = at + cell.full.count_ones() as usize;
            strip.inverse_depth[at..end].fill(0.0);
            strip.surface[at..end].fill(EMPTY);
        }
    }
}

struct Row<'a> {
    first_column: i32,
    inverse_depth: &'a mut [f32],
    surface: &'a mut [u32],
    cells: &'a mut [Cell],
}

impl Row<'_> {
    /// The drawable's columns that the row holds: first and last.
    fn columns(&self, drawable: &Drawable) -> (f64, f64) {
        let end = self.first_column + self.inverse_depth.len() as i32;
        (
            f64::from(drawable.columns.0.max(self.first_column)),
            f64::from(drawable.columns.1.min(end) - 1),
        )
    }

    #[inline]
    fn polygon(&mut self, drawable: &Drawable, flat: &FlatSpan, v: usize, index: u32) {
        let (mut lo, mut hi) = self.columns(drawable);
        let y = v as f64;
        let (left, count) = (flat.left_sides as usize, flat.side_count as usize);
        for [a, b] in &flat.sides[..left] {
            lo = lo.max(a + b * y);
        }
        for [a, b] in &flat.sides[left..count] {
            hi = hi.min(a + b * y);
        }
        self.span(
            (lo, hi),
            flat.at_origin + flat.per_row * y,
            flat.per_column,
            index,
        );
    }

    /// Draws the whole columns of `lo..=hi`, which lie in the row, where 1/z = w0 + w1 u.
    #[inline]
    fn span(&mut self, (lo, hi): (f64, f64), w0: f64, w1: f64, index: u32) {
        // Within the row, so small; from its start on, so that cutting off is rounding down.
        let (lo, hi) = (
            lo - f64::from(self.first_column),
            hi - f64::from(self.first_column),
        );
        if lo.is_nan() || hi < lo {
            return;
        }
        let cut = lo as i32 as usize;
        let first = cut + usize::from((cut as f64) < lo);
        let end = hi as i32 as usize + 1;
        let w0 = w0 + w1 * f64::from(self.first_column);
        let mut at = first;
        while at < end {
            let cell = at / CELL;
            let start = cell * CELL;
            let stop = end.min(start + CELL);
            self.flat_cell(cell, (at - start, stop - start), w0, w1, index);
            at = stop;
        }
    }

    #[inline]
    fn flat_cell(&mut self, cell: usize, (from, to): (usize, usize), w0: f64, w1: f64, index: u32) {
        let start = cell * CELL;
        // Anchored where it is drawn, so that f32 is enough.
        let base = (w0 + w1 * (start + from) as i32 as f64) as f32;
        let slope = w1 as f32;
        let last = base + slope * ((to - from - 1) as i32 as f32);
        let (least, most) = if base < last {
            (base, last)
        } else {
            (last, base)
        };
        let state = &mut self.cells[cell];
        let all = state.drawn == state.full;
        if all && most <= state.least {
            return;
        }
        let bits = ((1_u32 << to) - 1) & !((1_u32 << from) - 1);
        let depths = &mut self.inverse_depth[start..];
        let surfaces = &mut self.surface[start..];
        let whole = bits == state.full;
        let blind = least > state.most;
        if state.most == 0.0 && !(whole && blind) {
            let pixels = state.full.count_ones() as usize;
            depths[..pixels].fill(0.0);
            surfaces[..pixels].fill(EMPTY);
        }
        if to - from == CELL {
            let (Some(depths), Some(surfaces)) = (
                depths.first_chunk_mut::<CELL>(),
                surfaces.first_chunk_mut::<CELL>(),
            ) else {
                return;
            };
            if blind {
                for k in 0..CELL {
                    depths[k] = base + slope * (k as i32 as f32);
                }
                surfaces.fill(index);
            } else {
                for k in 0..CELL {
                    let w = base + slope * (k as i32 as f32);
                    let nearer = w > depths[k];
                    depths[k] = if nearer { w } else { depths[k] };
                    surfaces[k] = if nearer { index } else { surfaces[k] };
                }
            }
        } else {
            let pixels = depths[from..to].iter_mut().zip(&mut surfaces[from..to]);
            for (k, (depth, surface)) in pixels.enumerate() {
                let w = base + slope * (k as i32 as f32);
                let nearer = w > *depth;
                *depth = if nearer { w } else { *depth };
                *surface = if nearer { index } else { *surface };
            }
        }
        state.most = state.most.max(most);
        state.least = match (whole, all) {
            (true, true) => state.least.max(least),
            (true, false) => least,
            (false, true) => state.least,
            (false, false) => state.least.min(least),
        };
        state.drawn |= bits;
    }

    fn round(&mut self, grid: &Grid, drawable: &Drawable, round: &Round, v: usize, index: u32) {
        let (first, last) = self.columns(drawable);
        if first > last {
            return;
        }
        let start = Vector::new(-grid.cx / grid.fx, (v as f64 - grid.cy) / grid.fy, 1.0);
        let step = 1.0 / grid.fx;
        match round {
            Round::Disk {
                normal,
                plane,
                centre,
                radius,
            } => {
                // Inside when |r - w c|^2 <= (R w)^2 with w = 1/z, affine in u.
                let inverse = normal / *plane;
                let (w0, w1) = (inverse.dot(&start), inverse.x * step);
                let (g0, g1) = (
                    start - centre * w0,
                    Vector::new(step, 0.0, 0.0) - centre * w1,
                );
                let r2 = radius * radius;
                let inside = Quadratic {
                    c0: r2 * w0 * w0 - g0.norm_squared(),
                    c1: 2.0 * (r2 * w0 * w1 - g0.dot(&g1)),
                    c2: r2 * w1 * w1 - g1.norm_squared(),
                };
                for span in inside.spans(first, last).into_iter().flatten() {
                    self.span(span, w0, w1, index);
                }
            }
            Round::Sphere { centre, radius } => {
                let curved = Curved {
                    b0: centre.dot(&start),
                    b1: centre.x * step,
                    a0: start.norm_squared(),
                    a1: start.x * step,
                    a2: step * step,
                    rest: centre.norm_squared() - radius * radius,
                };
                let anywhere = Slab {
                    s0: 0.0,
                    s1: 0.0,
                    along: 0.0,
                    half_length: f64::INFINITY,
                };
                self.curved(&curved, &anywhere, (first, last), index);
            }
            Round::Mantle {
                centre,
                axis,
                half_length,
                radius,
            } => {
                let along = centre.dot(axis);
                let off_axis = centre - axis * along;
                let (s0, s1) = (start.dot(axis), axis.x * step);
                let curved = Curved {
                    b0: off_axis.dot(&start),
                    b1: off_axis.x * step,
                    a0: start.norm_squared() - s0 * s0,
                    a1: start.x * step - s0 * s1,
                    a2: step * step - s1 * s1,
                    rest: off_axis.norm_squared() - radius * radius,
                };
                let slab = Slab {
                    s0,
                    s1,
                    along,
                    half_length: *half_length,
                };
                self.curved(&curved, &slab, (first, last), index);
            }
        }
    }

    fn curved(&mut self, curved: &Curved, slab: &Slab, (first, last): (f64, f64), index: u32) {
        let root = curved.root();
        for (lo, hi) in root.spans(first, last).into_iter().flatten() {
            let mut at = lo - f64::from(self.first_column);
            let end = hi - f64::from(self.first_column) + 1.0;
            while at < end {
                let cell = at as usize / CELL;
                let start = (cell * CELL) as f64;
                let stop = end.min(start + CELL as f64);
                let from = (at - start) as usize;
                let to = (stop - start) as usize;
                let column = f64::from(self.first_column) + at;
                self.curved_cell(curved, &root, slab, cell, (from, to), column, index);
                at = stop;
            }
        }
    }

    fn curved_cell(
        &mut self,
        curved: &Curved,
        root: &Quadratic,
        slab: &Slab,
        cell: usize,
        (from, to): (usize, usize),
        column: f64,
        index: u32,
    ) {
        let start = cell * CELL;
        let scale = 1.0 / curved.rest;
        let (b0, b1) = (
            ((curved.b0 + curved.b1 * column) * scale) as f32,
            (curved.b1 * scale) as f32,
        );
        // The discriminant from this column on: small near the outline, so f64 until the root.
        let (q0, q1, q2) = (
            root.at(column),
            2.0 * root.c2 * column + root.c1,
            root.c2,
        );
        let square = scale * scale;
        let (q0, q1, q2) = (q0 * square, q1 * square, q2 * square);
        let mut values = [0.0_f32; CELL];
        for (k, w) in values[..to - from].iter_mut().enumerate() {
            let x = k as i32 as f64;
            let discriminant = ((q2 * x + q1) * x + q0) as f32;
            *w = b0 + b1 * (x as f32) + discriminant.max(0.0).sqrt();
        }
        if slab.half_length.is_finite() {
            let (s0, s1) = (slab.s0 + slab.s1 * column, slab.s1);
            // A micrometre more, so that no pixel is lost between mantle and cap.
            let half = slab.half_length + 1e-6;
            for (k, w) in values[..to - from].iter_mut().enumerate() {
                let beyond = (s0 + s1 * (k as i32 as f64) - f64::from(*w) * slab.along).abs()
                    - half * f64::from(*w);
                *w = if beyond <= 0.0 { *w } else { 0.0 };
            }
        }
        let state = &mut self.cells[cell];
        let depths = &mut self.inverse_depth[start..];
        let surfaces = &mut self.surface[start..];
        if state.most == 0.0 {
            let pixels = state.full.count_ones() as usize;
            depths[..pixels].fill(0.0);
            surfaces[..pixels].fill(EMPTY);
        }
        let pixels = depths[from..to].iter_mut().zip(&mut surfaces[from..to]);
        for (k, ((depth, surface), &w)) in pixels.zip(&values).enumerate() {
            if w > 0.0 {
                let nearer = w > *depth;
                *depth = if nearer { w } else { *depth };
                *surface = if nearer { index } else { *surface };
                state.most = state.most.max(w);
                if state.drawn != state.full {
                    state.least = state.least.min(w);
                }
                state.drawn |= 1 << (from + k);
            }
        }
    }
}

/// The part of a tube between its ends: |s0 + s1 u - w along| <= half_length w.
struct Slab {
    s0: f64,
    s1: f64,
    along: f64,
    half_length: f64,
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
