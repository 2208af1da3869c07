//! Stage 7b: what shows that a carton ends at a side.

use std::ops::Range;

use crate::{
    beyond::beyond,
    breaks::{Breaks, ends_surface},
    gate::DepthImage,
    patch::{BLOCK, Patch},
    relief::{Fit, Relief},
    seams::SEEN_SEAM,
    search::{Candidate, side_edge},
    settle::start_frame,
    unknown::Unknown,
};

/// How far from where it is tried a side is looked for, cells.
pub const REACH: isize = 6;
/// How clearly a side shows that is all edge, in the least steps that count.
const EDGE: f64 = 20.0;

/// What shows that a carton ends at a side.
pub struct End {
    /// The line, in cells along the axis.
    pub line: isize,
    /// How clearly it shows, in the least steps that count; less than one for a neighbour alone.
    pub strength: f64,
}

/// A surface on which the sides of single cartons are looked for.
pub struct Shown<'a> {
    pub image: &'a DepthImage<'a>,
    pub patch: &'a Patch,
    /// How far a pixel may lie from its carton's plane, metres.
    pub tolerance: f64,
    pub relief: &'a Relief,
    pub breaks: &'a Breaks<'a>,
    pub unknown: &'a Unknown<'a>,
}

impl Shown<'_> {
    /// Where a carton ends close to a side of a candidate, if anything shows it.
    pub fn end(&self, c: &Candidate, side: usize, placed: &[Candidate]) -> Option<End> {
        /// With less of an edge a step tells better where it is.
        const PLAIN_EDGE: f64 = 0.3;
        let edge = self.edge(c, side);
        if edge
            .as_ref()
            .is_some_and(|e| e.strength >= EDGE * PLAIN_EDGE)
        {
            return edge;
        }
        self.step(c, side)
            .or(edge)
            .or_else(|| Self::neighbour(c, side, placed))
    }

    /// An edge that is not the border of a shadow, of tape, or of something nearer.
    fn edge(&self, c: &Candidate, side: usize) -> Option<End> {
        /// So many cells inside tell what crosses it; those next to it may be lost.
        const LOOK: isize = 6;
        const LOST: isize = 3;
        /// Share of the most.
        const NEARLY: f64 = 0.9;
        // Of a wide strip of edge only the border is a side: from inside the first that is nearly as much edge as any.
        let outwards = if side.is_multiple_of(2) { -1 } else { 1 };
        let at = |out: isize| side_edge(self.patch, c.first, c.cells, side, outwards * out);
        let most = (-REACH..=REACH).map(at).fold(0.0, f64::max);
        let out = (-REACH..=REACH).find(|&out| at(out) >= NEARLY * most)?;
        let (share, off) = (at(out), outwards * out);
        let axis = side / 2;
        let mut first = c.first;
        first[axis] = c.first[axis].checked_add_signed(off)?;
        let moved = Candidate { first, ..*c };
        // What is not measured inside as well, as tape across the side, is no edge of it.
        let share = share - self.unknown_along(&moved, side, -LOOK - LOST..-LOST);
        let is_surface = ends_surface(self.patch, &moved, side);
        let is_edge = share >= SEEN_SEAM && is_surface && self.falls_away(&moved, side);
        is_edge.then(|| End {
            line: line_of(&moved, side),
            strength: EDGE * share,
        })
    }

    /// True unless what begins beyond a side is unknown: a shadow that something nearer throws, or tape. The shadow
    /// of the carton itself falls on something deeper.
    fn falls_away(&self, c: &Candidate, side: usize) -> bool {
        /// So many cells beyond it tell whether that is known.
        const LOOK: isize = 6;
        const HALF: f64 = 0.5;
        if self.unknown_along(c, side, 0..LOOK) <= HALF {
            return true;
        }
        let frame = start_frame(self.patch, c);
        let extents = c.cells.map(|n| n as f64 * self.patch.pitch);
        let sign = if side.is_multiple_of(2) { -1.0 } else { 1.0 };
        let at = (side / 2, sign);
        beyond(self.image, &frame, extents, at, self.tolerance).open > HALF
    }

    /// Share of unknown cells along a side, in a strip outwards from it.
    fn unknown_along(&self, c: &Candidate, side: usize, out: Range<isize>) -> f64 {
        let (axis, across) = (side / 2, 1 - side / 2);
        let line = line_of(c, side);
        let ends = if side.is_multiple_of(2) {
            [line - out.end, line - out.start]
        } else {
            [line + out.start, line + out.end]
        };
        let (low, high) = (
            c.first[across] as isize,
            (c.first[across] + c.cells[across]) as isize,
        );
        let [i0, j0] = in_order(axis, ends[0], low);
        let [i1, j1] = in_order(axis, ends[1], high);
        self.unknown.share(i0, j0, i1, j1)
    }

    /// A plane beyond the side that is not the candidate's own.
    fn step(&self, c: &Candidate, side: usize) -> Option<End> {
        /// Blocks beyond the side that are taken together, and the least that may be.
        const STRIP: usize = 5;
        const LEAST_STRIP: usize = 2;
        /// Shorter stretches of a side tell little, blocks.
        const LEAST_STRETCH: usize = 4;
        /// Share of a step that must show directly at the side, too.
        const HOLDS: f64 = 0.5;
        /// Share of the blocks of a strip that must be surface.
        const FILLED: f64 = 0.6;
        let axis = side / 2;
        let own = self.relief.blocks_of(c).map(inner);
        let plane = self.relief.fit(own[0].clone(), own[1].clone())?;
        let line = line_of(c, side);
        // Blocks that the side may run through are left out.
        let beyond = if side.is_multiple_of(2) {
            let end = usize::try_from(line - REACH / 2).ok()? / BLOCK;
            end.saturating_sub(STRIP)..end
        } else {
            let start = usize::try_from(line + REACH / 2).ok()?.div_ceil(BLOCK);
            start..(start + STRIP).min(self.relief.size()[axis])
        };
        if beyond.len() < LEAST_STRIP {
            return None;
        }
        let inside = if side.is_multiple_of(2) {
            own[axis].start..own[axis].end.min(own[axis].start + STRIP)
        } else {
            own[axis].start.max(own[axis].end.saturating_sub(STRIP))..own[axis].end
        };
        // Two cartons may lie beyond.
        let across = own[1 - axis].clone();
        let middle = across.start.midpoint(across.end);
        let mut diffs = [0.0; 2 * REACH as usize];
        let mut strength = 0.0f64;
        for stretch in [across.start..middle, middle..across.end] {
            if stretch.len() < LEAST_STRETCH {
                continue;
            }
            let [i, j] = in_order(axis, beyond.clone(), stretch.clone());
            let whole = (i.len() * j.len()) as f64;
            if (self.relief.filled(&i, &j) as f64) < FILLED * whole {
                continue;
            }
            let Some(next) = self.relief.fit(i, j) else {
                continue;
            };
            let at = line as f64 / BLOCK as f64 - 0.5;
            let [i, j] = in_order(axis, inside.clone(), stretch.clone());
            let Some(close) = self.relief.fit(i, j) else {
                continue;
            };
            let apart = [stretch.start, stretch.end - 1]
                .map(|end| in_order(axis, at, end as f64))
                .into_iter()
                // A plane through parts of two cartons is off where it ends, but what lies there is not.
                .filter(|&end| {
                    let [own, close] = [&plane, &close].map(|p| p.height(end) - next.height(end));
                    close * own.signum() > HOLDS * own.abs()
                })
                .map(|end| self.breaks.step(&plane, &next, end))
                .fold(0.0, f64::max);
            if apart > 1.0 {
                strength = strength.max(apart);
                self.tell_apart(&plane, &next, axis, side, line, &stretch, &mut diffs);
            }
        }
        if strength == 0.0 {
            return None;
        }
        // Outwards: what is the carton's own lowers the sum, what is not raises it.
        let (mut sum, mut least, mut place) = (0.0, 0.0, 0);
        for (n, diff) in diffs.iter().enumerate() {
            sum += diff;
            if sum < least {
                (least, place) = (sum, n as isize + 1);
            }
        }
        let out = place - REACH;
        if out.abs() >= REACH {
            return None;
        }
        let sign = if side.is_multiple_of(2) { -1 } else { 1 };
        Some(End {
            line: line + sign * out,
            strength: strength.min(5.0),
        })
    }

    /// Adds for each cell across a line, from inside to outside, by how much it fits `own` better than `next`.
    fn tell_apart(
        &self,
        own: &Fit,
        next: &Fit,
        axis: usize,
        side: usize,
        line: isize,
        stretch: &Range<usize>,
        diffs: &mut [f64],
    ) {
        let in_blocks = |cell: isize| (cell as f64 + 0.5) / BLOCK as f64 - 0.5;
        for (n, diff) in diffs.iter_mut().enumerate() {
            let out = n as isize - REACH;
            let cell = if side.is_multiple_of(2) {
                line - 1 - out
            } else {
                line + out
            };
            for along in stretch.start * BLOCK..stretch.end * BLOCK {
                let [i, j] = in_order(axis, cell, along as isize);
                let Some(height) = self.unknown.height(i, j) else {
                    continue;
                };
                let at = [in_blocks(i), in_blocks(j)];
                let off = |fit: &Fit| (height - fit.height(at)).powi(2);
                *diff += off(own) - off(next);
            }
        }
    }

    /// A proven carton that begins there.
    fn neighbour(c: &Candidate, side: usize, placed: &[Candidate]) -> Option<End> {
        /// Share of the side that it must meet.
        const MET: f64 = 0.6;
        let across = 1 - side / 2;
        let line = line_of(c, side);
        let facing = side ^ 1;
        let beside = |p: &&Candidate| (line_of(p, facing) - line).abs() <= REACH;
        let met = |p: &Candidate| {
            let low = p.first[across].max(c.first[across]);
            let high = (p.first[across] + p.cells[across]).min(c.first[across] + c.cells[across]);
            high.saturating_sub(low) as f64
        };
        let near = || placed.iter().filter(beside);
        let share = near().map(met).sum::<f64>() / c.cells[across] as f64;
        if share < MET {
            return None;
        }
        let lines: f64 = near().map(|p| met(p) * line_of(p, facing) as f64).sum();
        let line = (lines / near().map(met).sum::<f64>()).round();
        Some(End {
            line: line as isize,
            strength: 0.5,
        })
    }
}

/// Where a side lies along its axis, cells.
pub fn line_of(c: &Candidate, side: usize) -> isize {
    let axis = side / 2;
    let low = c.first[axis] as isize;
    if side.is_multiple_of(2) {
        low
    } else {
        low + c.cells[axis] as isize
    }
}

/// Without the outermost blocks, which may hold a part of a neighbour.
fn inner(blocks: Range<usize>) -> Range<usize> {
    /// Fewer blocks than this are left as they are.
    const MANY: usize = 8;
    if blocks.len() >= MANY {
        blocks.start + 1..blocks.end - 1
    } else {
        blocks
    }
}

/// Along an axis first, then across it, as X and Y.
pub fn in_order<T>(axis: usize, along: T, across: T) -> [T; 2] {
    if axis == 0 {
        [along, across]
    } else {
        [across, along]
    }
}
