//! Rounded edges and corners of boxes, pixel by pixel.

use depal_frames::Vector;

use super::flat::Spans;
use super::{Surface, TILE, Target};
use crate::view::{Drawable, Outline, Rim, View};

/// Along one row: 1/z of the sharp face, and rays in the box's frame; value at column 0 and change per column.
struct Row {
    sharp: (f64, f64),
    ray: (Vector, Vector),
}

impl Target<'_> {
    #[inline(always)]
    pub(super) fn rim(&mut self, view: &View, drawable: &Drawable, rim: &Rim, surface: &Surface) {
        let Some(columns) = self.columns(drawable, surface) else {
            return;
        };
        let whole = self.sides(drawable, &rim.whole, columns);
        // The same spans as when it is drawn, so that every pixel belongs to one of both.
        let mut flat = Spans::NONE;
        if let Some(index) = rim.flat {
            let drawable = &view.drawables[index as usize];
            if let (Outline::Flat(span), Some((first, last))) =
                (&drawable.outline, self.held(drawable))
            {
                flat = self.sides(drawable, span, (f64::from(first), f64::from(last)));
            }
        }
        let grid = &view.grid;
        let across = rim.rounded.turned(&Vector::new(1.0 / grid.fx, 0.0, 0.0));
        for r in 0..self.rows {
            let (from, to) = (whole.from[r], whole.to[r]);
            if from >= to {
                continue;
            }
            let y = ((self.first_row + r) as f64 - grid.cy) / grid.fy;
            let start = Vector::new(-grid.cx / grid.fx, y, 1.0);
            let row = Row {
                sharp: (
                    rim.whole.at_origin + rim.whole.per_row * (self.first_row + r) as f64,
                    rim.whole.per_column,
                ),
                ray: (rim.rounded.turned(&start), across),
            };
            if flat.from[r] >= flat.to[r] {
                self.rim_row(r, (from, to), &row, rim, surface);
            } else {
                self.rim_row(r, (from, to.min(flat.from[r])), &row, rim, surface);
                self.rim_row(r, (from.max(flat.to[r]), to), &row, rim, surface);
            }
        }
    }

    /// Columns `from..to` of row `r`.
    #[inline(always)]
    fn rim_row(
        &mut self,
        r: usize,
        (from, to): (i32, i32),
        row: &Row,
        rim: &Rim,
        surface: &Surface,
    ) {
        let full = self.full_tile();
        let mut at = from;
        while at < to {
            let tile = at as usize / TILE;
            let stop = to.min(((tile + 1) * TILE) as i32);
            if !self.tiles[tile].hides(surface.most, surface.solid, full) {
                self.rim_part(r, (at as usize, stop as usize), row, rim, surface);
            }
            at = stop;
        }
    }

    /// Pixels `from..to` of row `r`, which lie in one tile.
    #[inline(always)]
    fn rim_part(
        &mut self,
        r: usize,
        (from, to): (usize, usize),
        row: &Row,
        rim: &Rim,
        surface: &Surface,
    ) {
        let tile = from / TILE;
        let start = r * self.width;
        let unseen = self.tiles[tile].seen.most == 0.0;
        let (mut values, mut any) = ([0.0_f32; TILE], false);
        for (k, value) in values[..to - from].iter_mut().enumerate() {
            let column = f64::from(self.first_column + (from + k) as i32);
            let sharp = row.sharp.0 + row.sharp.1 * column;
            // Nothing of the box is nearer than the sharp one's face.
            let hidden = !unseen && self.inverse_depth[start + from + k] >= sharp as f32;
            if hidden || sharp <= 0.0 {
                continue;
            }
            let ray = row.ray.0 + row.ray.1 * column;
            if let Some(w) = rim.rounded.meet(&ray, sharp) {
                *value = w as f32;
                any = true;
            }
        }
        if !any {
            return;
        }
        self.clear_if_unseen(tile);
        let full = self.full_tile();
        let state = &mut self.tiles[tile];
        state.mix(surface.solid);
        for (k, &w) in values[..to - from].iter().enumerate() {
            let at = start + from + k;
            if w <= 0.0 {
                continue;
            }
            if w > self.inverse_depth[at] {
                self.inverse_depth[at] = w;
                self.surface[at] = surface.index;
            }
            state.seen.most = state.seen.most.max(w);
            if state.drawn != full {
                state.seen.least = state.seen.least.min(w);
            }
            state.drawn |= 1 << (TILE * r + from % TILE + k);
        }
    }
}
