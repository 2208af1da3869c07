//! Tiles of a single flat face, lit throughout and seen squarely.

use super::Lighting;
use super::lamp::Hit;
use crate::raster::{MIXED, TILE};
use crate::view::{BAND, Face};

/// A value over a tile: at its first pixel, per column, per row, and per column and row. It is right at
/// the corners and straight in between, which is right to (16 / f)^2 / 8 of the values that light takes.
pub(crate) type Bilinear = [f32; 4];

/// From the corners of a tile: first, right, below, both.
#[inline(always)]
fn bilinear([a, b, c, d]: [f32; 4]) -> Bilinear {
    let (across, down) = (1.0 / TILE as f32, 1.0 / BAND as f32);
    [
        a,
        (b - a) * across,
        (c - a) * down,
        ((d - c) - (b - a)) * (across * down),
    ]
}

/// All that the sensor must know of a tile apart from 1/z. Its neighbours within the sensor's reach show
/// the same face, so jitter, lens and steps need no look at them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Patch {
    /// False: the tile is not of this kind, and the rest of no meaning.
    pub smooth: bool,
    /// The tile and what the sensor may look at around it show one face, whatever its light.
    pub one_face: bool,
    /// Chance to be kept, 0..=4095.
    pub keep: u32,
    /// Change of 1/z from column to column and from row to row, 1/m.
    pub slope: [f32; 2],
    /// Deviation of the axial noise, metres.
    pub sigma: Bilinear,
    /// Grey value before noise.
    pub grey: Bilinear,
}

impl Patch {
    pub const ROUGH: Self = Self {
        smooth: false,
        one_face: false,
        keep: 0,
        slope: [0.0; 2],
        sigma: [0.0; 4],
        grey: [0.0; 4],
    };

    /// Deviation and grey at the first pixel of row `r`, and their change per pixel.
    #[inline(always)]
    pub fn row(&self, r: usize) -> ((f32, f32), (f32, f32)) {
        let down = r as i32 as f32;
        let line = |[a, b, c, d]: [f32; 4]| (a + c * down, b + d * down);
        (line(self.sigma), line(self.grey))
    }
}

impl Lighting<'_> {
    /// The patch of a tile; it is not smooth when it is not of that kind, or when a shadow reaches it.
    #[inline(always)]
    pub(super) fn patch(&self, column: usize, band: usize, margin: usize, reached: bool) -> Patch {
        let r = self.rendering;
        let index = r.tiles[band * r.intrinsics.width.div_ceil(TILE) + column].face;
        if index == MIXED || !self.is_one_face(index, column, band, margin) {
            return Patch::ROUGH;
        }
        let rough = Patch {
            one_face: true,
            ..Patch::ROUGH
        };
        let face = &r.view.faces[index as usize];
        if !reached || face.round != Face::FLAT {
            return rough;
        }
        let lamp = &self.lamps[self.lamp_of_solid[face.solid as usize] as usize];
        let (k, c1) = self.before(face);
        let i = &r.intrinsics;
        let [nx, ny, nz] = face.normal;
        let slope = [-nx / (k * i.fx as f32), -ny / (k * i.fy as f32)];
        let x0 = self.columns[column * TILE];
        let y0 = self.y(band * BAND);
        let (x1, y1) = (
            x0 + TILE as f32 / i.fx as f32,
            y0 + BAND as f32 / i.fy as f32,
        );
        let (x, y) = ([x0, x1, x0, x1], [y0, y0, y1, y1]);
        let (mut sigma, mut grey, mut good) = ([0.0; 4], [0.0; 4], true);
        for n in 0..4 {
            let w = -(nx * x[n] + ny * y[n] + nz) / k;
            let (x, yy) = (x[n], y[n] * y[n] + 1.0);
            let lit = lamp.shine(Hit { w, x, yy, k, c1 });
            (sigma[n], grey[n]) = (lit.sigma, lit.grey);
            good &= (lit.depth > 0.0) & lamp.is_plain(&lit);
        }
        if !good {
            return rough;
        }
        Patch {
            smooth: true,
            one_face: true,
            keep: lamp.keep,
            slope,
            sigma: bilinear(sigma),
            grey: bilinear(grey),
        }
    }

    /// Whether the pixels around a tile show the same face as the tile.
    #[inline(always)]
    fn is_one_face(&self, index: u32, column: usize, band: usize, margin: usize) -> bool {
        let r = self.rendering;
        let (width, height) = (r.intrinsics.width, r.intrinsics.height);
        let (columns, bands) = (width.div_ceil(TILE), height.div_ceil(BAND));
        let (left, right) = (column * TILE, (column + 1) * TILE);
        let (top, bottom) = (band * BAND, (band + 1) * BAND);
        // Most often the tiles around are known to show nothing else.
        for b in band.saturating_sub(1)..(band + 2).min(bands) {
            for c in column.saturating_sub(1)..(column + 2).min(columns) {
                if r.tiles[b * columns + c].face == index {
                    continue;
                }
                let from = (c * TILE).max(left.saturating_sub(margin));
                let to = ((c + 1) * TILE).min(right + margin).min(width);
                let first = (b * BAND).max(top.saturating_sub(margin));
                let end = ((b + 1) * BAND).min(bottom + margin).min(height);
                for v in first..end {
                    let row = &r.surface[v * width + from..v * width + to];
                    if row.iter().any(|surface| *surface != index) {
                        return false;
                    }
                }
            }
        }
        true
    }
}
