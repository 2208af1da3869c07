//! The intensity image: lens, noise, rounding.

use super::band::{LitRows, RowScratch, Sensor};
use crate::noise::normal;

impl Sensor<'_> {
    /// Grey of columns `from..to` behind the lens, which blurs by 1-2-1 in both directions.
    #[inline(always)]
    pub(super) fn blur_grey(
        &self,
        v: usize,
        (from, to): (usize, usize),
        lit: &LitRows,
        row: &mut RowScratch,
    ) {
        let i = &self.rendering.intrinsics;
        let middle = lit.grey(v);
        let out = &mut row.grey[from..to];
        if !self.spec.sensor.blur {
            out.copy_from_slice(&middle[from..to]);
            return;
        }
        let (first, end) = (from.saturating_sub(1), (to + 1).min(i.width));
        let above = &lit.grey(v.saturating_sub(1))[first..end];
        let below = &lit.grey((v + 1).min(i.height - 1))[first..end];
        let blend = &mut row.between[first..end];
        let rows = above.iter().zip(&middle[first..end]).zip(below);
        for (blend, ((a, m), b)) in blend.iter_mut().zip(rows) {
            *blend = 0.0625 * (a + b) + 0.125 * m;
        }
        // Beside the image its border goes on.
        let blend = &row.between[..i.width];
        let at = |u: usize| blend[u.min(i.width - 1)];
        let ends = |u: usize| at(u.saturating_sub(1)) + 2.0 * at(u) + at(u + 1);
        out[0] = ends(from);
        out[to - from - 1] = ends(to - 1);
        if to - from > 2 {
            let inner = &mut out[1..to - from - 1];
            for (grey, near) in inner.iter_mut().zip(blend[from..to].windows(3)) {
                *grey = near[0] + 2.0 * near[1] + near[2];
            }
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
