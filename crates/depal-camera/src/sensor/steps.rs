//! Depth steps: some pixels there are lost and some land between both surfaces.

use super::band::{RowScratch, Sensor};
use crate::raster::TILE;

impl Sensor<'_> {
    /// Takes and moves pixels at the steps in columns `from..to`, which start with a tile.
    #[inline(always)]
    pub(super) fn blur_steps(&self, v: usize, (from, to): (usize, usize), row: &mut RowScratch) {
        let s = &self.spec.sensor;
        if s.edge_dropout + s.mixed_pixels <= 0.0 {
            return;
        }
        self.mark_borders(v, (from, to), row);
        let dropout = (s.edge_dropout * 4_294_967_296.0) as u64;
        let mixed = (s.mixed_pixels * 4_294_967_296.0) as u64;
        let width = self.rendering.intrinsics.width;
        for first in (from..to).step_by(TILE) {
            let count = TILE.min(to - first);
            let marks = &row.border[first..first + count];
            if marks.iter().fold(0, |all, mark| all | mark) == 0 {
                continue;
            }
            let mut at_step = self.steps(first, count, v);
            for (k, mark) in marks.iter().enumerate() {
                at_step &= !(u32::from(*mark == 0) << k);
            }
            while at_step != 0 {
                let u = first + at_step.trailing_zeros() as usize;
                at_step &= at_step - 1;
                if row.depth[u] == 0.0 {
                    continue;
                }
                let chance = self.step_noise.word((v * width + u) as u64) >> 32;
                if chance < dropout {
                    row.depth[u] = 0.0;
                } else if chance < dropout + mixed {
                    let (nearest, farthest) = self.depth_range(u, v);
                    row.depth[u] = 0.5 * (nearest + farthest);
                }
            }
        }
    }

    /// Bit k: pixel k from column `first` on has a depth step or nothing within 3x3.
    #[inline(always)]
    fn steps(&self, first: usize, count: usize, v: usize) -> u32 {
        /// A tile and one more pixel on each side.
        const WIDE: usize = TILE + 2;
        let i = &self.rendering.intrinsics;
        let step = self.spec.sensor.step as f32;
        let rows = [v.saturating_sub(1), v, (v + 1).min(i.height - 1)]
            .map(|v| &self.rendering.inverse_depth[v * i.width..(v + 1) * i.width]);
        let mut windows = [[0.0_f32; WIDE]; 3];
        if first > 0 && first + TILE < i.width {
            for (window, row) in windows.iter_mut().zip(rows) {
                window.copy_from_slice(&row[first - 1..][..WIDE]);
            }
        } else {
            for (window, row) in windows.iter_mut().zip(rows) {
                for (k, w) in window.iter_mut().enumerate() {
                    *w = row[(first + k).clamp(1, i.width.min(first + count)) - 1];
                }
            }
        }
        let least = |a: f32, b: f32| if a < b { a } else { b };
        let most = |a: f32, b: f32| if a > b { a } else { b };
        let (mut low, mut high) = ([0.0_f32; WIDE], [0.0_f32; WIDE]);
        for k in 0..WIDE {
            let [a, b, c] = [windows[0][k], windows[1][k], windows[2][k]];
            low[k] = least(least(a, b), c);
            high[k] = most(most(a, b), c);
        }
        let mut steps = 0;
        for k in 0..TILE {
            let low = least(least(low[k], low[k + 1]), low[k + 2]);
            let high = most(most(high[k], high[k + 1]), high[k + 2]);
            // 1/low - 1/high > step, without the divisions; 1/z = 0 is nothing.
            let far_apart = (low <= 0.0) | (high - low > step * low * high);
            steps |= u32::from(far_apart) << k;
        }
        steps
    }

    /// Marks the pixels of columns `from..to` with more than one surface within 3x3.
    #[inline(always)]
    fn mark_borders(&self, v: usize, (from, to): (usize, usize), row: &mut RowScratch) {
        let i = &self.rendering.intrinsics;
        let (first, end) = (from.saturating_sub(1), (to + 1).min(i.width));
        let surfaces = |v: usize| &self.rendering.surface[v * i.width..(v + 1) * i.width];
        let middle = surfaces(v);
        let above = &surfaces(v.saturating_sub(1))[first..end];
        let below = &surfaces((v + 1).min(i.height - 1))[first..end];
        // Bit 0: the next pixel is another surface; bit 1: one above or below is. One more at each end.
        let turns = &mut row.turns[first + 1..=end];
        let rows = middle[first..end].iter().zip(above).zip(below);
        for (mark, ((m, a), b)) in turns.iter_mut().zip(rows) {
            *mark = u8::from((a ^ m) | (b ^ m) != 0) * 2;
        }
        for (mark, pair) in turns.iter_mut().zip(middle[first..].windows(2)) {
            *mark |= u8::from(pair[0] != pair[1]);
        }
        let (before, here, after) = (
            &row.turns[from..to],
            &row.turns[from + 1..=to],
            &row.turns[from + 2..to + 2],
        );
        let border = &mut row.border[from..to];
        for (((mark, before), here), after) in border.iter_mut().zip(before).zip(here).zip(after) {
            *mark = before | here | (after & 2);
        }
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
