//! Light along a row, surface by surface.

use depal_frames::Vector;

use super::Lighting;
use super::lamp::{Hit, Lamp, pack};
use crate::raster::EMPTY;
use crate::raster::TILE;
use crate::runs::run_length;
use crate::surface::Round;
use crate::view::Face;

/// Pixels from one node to the next.
const SPACING: usize = 16;
/// Nodes of a piece of a run; what is lit at once.
const NODES: usize = 16;
/// Longest piece of a run.
const PIECE: usize = (NODES - 1) * SPACING;

/// A row of lit pixels, or a part of one.
pub(crate) struct LitRow<'a> {
    /// Depth, metres; 0 where the sensor gets nothing for sure.
    pub depth: &'a mut [f32],
    /// Deviation and chance, see [`unpack`](super::unpack).
    pub packed: &'a mut [u32],
    /// Grey value before lens and noise.
    pub grey: &'a mut [f32],
}

impl LitRow<'_> {
    #[inline(always)]
    fn part(&mut self, from: usize, to: usize) -> LitRow<'_> {
        LitRow {
            depth: &mut self.depth[from..to],
            packed: &mut self.packed[from..to],
            grey: &mut self.grey[from..to],
        }
    }
}

/// A piece of a row on one surface.
#[derive(Clone, Copy)]
struct Piece<'a> {
    /// 1/z of each pixel, 1/m.
    w: &'a [f32],
    /// X of each pixel's ray.
    x: &'a [f32],
    /// y^2 + 1 of all rays.
    yy: f32,
}

impl Piece<'_> {
    #[inline(always)]
    fn part(&self, from: usize, to: usize) -> Self {
        Self {
            w: &self.w[from..to],
            x: &self.x[from..to],
            yy: self.yy,
        }
    }

    #[inline(always)]
    fn hit(&self, n: usize, (k, c1): (f32, f32)) -> Hit {
        Hit {
            w: self.w[n],
            x: self.x[n],
            yy: self.yy,
            k,
            c1,
        }
    }
}

impl Lighting<'_> {
    /// Lights pixels `from..to` of image row `v`, whose shadow is `shade`, in a row of full width.
    #[inline(always)]
    pub fn span(&self, v: usize, (from, to): (usize, usize), shade: &[u16], row: &mut LitRow) {
        let r = self.rendering;
        let width = r.intrinsics.width;
        let surface = &r.surface[v * width..(v + 1) * width];
        let y = self.y(v);
        let whole = Piece {
            w: &r.inverse_depth[v * width..(v + 1) * width],
            x: &self.columns,
            yy: y * y + 1.0,
        };
        let mut end = from;
        while end < to {
            let index = surface[end];
            let start = end;
            end += run_length(&surface[start..to]);
            let mut row = row.part(start, end);
            if index == EMPTY {
                row.depth.fill(0.0);
                row.packed.fill(0);
                row.grey.fill(0.0);
                continue;
            }
            let face = &r.view.faces[index as usize];
            let lamp = &self.lamps[face.solid as usize];
            let piece = whole.part(start, end);
            if face.round == Face::FLAT {
                self.flat(lamp, self.before(face), &piece, &mut row);
            } else {
                let round = &r.view.rounds[face.round as usize];
                self.round(lamp, round, y, &piece, &mut row);
            }
        }
        for tile in from / TILE..to.div_ceil(TILE) {
            let mut hidden = shade[tile];
            while hidden != 0 {
                let u = tile * TILE + hidden.trailing_zeros() as usize;
                hidden &= hidden - 1;
                let solid = r.view.faces[surface[u] as usize].solid;
                row.depth[u] = 0.0;
                row.grey[u] = self.lamps[solid as usize].ambient_grey;
            }
        }
    }

    #[inline(always)]
    fn round(&self, lamp: &Lamp, round: &Round, y: f32, piece: &Piece, row: &mut LitRow) {
        for n in 0..piece.w.len() {
            let ray = Vector::new(f64::from(piece.x[n]), f64::from(y), 1.0);
            let point = ray / f64::from(piece.w[n]);
            let normal = round.normal_at(&point);
            let k = -normal.dot(&point) as f32;
            let c1 = (normal.x * self.spec.baseline) as f32 + k;
            store(lamp, piece.hit(n, (k, c1)), n, row);
        }
    }

    #[inline(always)]
    fn flat(&self, lamp: &Lamp, before: (f32, f32), piece: &Piece, row: &mut LitRow) {
        let last = piece.w.len() - 1;
        let plain = [0, last].map(|n| lamp.is_plain(&lamp.shine(piece.hit(n, before))));
        if !(plain[0] & plain[1]) {
            for n in 0..=last {
                store(lamp, piece.hit(n, before), n, row);
            }
            return;
        }
        let mut from = 0;
        while from <= last {
            let to = (from + PIECE).min(last + 1);
            let mut row = row.part(from, to);
            lamp.shine_along(&piece.part(from, to), before, &mut row);
            from = to;
        }
    }
}

/// A pixel that may be over-exposed or seen at a grazing angle.
#[inline(always)]
fn store(lamp: &Lamp, hit: Hit, n: usize, row: &mut LitRow) {
    let mut lit = lamp.shine(hit);
    let keep = lamp.take_lost(hit, &mut lit);
    row.depth[n] = lit.depth;
    row.packed[n] = pack(lit.sigma, keep);
    row.grey[n] = lit.grey;
}

/// The values of nodes, and straight lines between them.
struct Line {
    values: [f32; NODES],
    /// Node of the last pixel may be nearer than the others.
    last: usize,
}

impl Line {
    /// Value at node `n` and change per pixel behind it.
    #[inline(always)]
    fn from(&self, n: usize) -> (f32, f32) {
        let span = ((n + 1) * SPACING).min(self.last) - n * SPACING;
        let slope = (self.values[n + 1] - self.values[n]) / span.max(1) as f32;
        (self.values[n], slope)
    }
}

impl Lamp {
    /// A plain piece of a row on a plane, not longer than [`PIECE`]. Deviation and grey are smooth along
    /// it: they are worked out at every 16th pixel and at the last one, and are straight in between, which
    /// is right to (16 / f)^2 / 8 of their value. The depth is that of each pixel.
    #[inline(always)]
    fn shine_along(&self, piece: &Piece, (k, c1): (f32, f32), row: &mut LitRow) {
        let last = piece.w.len() - 1;
        let spacing = if last < NODES { 1 } else { SPACING };
        let (mut w, mut x) = ([piece.w[last]; NODES], [piece.x[last]; NODES]);
        for n in 0..=last / spacing {
            (w[n], x[n]) = (piece.w[n * spacing], piece.x[n * spacing]);
        }
        let (mut depth, mut sigma, mut grey) = ([0.0_f32; NODES], [0.0; NODES], [0.0; NODES]);
        for n in 0..NODES {
            let yy = piece.yy;
            let (w, x) = (w[n], x[n]);
            let lit = self.shine(Hit { w, x, yy, k, c1 });
            (depth[n], sigma[n], grey[n]) = (lit.depth, lit.sigma, lit.grey);
        }
        if spacing == 1 {
            row.depth.copy_from_slice(&depth[..=last]);
            row.grey.copy_from_slice(&grey[..=last]);
            for (packed, sigma) in row.packed.iter_mut().zip(sigma) {
                *packed = pack(sigma, self.keep);
            }
            return;
        }
        // Range and cosines are least or greatest at the ends: what is seen at two nodes is seen
        // between them.
        if depth.contains(&0.0) {
            for n in 0..=last {
                store(self, piece.hit(n, (k, c1)), n, row);
            }
            return;
        }
        let sigma = Line {
            values: sigma,
            last,
        };
        let grey = Line { values: grey, last };
        for n in 0..=last / SPACING {
            let from = n * SPACING;
            let to = (from + SPACING).min(last + 1);
            let ((s0, s1), (g0, g1)) = (sigma.from(n), grey.from(n));
            let row = row.part(from, to);
            let pixels = row.depth.iter_mut().zip(row.packed).zip(row.grey);
            for (i, (((depth, packed), grey), w)) in pixels.zip(&piece.w[from..to]).enumerate() {
                let t = i as i32 as f32;
                *depth = 1.0 / *w;
                *packed = pack(s0 + s1 * t, self.keep);
                *grey = g0 + g1 * t;
            }
        }
    }
}
