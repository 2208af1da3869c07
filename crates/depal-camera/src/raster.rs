//! Draws surfaces into one image row: 1/z and surface index, the nearest wins.
//!
//! A row is `r(u) = start + u * step` with Z = 1. On it, 1/z of a plane is affine in u and the
//! outline of a sphere, a cylinder or a disk is the sign of a quadratic in u, so spans come from
//! closed forms in f64. Edges are tested as planes through the eye (homogeneous edge functions,
//! Olano and Greer 1997), which makes clipping at the near plane needless.

use depal_frames::Vector;

use crate::surface::{Surface, SurfaceKind};

/// Surface index of a pixel where nothing was drawn.
pub(crate) const EMPTY: u32 = u32::MAX;

/// The pixel grid of a view: column u looks along x = (u - cx) / fx.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Grid {
    pub width: usize,
    pub fx: f64,
    pub fy: f64,
    pub cx: f64,
    pub cy: f64,
}

impl Grid {
    /// Rows (first, last) out of `height` that a tangent range can touch; None when it touches none.
    pub fn rows(&self, y: [f64; 2], height: usize) -> Option<(usize, usize)> {
        whole_span(y[0] * self.fy + self.cy, y[1] * self.fy + self.cy, height)
    }

    fn columns(&self, x: [f64; 2]) -> Option<(usize, usize)> {
        // One column of slack: bounds and outlines round differently.
        whole_span(
            x[0] * self.fx + self.cx - 1.0,
            x[1] * self.fx + self.cx + 1.0,
            self.width,
        )
    }
}

/// Integers of `lo..=hi` within `0..count`.
fn whole_span(lo: f64, hi: f64, count: usize) -> Option<(usize, usize)> {
    let first = lo.ceil().max(0.0);
    let last = hi.floor().min(count as f64 - 1.0);
    (first <= last).then_some((first as usize, last as usize))
}

/// One row of a view.
pub(crate) struct Row<'a> {
    /// 1/z of the nearest surface, 1/m; 0 = nothing.
    pub inverse_depth: &'a mut [f32],
    /// Its index.
    pub surface: &'a mut [u32],
}

/// Draws one surface into row `v`.
pub(crate) fn draw_row(row: &mut Row, grid: &Grid, v: usize, index: u32, surface: &Surface) {
    let Some((first, last)) = grid.columns(surface.bounds.x) else {
        return;
    };
    let start = Vector::new(-grid.cx / grid.fx, (v as f64 - grid.cy) / grid.fy, 1.0);
    let step = 1.0 / grid.fx;
    match &surface.kind {
        SurfaceKind::Quad {
            inverse_depth,
            edges,
            ..
        } => {
            let (mut lo, mut hi) = (first as f64, last as f64);
            for edge in edges {
                let (value, slope) = (edge.dot(&start), edge.x * step);
                if slope > 0.0 {
                    lo = lo.max((-value / slope).ceil());
                } else if slope < 0.0 {
                    hi = hi.min((-value / slope).floor());
                } else if value < 0.0 {
                    return;
                }
            }
            if lo <= hi {
                fill_plane(
                    row,
                    (lo as usize, hi as usize),
                    inverse_depth.dot(&start),
                    inverse_depth.x * step,
                    index,
                );
            }
        }
        SurfaceKind::Disk {
            inverse_depth,
            centre,
            radius,
            ..
        } => {
            // Inside when |r - w c|^2 <= (R w)^2 with w = 1/z, affine in u.
            let (w0, w1) = (inverse_depth.dot(&start), inverse_depth.x * step);
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
                fill_plane(row, span, w0, w1, index);
            }
        }
        SurfaceKind::Sphere { centre, radius } => {
            let rest = centre.norm_squared() - radius * radius;
            let round = Round {
                b0: centre.dot(&start),
                b1: centre.x * step,
                a0: start.norm_squared(),
                a1: start.x * step,
                a2: step * step,
                rest,
            };
            round.fill(row, (first, last), index, |_, _| true);
        }
        SurfaceKind::Mantle {
            centre,
            axis,
            half_length,
            radius,
        } => {
            let along = centre.dot(axis);
            let off_axis = centre - axis * along;
            let (s0, s1) = (start.dot(axis), axis.x * step);
            let round = Round {
                b0: off_axis.dot(&start),
                b1: off_axis.x * step,
                a0: start.norm_squared() - s0 * s0,
                a1: start.x * step - s0 * s1,
                a2: step * step - s1 * s1,
                rest: off_axis.norm_squared() - radius * radius,
            };
            round.fill(row, (first, last), index, |x, w| {
                (s0 + s1 * x - w * along).abs() <= half_length * w
            });
        }
    }
}

/// A sphere or cylinder along a row: a z^2 - 2 b z + rest = 0, so that the nearer root has
/// 1/z = (b + sqrt(b^2 - a rest)) / rest. `rest` > 0: the eye is outside.
struct Round {
    a0: f64,
    a1: f64,
    a2: f64,
    b0: f64,
    b1: f64,
    rest: f64,
}

impl Round {
    fn fill(
        &self,
        row: &mut Row,
        (first, last): (usize, usize),
        index: u32,
        holds: impl Fn(f64, f64) -> bool,
    ) {
        let root = Quadratic {
            c0: self.b0 * self.b0 - self.a0 * self.rest,
            c1: 2.0 * (self.b0 * self.b1 - self.a1 * self.rest),
            c2: self.b1 * self.b1 - self.a2 * self.rest,
        };
        let scale = 1.0 / self.rest;
        for (lo, hi) in root.spans(first, last).into_iter().flatten() {
            let depths = &mut row.inverse_depth[lo..=hi];
            let surfaces = &mut row.surface[lo..=hi];
            for (k, (depth, surface)) in depths.iter_mut().zip(surfaces).enumerate() {
                let x = (lo + k) as f64;
                let w = (self.b0 + self.b1 * x + root.at(x).max(0.0).sqrt()) * scale;
                if w as f32 > *depth && holds(x, w) {
                    *depth = w as f32;
                    *surface = index;
                }
            }
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

    /// Columns of `first..=last` where it is not negative: at most two spans.
    fn spans(&self, first: usize, last: usize) -> [Option<(usize, usize)>; 2] {
        let cut = |lo: f64, hi: f64| {
            let (lo, hi) = (lo.ceil().max(first as f64), hi.floor().min(last as f64));
            (lo <= hi).then_some((lo as usize, hi as usize))
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

/// Fills a span with 1/z = w0 + w1 u. The span's start anchors the f32 arithmetic.
fn fill_plane(row: &mut Row, (lo, hi): (usize, usize), w0: f64, w1: f64, index: u32) {
    let base = (w0 + w1 * lo as f64) as f32;
    let slope = w1 as f32;
    let depths = &mut row.inverse_depth[lo..=hi];
    let surfaces = &mut row.surface[lo..=hi];
    for (k, (depth, surface)) in depths.iter_mut().zip(surfaces).enumerate() {
        let w = base + slope * (k as i32 as f32);
        let nearer = w > *depth;
        *depth = if nearer { w } else { *depth };
        *surface = if nearer { index } else { *surface };
    }
}
