//! Stage 7a: height breaks. One carton is one plane; where two planes do not meet, two cartons do.

use std::ops::Range;

use crate::{
    patch::{BLOCK, Patch},
    relief::{Fit, Relief},
    search::{Candidate, SEEN, side_edge},
};

/// Thinnest part that is fitted by a plane of its own, blocks: 50 mm at 2 m.
const LEAST_PART: usize = 4;
/// A step must stand out from what the noise of the blocks does to two fitted planes by this many deviations:
/// some fifty places are tried in each carton.
const SIGMAS: f64 = 5.0;
/// From this share of edge along its weakest side on, gaps are seen so well that one inside could not hide. Tape across
/// a side adds a quarter.
const SEEN_WELL: f64 = 0.75;
/// A stretch of a side with less edge than this shows none: lone holes give 0.02 anywhere.
const NO_EDGE: f64 = 0.04;

/// Sides that make an outline.
const LEAST_OUTLINE: usize = 3;

/// What an unneeded plane explains of noise alone is less than this, in variances of a block: three on the average.
pub const BY_CHANCE: f64 = 30.0;

/// Finds breaks on one patch.
pub struct Breaks<'a> {
    relief: &'a Relief,
    /// Variance of a block's height, square metres.
    noise: f64,
    /// Unevenness that one carton may have, metres.
    uneven: f64,
}

impl<'a> Breaks<'a> {
    /// `noise`: variance of a block's height, square metres. `uneven`: how much a carton may deviate from a
    /// plane, metres.
    pub fn new(relief: &'a Relief, noise: f64, uneven: f64) -> Self {
        Self {
            relief,
            noise,
            uneven,
        }
    }

    /// By how much two planes differ at a place (column, row of blocks), in what noise and unevenness do at most.
    pub fn step(&self, a: &Fit, b: &Fit, at: [f64; 2]) -> f64 {
        let variance = self.noise * (a.spread(at) + b.spread(at));
        (a.height(at) - b.height(at)).abs() / self.uneven.max(SIGMAS * variance.sqrt())
    }

    /// True when they differ by more.
    fn apart(&self, a: &Fit, b: &Fit, at: [f64; 2]) -> bool {
        self.step(a, b, at) > 1.0
    }

    /// True when a line across the candidate parts it into two planes that do not meet there.
    pub fn within(&self, candidate: &Candidate) -> bool {
        self.parts(candidate) && {
            // Noise hangs together over some blocks, and what is farther away has more of it than most.
            let [i, j] = self.relief.blocks_of(candidate);
            let noise = self.relief.noise_within(&i, &j).max(self.relief.noise(2));
            noise <= self.noise || Self { noise, ..*self }.parts(candidate)
        }
    }

    /// The same for the noise that is everywhere.
    fn parts(&self, candidate: &Candidate) -> bool {
        /// A step that counts makes the candidate so much less plane than noise does.
        const LEAST_MISFIT: f64 = 1.2;
        let plane = self.relief.misfit(&[*candidate]);
        if plane.squares <= LEAST_MISFIT * self.noise * plane.blocks as f64 {
            return false;
        }
        // A candidate some cells off its carton holds a strip of the next one.
        let inner = self.relief.blocks_of(candidate).map(|r| {
            if r.len() > 2 * LEAST_PART + 3 {
                r.start + 1..r.end - 1
            } else {
                r
            }
        });
        (0..2).any(|axis| {
            let (whole, across) = (&inner[axis], &inner[1 - axis]);
            (whole.start + LEAST_PART..whole.end.saturating_sub(LEAST_PART)).any(|cut| {
                // The block at the cut may hold both.
                let part = |along: Range<usize>| {
                    let [i, j] = in_order(axis, along, across.clone());
                    self.relief.fit(i, j)
                };
                let (Some(low), Some(high)) = (part(whole.start..cut), part(cut + 1..whole.end))
                else {
                    return false;
                };
                [across.start, across.end.saturating_sub(1)]
                    .iter()
                    .any(|&end| {
                        let [x, y] = in_order(axis, cut as f64, end as f64);
                        self.apart(&low, &high, [x, y])
                    })
            })
        })
    }

    /// True when no line from side to side parts the candidate into two planes that explain its heights any better
    /// than one does. Stricter than [`Breaks::within`]: cartons may be uneven, but one that is may as well be two.
    pub fn is_one_plane(&self, candidate: &Candidate) -> bool {
        let whole = self.relief.blocks_of(candidate);
        (0..2).all(|axis| {
            let (along, across) = (&whole[axis], &whole[1 - axis]);
            (along.start + LEAST_PART..along.end.saturating_sub(LEAST_PART)).all(|cut| {
                // The block at the cut may hold both.
                let [low, high] = [along.start..cut, cut + 1..along.end]
                    .map(|part| in_order(axis, part, across.clone()));
                self.relief.gain_by_parting(&low, &high) < BY_CHANCE * self.noise
            })
        })
    }

    /// True when the planes of two candidates that touch along side `side` (-X, +X, -Y, +Y) of the first do
    /// not meet there.
    pub fn between(&self, a: &Candidate, b: &Candidate, side: usize) -> bool {
        let axis = side / 2;
        let (of_a, of_b) = (self.relief.blocks_of(a), self.relief.blocks_of(b));
        let fit = |r: &[Range<usize>; 2]| self.relief.fit(r[0].clone(), r[1].clone());
        let (Some(plane_a), Some(plane_b)) = (fit(&of_a), fit(&of_b)) else {
            return false;
        };
        let line = if side.is_multiple_of(2) {
            a.first[axis]
        } else {
            a.first[axis] + a.cells[axis]
        } as f64
            / BLOCK as f64
            - 0.5;
        let across = 1 - axis;
        let low = of_a[across].start.max(of_b[across].start);
        let high = of_a[across].end.min(of_b[across].end);
        low < high
            && [low, high - 1].iter().any(|&end| {
                let [x, y] = in_order(axis, line, end as f64);
                self.apart(&plane_a, &plane_b, [x, y])
            })
    }

    /// True when what looks like a carton's outline is none: it needs the border of tape that lies within it; where
    /// gaps are seen too badly for one inside to be seen, a break runs through it or it needs the borders of stripes,
    /// or both; or its surface goes on beyond a side without edge or break. `doubtful`: it may be smaller cartons
    /// whose gap does not show, however well the outer ones are seen.
    pub fn refute(&self, patch: &Patch, candidate: &Candidate, doubtful: bool) -> bool {
        let weakest = candidate.sides.iter().copied().fold(f64::MAX, f64::min);
        let stripes = needed_stripes(patch, candidate);
        let doubts = [stripes != Stripes::None, self.within(candidate)];
        doubtful && !self.is_one_plane(candidate)
            || stripes == Stripes::Within
            || doubts == [true; 2]
            || weakest < SEEN_WELL && doubts != [false; 2]
            || (0..4).any(|side| {
                candidate.sides[side] < 1.0 - NO_EDGE && self.goes_on(patch, candidate, side)
            })
    }

    /// True when the candidate's plane goes on beyond a side, without edge or break, along a stretch of it.
    fn goes_on(&self, patch: &Patch, candidate: &Candidate, side: usize) -> bool {
        /// Blocks beyond the side, the first left out because the side may run through it.
        const BEYOND: Range<usize> = 1..4;
        let axis = side / 2;
        let own = self.relief.blocks_of(candidate);
        let Some(plane) = self.relief.fit(own[0].clone(), own[1].clone()) else {
            return false;
        };
        let beyond = if side.is_multiple_of(2) {
            let Some(start) = own[axis].start.checked_sub(BEYOND.end) else {
                return false;
            };
            start..own[axis].start - BEYOND.start
        } else {
            own[axis].end + BEYOND.start..own[axis].end + BEYOND.end
        };
        if beyond.end > self.relief.size()[axis] {
            return false;
        }
        // The longest stretch of blocks along the side beyond which all is surface.
        let across = own[1 - axis].clone();
        let is_surface = |n: usize| {
            let [i, j] = in_order(axis, beyond.clone(), n..n + 1);
            self.relief.is_full(i, j)
        };
        let mut longest = 0..0;
        let mut start = across.start;
        for n in across.start..=across.end {
            if n == across.end || !is_surface(n) {
                if n - start > longest.len() {
                    longest = start..n;
                }
                start = n + 1;
            }
        }
        if longest.len() < LEAST_PART {
            return false;
        }
        // No edge along it, give or take some cells.
        let mut first = candidate.first;
        let mut cells = candidate.cells;
        first[1 - axis] = longest.start * BLOCK;
        cells[1 - axis] = longest.len() * BLOCK;
        if (-4..=4).any(|off| side_edge(patch, first, cells, side, off) >= NO_EDGE) {
            return false;
        }
        let [i, j] = in_order(axis, beyond.clone(), longest.clone());
        let Some(next) = self.relief.fit(i, j) else {
            return false;
        };
        let line = if side.is_multiple_of(2) {
            own[axis].start as f64 - 1.0
        } else {
            own[axis].end as f64
        };
        // Where so little is fitted that a step of the size of cartons would not be seen, nothing is proven.
        [longest.start, longest.end - 1].iter().all(|&end| {
            let [x, y] = in_order(axis, line, end as f64);
            let variance = self.noise * (plane.spread([x, y]) + next.spread([x, y]));
            SIGMAS * variance.sqrt() < 4.0 * self.uneven && !self.apart(&plane, &next, [x, y])
        })
    }
}

/// Stripes without measurement behind which the surface goes on, whose borders an outline needs: tape ends no carton.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stripes {
    None,
    /// Beyond its sides: tape or wide gaps.
    Beyond,
    /// One lies within: that is no gap.
    Within,
}

fn needed_stripes(patch: &Patch, candidate: &Candidate) -> Stripes {
    /// Widths of a stripe that is no gap, metres.
    const WIDTHS: [f64; 2] = [0.010, 0.060];
    /// Share of what is deep in a gap that shows its bottom anywhere.
    const LEAST_DEEP: f64 = 0.02;
    let [narrow, wide] = WIDTHS.map(|w| (w / patch.pitch) as isize);
    let [i0, j0] = candidate.first.map(|v| v as isize);
    let (i1, j1) = (
        i0 + candidate.cells[0] as isize,
        j0 + candidate.cells[1] as isize,
    );
    let on = |side: usize, d: isize| match side {
        0 => patch.surface(i0 - d - 2, j0, i0 - d, j1),
        1 => patch.surface(i1 + d, j0, i1 + d + 2, j1),
        2 => patch.surface(i0, j0 - d - 2, i1, j0 - d),
        _ => patch.surface(i0, j1 + d, i1, j1 + d + 2),
    };
    let deep = |side: usize, d: isize| {
        let at = |v: isize| v.max(0) as usize;
        match side {
            0 => patch.deep(at(i0 - d), at(j0), at(i0), at(j1)),
            1 => patch.deep(at(i1), at(j0), at(i1 + d), at(j1)),
            2 => patch.deep(at(i0), at(j0 - d), at(i1), at(j0)),
            _ => patch.deep(at(i0), at(j1), at(i1), at(j1 + d)),
        }
    };
    let is_stripe = |side: usize| {
        (2..=wide)
            .find(|&d| on(side, d) > 0.5)
            .is_some_and(|d| d >= narrow && deep(side, d) < LEAST_DEEP)
    };
    // The same from across it: the stripe lies inside the side, surface directly beyond.
    let is_far_border =
        |side: usize| !ends_surface(patch, candidate, side) && (0..8).any(|d| on(side, d) > 0.5);
    let within = [0, 1, 2, 3].map(is_far_border);
    let any_within = within.contains(&true);
    // Where tape lies within, what is not measured beyond another side may be the next tape, wider than the patch shows.
    let is_blind = |side: usize| {
        let reach = [
            i0,
            patch.columns as isize - i1,
            j0,
            patch.rows as isize - j1,
        ][side];
        !(0..reach - 1).any(|d| on(side, d) > 0.5) && deep(side, reach) < LEAST_DEEP
    };
    let stripes =
        [0, 1, 2, 3].map(|side| within[side] || is_stripe(side) || any_within && is_blind(side));
    let plain = (0..4).filter(|&side| candidate.sides[side] >= SEEN && !stripes[side]);
    if plain.count() >= LEAST_OUTLINE || !stripes.contains(&true) {
        Stripes::None
    } else if any_within {
        Stripes::Within
    } else {
        Stripes::Beyond
    }
}

/// True when there is surface directly inside a side (-X, +X, -Y, +Y): only that can end there.
pub fn ends_surface(patch: &Patch, candidate: &Candidate, side: usize) -> bool {
    let [i0, j0] = candidate.first.map(|v| v as isize);
    let (i1, j1) = (
        i0 + candidate.cells[0] as isize,
        j0 + candidate.cells[1] as isize,
    );
    let on = match side {
        0 => patch.surface(i0 + 3, j0, i0 + 6, j1),
        1 => patch.surface(i1 - 6, j0, i1 - 3, j1),
        2 => patch.surface(i0, j0 + 3, i1, j0 + 6),
        _ => patch.surface(i0, j1 - 6, i1, j1 - 3),
    };
    on > 0.5
}

/// Along an axis first, then across it, as X and Y.
fn in_order<T>(axis: usize, along: T, across: T) -> [T; 2] {
    if axis == 0 {
        [along, across]
    } else {
        [across, along]
    }
}
