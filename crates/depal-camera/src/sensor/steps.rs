//! Depth steps: some pixels there are lost and some land between both surfaces.

use super::band::{RowScratch, Sensor};
use crate::raster::TILE;
use crate::row::{WIDE, wide};

impl Sensor<'_> {
    /// Takes and moves pixels at the steps in a tile.
    #[inline(always)]
    pub(super) fn blur_steps(&self, v: usize, tile: usize, row: &mut RowScratch) {
        let s = &self.spec.sensor;
        if s.edge_dropout + s.mixed_pixels <= 0.0 {
            return;
        }
        let dropout = (s.edge_dropout * 4_294_967_296.0) as u64;
        let mixed = (s.mixed_pixels * 4_294_967_296.0) as u64;
        let width = self.rendering.intrinsics.width;
        let mut at_step = self.steps(v, tile * TILE);
        while at_step != 0 {
            let u = tile * TILE + at_step.trailing_zeros() as usize;
            at_step &= at_step - 1;
            if row.depth[u] == 0.0 {
                continue;
            }
            let word = self.step_noise.word((v * width + u) as u64);
            let chance = word >> 32;
            if chance < dropout {
                row.depth[u] = 0.0;
            } else if chance < dropout + mixed {
                let (nearest, farthest) = self.depth_range(u, v);
                // The lower half of the word is independent of the upper one.
                let weight = (word as u32 >> 8) as f32 * (1.0 / 16_777_216.0);
                row.depth[u] = farthest + weight * (nearest - farthest);
            }
        }
    }

    /// Bit k: within 3x3 around the pixel k from column `from` on lie several surfaces, and a depth step
    /// or nothing.
    #[inline(always)]
    fn steps(&self, v: usize, from: usize) -> u32 {
        let r = self.rendering;
        let i = &r.intrinsics;
        let (above, below) = (v.saturating_sub(1), (v + 1).min(i.height - 1));
        let mut spare = [[0; WIDE]; 3];
        let [sa, sm, sb] = &mut spare;
        let surfaces = |v: usize| &r.surface[v * i.width..(v + 1) * i.width];
        let a = wide(surfaces(above), from, sa);
        let m = wide(surfaces(v), from, sm);
        let b = wide(surfaces(below), from, sb);
        // Pixel k is the middle one of k..k + 3.
        let mut border = [0; TILE];
        for row in [a, m, b] {
            for beside in 0..3 {
                for k in 0..TILE {
                    border[k] |= row[k + beside] ^ m[k + 1];
                }
            }
        }
        if border.iter().fold(0, |any, other| any | other) == 0 {
            return 0;
        }
        let mut spare = [[0.0; WIDE]; 3];
        let [sa, sm, sb] = &mut spare;
        let depths = |v: usize| &r.inverse_depth[v * i.width..(v + 1) * i.width];
        let a = wide(depths(above), from, sa);
        let m = wide(depths(v), from, sm);
        let b = wide(depths(below), from, sb);
        let least = |a: f32, b: f32| if a < b { a } else { b };
        let most = |a: f32, b: f32| if a > b { a } else { b };
        let (mut lows, mut highs) = ([f32::INFINITY; TILE], [0.0_f32; TILE]);
        for row in [a, m, b] {
            for beside in 0..3 {
                for k in 0..TILE {
                    lows[k] = least(row[k + beside], lows[k]);
                    highs[k] = most(row[k + beside], highs[k]);
                }
            }
        }
        let step = self.spec.sensor.step as f32;
        let mut found = [0_u32; TILE];
        for k in 0..TILE {
            let (low, high) = (lows[k], highs[k]);
            // 1/low - 1/high > step, without the divisions; 1/z = 0 is nothing.
            let far_apart = (low <= 0.0) | (high - low > step * low * high);
            found[k] = u32::from(far_apart & (border[k] != 0)) << k;
        }
        let inside = u32::MAX >> (32 - (i.width - from).min(TILE));
        found.iter().fold(0, |all, bit| all | bit) & inside
    }

    /// Nearest and farthest depth within 3x3.
    #[inline(always)]
    fn depth_range(&self, u: usize, v: usize) -> (f32, f32) {
        let i = &self.rendering.intrinsics;
        let (mut low, mut high) = (f32::INFINITY, 0.0_f32);
        let (left, right) = (u.saturating_sub(1), (u + 1).min(i.width - 1));
        for y in v.saturating_sub(1)..=(v + 1).min(i.height - 1) {
            for w in &self.rendering.inverse_depth[y * i.width + left..=y * i.width + right] {
                if *w > 0.0 {
                    low = low.min(*w);
                    high = high.max(*w);
                }
            }
        }
        (1.0 / high, 1.0 / low)
    }
}
