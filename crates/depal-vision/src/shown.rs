//! Stage 7b: what shows that a carton ends at a side.

use std::ops::Range;

use crate::{
    beyond::{WIDEST_BLIND_GAP, beyond},
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

/// With less of an edge a step tells better where it is.
const PLAIN_EDGE: f64 = 0.3;
/// So many cells on both sides of a step must lie on the planes that make it.
const CLOSE: isize = 8;
/// How clearly a proven neighbour shows a side.
pub const NEIGHBOUR: f64 = 0.5;

/// What shows that a carton ends at a side.
pub struct End {
    /// The line, in cells along the axis.
    pub line: isize,
    /// How clearly it shows, in the least steps that count; less than one for a neighbour alone.
    pub strength: f64,
    /// Not a mere piece of edge, as the corner of something nearer and its shadow leave on any line.
    pub clear: bool,
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
        /// So near to a step an edge is the same end, cells.
        const SAME: isize = 3;
        let edge = self.edge(c, side);
        let along_all = |e: &End| self.is_along_all(c, side, e.line);
        if edge
            .as_ref()
            .is_some_and(|e| e.strength >= EDGE * PLAIN_EDGE && along_all(e))
        {
            return edge;
        }
        // Where the surface ends along a part of a side only, as ground does beside what stands on it, a step must
        // part it from what goes on along the rest.
        let own = match (edge, self.step(c, side)) {
            (Some(edge), Some(step))
                if (edge.line - step.line).abs() <= SAME && !along_all(&edge) =>
            {
                Some(edge)
            }
            (_, Some(step)) => Some(step),
            (Some(edge), None) if along_all(&edge) => Some(edge),
            _ => None,
        };
        if own.as_ref().is_some_and(|end| end.clear) {
            return own;
        }
        // A piece of edge where a proven carton begins is the gap between the two.
        match (own, Self::neighbour(c, side, placed)) {
            (Some(own), Some(next)) if (own.line - next.line).abs() <= SAME => {
                Some(End { clear: true, ..own })
            }
            (own, next) => own.or(next),
        }
    }

    /// True when an edge shows along both halves of a side.
    fn is_along_all(&self, c: &Candidate, side: usize, line: isize) -> bool {
        /// The lesser half shows so much of what the other does.
        const LESSER: f64 = 0.3;
        let across = 1 - side / 2;
        let off = line - line_of(c, side);
        let [low, high] = [0, 1].map(|half| {
            let (mut first, mut cells) = (c.first, c.cells);
            cells[across] /= 2;
            first[across] += half * cells[across];
            side_edge(self.patch, first, cells, side, off)
        });
        low.min(high) >= LESSER * low.max(high)
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
            clear: share >= PLAIN_EDGE,
        })
    }

    /// True when the surface ends with an edge not farther than so many cells beyond a side: then it is no side.
    pub fn ends_beyond(&self, c: &Candidate, side: usize, cells: usize) -> bool {
        /// Share of a side along which it does: beside a part of it there may be other cartons.
        const MOST: f64 = 0.7;
        let axis = side / 2;
        let outwards = if side.is_multiple_of(2) { -1 } else { 1 };
        const STEP: isize = 2 * REACH + 1;
        (STEP..=cells as isize + REACH)
            .step_by(STEP as usize)
            .filter_map(|out| {
                let mut moved = *c;
                moved.first[axis] = c.first[axis].checked_add_signed(outwards * out)?;
                let inside = moved.first[axis] + c.cells[axis] <= self.size(axis);
                inside.then_some(moved)
            })
            .filter_map(|moved| self.edge(&moved, side))
            .any(|end| end.strength >= EDGE * MOST)
    }

    fn size(&self, axis: usize) -> usize {
        [self.patch.columns, self.patch.rows][axis]
    }

    /// True unless what begins beyond a side is unknown: a shadow that something nearer throws, or tape. The shadow
    /// of the carton itself falls on something deeper.
    fn falls_away(&self, c: &Candidate, side: usize) -> bool {
        /// So many cells tell whether something is known.
        const LOOK: isize = 6;
        const HALF: f64 = 0.5;
        /// Those next to a side may be lost.
        const LOST: isize = 3;
        /// Tape of which some pixels are measured shows more surface than that, a gap none.
        const NO_SURFACE: f64 = 0.03;
        let unknown = |out: Range<isize>| self.unknown_along(c, side, out);
        if unknown(0..LOOK) <= HALF {
            return true;
        }
        let gap = (WIDEST_BLIND_GAP / self.patch.pitch).ceil() as isize;
        let [i0, j0, i1, j1] = along(c, side, LOST..gap);
        if unknown(gap..gap + LOOK) > HALF && self.patch.surface(i0, j0, i1, j1) > NO_SURFACE {
            return false;
        }
        let frame = start_frame(self.patch, c);
        let extents = c.cells.map(|n| n as f64 * self.patch.pitch);
        let sign = if side.is_multiple_of(2) { -1.0 } else { 1.0 };
        let at = (side / 2, sign);
        let seen = beyond(
            self.image,
            &frame,
            extents,
            at,
            self.tolerance,
            WIDEST_BLIND_GAP,
        );
        seen.open > HALF
    }

    /// Share of unknown cells along a side, in a strip outwards from it.
    fn unknown_along(&self, c: &Candidate, side: usize, out: Range<isize>) -> f64 {
        let [i0, j0, i1, j1] = along(c, side, out);
        self.unknown.share(i0, j0, i1, j1)
    }

    /// A plane beyond the side that is not the candidate's own.
    fn step(&self, c: &Candidate, side: usize) -> Option<End> {
        /// Blocks beyond the side that are taken together, and the least that may be.
        const STRIP: usize = 5;
        const LEAST_STRIP: usize = 2;
        /// Shorter stretches of a side tell little, blocks.
        const LEAST_STRETCH: usize = 4;
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
        // Two cartons may lie beyond.
        let across = own[1 - axis].clone();
        let middle = across.start.midpoint(across.end);
        let mut lines = [Fits::default(); 2 * (REACH + CLOSE) as usize];
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
            let apart = [stretch.start, stretch.end - 1]
                .map(|end| in_order(axis, at, end as f64))
                .map(|end| self.breaks.step(&plane, &next, end))
                .into_iter()
                .fold(0.0, f64::max);
            if apart > 1.0 {
                strength = strength.max(apart);
                self.tell_apart(&plane, &next, (side, line), &stretch, &mut lines);
            }
        }
        if strength == 0.0 {
            return None;
        }
        let out = where_apart(&lines)?;
        let sign = if side.is_multiple_of(2) { -1 } else { 1 };
        Some(End {
            line: line + sign * out,
            strength: strength.min(5.0),
            clear: true,
        })
    }

    /// Adds what lies on each line of cells across a side, from inside to outside.
    fn tell_apart(
        &self,
        own: &Fit,
        next: &Fit,
        (side, line): (usize, isize),
        stretch: &Range<usize>,
        lines: &mut [Fits],
    ) {
        let in_blocks = |cell: isize| (cell as f64 + 0.5) / BLOCK as f64 - 0.5;
        let first = -(lines.len() as isize) / 2;
        for (n, fits) in lines.iter_mut().enumerate() {
            let out = first + n as isize;
            let cell = if side.is_multiple_of(2) {
                line - 1 - out
            } else {
                line + out
            };
            for along in stretch.start * BLOCK..stretch.end * BLOCK {
                let [i, j] = in_order(side / 2, cell, along as isize);
                let Some(height) = self.unknown.height(i, j) else {
                    continue;
                };
                let at = [in_blocks(i), in_blocks(j)];
                let [own, next] = [own, next].map(|fit| fit.height(at));
                fits.next += (height - own).powi(2) - (height - next).powi(2);
                fits.apart += (own - next).powi(2);
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
            strength: NEIGHBOUR,
            clear: true,
        })
    }
}

/// Which of two planes the cells of a line lie on.
#[derive(Clone, Copy, Default)]
struct Fits {
    /// By how much they fit the next plane better than the candidate's own, square metres.
    next: f64,
    /// The same if all lie on the next one; on the own one it is the negative.
    apart: f64,
}

/// Where a carton's own plane ends in lines of cells from inside to outside, the side in their middle; `None` if it
/// does not end there, and the other begin: a plane through parts of two cartons is off, too, but nothing lies on it.
fn where_apart(lines: &[Fits]) -> Option<isize> {
    /// Share of a step that must show directly at the side.
    const HOLDS: f64 = 0.5;
    let side = lines.len() as isize / 2;
    // What is the carton's own lowers the sum, what is not raises it.
    let (mut sum, mut least, mut place) = (0.0, f64::MAX, 0);
    for at in side - REACH..=side + REACH {
        if sum < least {
            (least, place) = (sum, at);
        }
        sum += lines[at as usize].next;
    }
    let close = |range: Range<isize>| {
        let lines = &lines[range.start as usize..range.end as usize];
        lines.iter().fold((0.0, 0.0), |(next, apart), fits| {
            (next + fits.next, apart + fits.apart)
        })
    };
    let (inside, inside_apart) = close(place - CLOSE..place);
    let (outside, outside_apart) = close(place..place + CLOSE);
    let ends = inside < -HOLDS * inside_apart && outside > HOLDS * outside_apart;
    ((place - side).abs() < REACH && ends).then_some(place - side)
}

/// The cells (i0, j0, i1, j1) along a side in a strip outwards from it.
fn along(c: &Candidate, side: usize, out: Range<isize>) -> [isize; 4] {
    let (axis, across) = (side / 2, 1 - side / 2);
    let line = line_of(c, side);
    let [from, to] = if side.is_multiple_of(2) {
        [line - out.end, line - out.start]
    } else {
        [line + out.start, line + out.end]
    };
    let low = c.first[across] as isize;
    let high = (c.first[across] + c.cells[across]) as isize;
    let [i0, j0] = in_order(axis, from, low);
    let [i1, j1] = in_order(axis, to, high);
    [i0, j0, i1, j1]
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
