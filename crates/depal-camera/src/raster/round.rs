//! Balls, tubes and round plates.

use depal_frames::Vector;

use super::flat::{Ramp, Spans};
use super::quadratic::Quadratic;
use super::{Surface, TILE, Target};
use crate::surface::Round;
use crate::view::{BAND, Drawable, Grid};

impl Target<'_> {
    #[inline(always)]
    pub(super) fn round(
        &mut self,
        grid: &Grid,
        drawable: &Drawable,
        round: &Round,
        surface: &Surface,
    ) {
        let Some((first, last)) = self.columns(drawable, surface) else {
            return;
        };
        let rows = self.rows_of(drawable);
        let step = 1.0 / grid.fx;
        let first_row = self.first_row;
        let ray = |r: usize| {
            let y = ((first_row + r) as f64 - grid.cy) / grid.fy;
            Vector::new(-grid.cx / grid.fx, y, 1.0)
        };
        match round {
            Round::Rounded(_) => {} // drawn as flat faces and their rims
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
                let (mut lo, mut hi) = ([[f64::INFINITY; BAND]; 2], [[0.0; BAND]; 2]);
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
                    for (part, span) in found.iter().enumerate() {
                        if let Some(span) = span {
                            (lo[part][r], hi[part][r]) = *span;
                        }
                    }
                }
                let ramp = Ramp {
                    corner: inverse.dot(&ray(0)) + w1 * f64::from(self.first_column),
                    per_column: w1,
                    per_row: inverse.y / grid.fy,
                };
                let origin = f64::from(self.first_column);
                for (lo, hi) in lo.iter().zip(&hi) {
                    let spans = Spans::within(lo, hi, origin, &rows);
                    self.flat(&spans, &ramp, surface);
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
                    self.curved(r, &curved, &Slab::EVERYWHERE, (first, last), surface);
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
                    self.curved(r, &curved, &slab, (first, last), surface);
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
        surface: &Surface,
    ) {
        let root = curved.root();
        let full = self.full_tile();
        for (lo, hi) in root.spans(first, last).into_iter().flatten() {
            // Not negative, so that cutting off is rounding down; the ends are whole.
            let origin = f64::from(self.first_column);
            let (from, to) = ((lo - origin) as i32, (hi - origin) as i32 + 1);
            let mut at = from as usize;
            while (at as i32) < to {
                let tile = at / TILE;
                let stop = (to as usize).min((tile + 1) * TILE);
                if !self.tiles[tile].hides(surface.most, surface.solid, full) {
                    self.curved_part(row, curved, &root, slab, (at, stop), surface);
                }
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
        surface: &Surface,
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
        self.clear_if_unseen(tile);
        let full = self.full_tile();
        let state = &mut self.tiles[tile];
        state.mix(surface.solid);
        let range = row * self.width + from..row * self.width + to;
        let depths = &mut self.inverse_depth[range.clone()];
        let pixels = depths.iter_mut().zip(&mut self.surface[range]);
        for (k, ((depth, shown), &w)) in pixels.zip(&values).enumerate() {
            if w > 0.0 {
                let nearer = w > *depth;
                *depth = if nearer { w } else { *depth };
                *shown = if nearer { surface.index } else { *shown };
                state.seen.most = state.seen.most.max(w);
                if state.drawn != full {
                    state.seen.least = state.seen.least.min(w);
                }
                state.drawn |= 1 << (TILE * row + from % TILE + k);
            }
        }
        state.seen.most = state.seen.most.max(f32::MIN_POSITIVE);
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
