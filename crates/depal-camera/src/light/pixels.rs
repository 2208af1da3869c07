//! Light on a tile pixel by pixel, whatever it shows.

use depal_frames::Vector;

use super::lamp::{Hit, pack};
use super::{Lighting, Patch};
use crate::raster::{EMPTY, TILE};
use crate::row::{choose, chunk, chunk_or, mask};
use crate::view::Face;

/// A tile's part of a row of lit pixels.
pub(crate) struct LitTile<'a> {
    /// Depth, metres; 0 where the sensor gets nothing for sure.
    pub depth: &'a mut [f32; TILE],
    /// Deviation and chance, see [`unpack`](super::unpack).
    pub packed: &'a mut [u32; TILE],
    /// Grey value before lens and noise.
    pub grey: &'a mut [f32; TILE],
}

/// On what a pixel lies.
#[derive(Clone, Copy)]
struct Surface {
    /// Index into the lamps, or [`EMPTY`].
    lamp: u32,
    /// Index into the view's rounds, or [`Face::FLAT`].
    round: u32,
    /// How far its plane lies before the camera and before the projector, metres.
    before: (f32, f32),
}

impl Lighting<'_> {
    /// Lights a tile in image row `v`; bit k of `shade`: the projector does not reach pixel k.
    #[inline(always)]
    pub fn pixels(&self, v: usize, tile: usize, shade: u16, out: &mut LitTile) {
        let r = self.rendering;
        let width = r.intrinsics.width;
        let row = v * width..(v + 1) * width;
        let surface = chunk_or(&r.surface[row.clone()], tile * TILE, EMPTY);
        let w = chunk_or(&r.inverse_depth[row], tile * TILE, 0.0);
        let x = chunk(&self.columns, tile * TILE);
        let y = self.y(v);
        let yy = y * y + 1.0;
        let (mut k, mut c1, mut lamps) = ([0.0; TILE], [0.0; TILE], [EMPTY; TILE]);
        let mut there = self.surface(surface[0]);
        // Every lamp once.
        let (mut distinct, mut count) = ([there.lamp; TILE], usize::from(there.lamp != EMPTY));
        let mut others = 0;
        for n in 0..TILE {
            others |= surface[n] ^ surface[0];
        }
        let one = (others == 0) & (there.round == Face::FLAT);
        if one {
            (k, c1) = ([there.before.0; TILE], [there.before.1; TILE]);
            lamps = [there.lamp; TILE];
        }
        for n in 0..if one { 0 } else { TILE } {
            if n > 0 && surface[n] != surface[n - 1] {
                there = self.surface(surface[n]);
                let known = there.lamp == EMPTY || distinct[..count].contains(&there.lamp);
                if !known {
                    distinct[count] = there.lamp;
                    count += 1;
                }
            }
            if there.round != Face::FLAT {
                there.before = self.before_round(there.round, w[n], x[n], y);
            }
            lamps[n] = there.lamp;
            (k[n], c1[n]) = there.before;
        }
        // What is hidden is dark below, whatever shines.
        let all_hidden = shade == u16::MAX;
        // Arrays of their own: of the buffers the compiler does not know that they are not the lamp's.
        let (mut depth, mut packed, mut grey) = ([0.0; TILE], [0; TILE], [0.0; TILE]);
        for &own in &distinct[..if all_hidden { 0 } else { count }] {
            let lamp = self.lamps[own as usize];
            for n in 0..TILE {
                let (w, x, k, c1) = (w[n], x[n], k[n], c1[n]);
                let mut lit = lamp.shine(Hit { w, x, yy, k, c1 });
                let word = pack(lit.sigma, lamp.take_grazing(&mut lit));
                let same = lamps[n] == own;
                depth[n] = if same { lit.depth } else { depth[n] };
                packed[n] = if same { word } else { packed[n] };
                grey[n] = if same { lit.grey } else { grey[n] };
            }
            if lamp.gloss > 0.0 {
                for n in (0..TILE).filter(|n| lamps[*n] == own) {
                    let (w, x, k, c1) = (w[n], x[n], k[n], c1[n]);
                    if lamp.is_over_exposed(Hit { w, x, yy, k, c1 }) {
                        if !self.spec.sensor.hdr {
                            depth[n] = 0.0;
                        }
                        grey[n] += 255.0 * lamp.gloss;
                    }
                }
            }
        }
        if shade != 0 {
            let (mut ambient, mut hidden) = ([0_u32; TILE], [0; TILE]);
            for own in &distinct[..count] {
                let level = self.lamps[*own as usize].ambient_grey.to_bits();
                for n in 0..TILE {
                    ambient[n] |= level & mask(lamps[n] == *own);
                }
            }
            for n in 0..TILE {
                hidden[n] = mask(u32::from(shade) & (1 << n) != 0);
            }
            for n in 0..TILE {
                depth[n] = f32::from_bits(depth[n].to_bits() & !hidden[n]);
                grey[n] = f32::from_bits(choose(hidden[n], ambient[n], grey[n].to_bits()));
            }
        }
        (*out.depth, *out.packed, *out.grey) = (depth, packed, grey);
    }

    /// Lights row `r` of a smooth tile, which is image row `v`, for the eyes of its neighbours.
    #[inline(always)]
    pub fn patch_pixels(
        &self,
        (v, r): (usize, usize),
        tile: usize,
        patch: &Patch,
        out: &mut LitTile,
    ) {
        let width = self.rendering.intrinsics.width;
        let w = chunk(&self.rendering.inverse_depth, v * width + tile * TILE);
        let ((s0, s1), (g0, g1)) = patch.row(r);
        let (keep, mut depth, mut packed, mut grey) =
            (patch.keep, [0.0; TILE], [0; TILE], [0.0; TILE]);
        for n in 0..TILE {
            let t = n as i32 as f32;
            depth[n] = 1.0 / w[n];
            packed[n] = pack(s0 + s1 * t, keep);
            grey[n] = g0 + g1 * t;
        }
        (*out.depth, *out.packed, *out.grey) = (depth, packed, grey);
    }

    #[inline(always)]
    fn surface(&self, index: u32) -> Surface {
        if index == EMPTY {
            return Surface {
                lamp: EMPTY,
                round: Face::FLAT,
                before: (0.0, 0.0),
            };
        }
        let face = &self.rendering.view.faces[index as usize];
        Surface {
            lamp: self.lamp_of_solid[face.solid as usize],
            round: face.round,
            before: self.before(face),
        }
    }

    /// As [`Surface::before`], for the plane that touches a round surface at a pixel.
    #[inline(always)]
    fn before_round(&self, round: u32, w: f32, x: f32, y: f32) -> (f32, f32) {
        let point = Vector::new(f64::from(x), f64::from(y), 1.0) / f64::from(w);
        let normal = self.rendering.view.rounds[round as usize].normal_at(&point);
        let k = -normal.dot(&point) as f32;
        (k, (normal.x * self.spec.baseline) as f32 + k)
    }
}
