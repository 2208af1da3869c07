//! The intensity image: lens, noise, rounding.

use super::band::{LitRows, RowScratch, Sensor};
use crate::noise::normal;
use crate::raster::TILE;
use crate::row::{WIDE, chunk, chunk_mut, wide};

impl Sensor<'_> {
    /// Grey of a tile behind the lens, which blurs by 1-2-1 in both directions.
    #[inline(always)]
    pub(super) fn blur_grey(&self, v: usize, tile: usize, lit: &LitRows, row: &mut RowScratch) {
        let i = &self.rendering.intrinsics;
        let from = tile * TILE;
        let out = chunk_mut(&mut row.grey, from);
        let middle = lit.grey(v);
        if !self.spec.sensor.blur {
            *out = *chunk(middle, from);
            return;
        }
        // Beside the image its border goes on.
        let mut spare = [[0.0; WIDE]; 3];
        let [sa, sm, sb] = &mut spare;
        let (above, below) = (v.saturating_sub(1), (v + 1).min(i.height - 1));
        let a = wide(&lit.grey(above)[..i.width], from, sa);
        let m = wide(&middle[..i.width], from, sm);
        let b = wide(&lit.grey(below)[..i.width], from, sb);
        let mut blend = [0.0; WIDE];
        for k in 0..WIDE {
            blend[k] = 0.0625 * (a[k] + b[k]) + 0.125 * m[k];
        }
        for k in 0..TILE {
            out[k] = blend[k] + 2.0 * blend[k + 1] + blend[k + 2];
        }
    }

    /// Adds noise and rounds.
    #[inline(always)]
    pub(super) fn expose(&self, row: &RowScratch, out: &mut [u8]) {
        let noise = self.spec.sensor.intensity_noise as f32;
        let words = row.words[1].iter().zip(&row.words[2]);
        for ((value, grey), (a, b)) in out.iter_mut().zip(&row.grey).zip(words) {
            // Independent of either word alone, so of the depth noise and of the dropout.
            let word = a.rotate_left(9) ^ b;
            let grey = (grey + noise * normal(word)).clamp(0.0, 255.0);
            *value = rounded_byte(grey);
        }
    }
}

/// Nearest whole number of 0..=255, by pushing the fraction out of the mantissa.
#[inline(always)]
fn rounded_byte(x: f32) -> u8 {
    const SHIFT: f32 = 8_388_608.0; // 2^23
    (x + SHIFT).to_bits() as u8
}
