//! Stage 7b: cartons that their sides prove one by one, where a surface cannot be covered as a whole.
//!
//! Something hides a part of it, or one carton stands tilted: then no covering is exact. But each carton is one plane,
//! and where it ends there is an edge, or its neighbour's plane, or a neighbour that is proven itself. A place where
//! that holds on three sides, a known size apart, is a carton whatever lies elsewhere; so is one where it holds at a
//! corner and all beyond the two other sides is hidden from exactly there on.
//!
//! Where a side does not show, a carton of another size may go on, one that nobody told of. So with less than four
//! sides only sizes count of which some carton in sight shows all four.

use depal_frames::BoxSize;

use crate::{
    blank::Blank,
    cover::kinds,
    parts::is_within_another,
    patch::Patch,
    search::{Candidate, has_seam, measure},
    shown::{End, NEIGHBOUR, REACH, Shown, in_order, line_of},
};

/// So many sides must show; the fourth may be hidden, or meet a neighbour that lies quite level with it.
const LEAST_SHOWN: usize = 3;
/// Places are tried so many cells apart; where sides really are is then measured.
const STRIDE: usize = 8;
/// Two sides that lie by more than that nearer or farther than a size apart are not those of one carton, cells.
const SIZE_OFF: isize = 3;
/// Overlap of two cartons that inexact places make.
const OVERLAP: f64 = 0.05;
/// Overlap from which on two places are one carton's.
const SAME: f64 = 0.8;
/// What was left out and is turned by more against the patch has no side along one of a place, radians.
const MOST_TURN: f64 = 0.02;
/// Share of a place that must be surface or unknown.
const WHOLE: f64 = 0.96;

/// A place, how many of its sides show, and how clearly.
#[derive(Clone, Copy)]
struct Place {
    candidate: Candidate,
    sides: usize,
    /// All four show by themselves, not by a neighbour.
    complete: bool,
    strength: f64,
}

/// What a side without an end in sight looks like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Open {
    /// The surface reaches it, and goes on or is not known.
    Reached,
    /// The surface reaches it, and what lies beyond is hidden or not measured.
    Hidden,
    /// The surface ends before it.
    Short,
}

/// All cartons of the known sizes that are proven, those given as fixed not among them. `beside`: labels of cartons
/// that stand proven beside the patch.
pub fn proven(
    shown: &Shown,
    sizes: &[BoxSize],
    fixed: &[Candidate],
    beside: &[u32],
) -> Vec<Candidate> {
    let patch = shown.patch;
    let kinds = kinds(patch, sizes);
    let mut open: Vec<Candidate> = Vec::new();
    for &(label, turned, cells) in &kinds {
        if cells[0] > patch.columns || cells[1] > patch.rows {
            continue;
        }
        for j in (0..=patch.rows - cells[1]).step_by(STRIDE) {
            for i in (0..=patch.columns - cells[0]).step_by(STRIDE) {
                open.extend(candidate(shown, label, turned, [i, j], cells));
            }
        }
    }
    let mut placed = fixed.to_vec();
    placed.extend(
        patch
            .blanks
            .iter()
            .filter_map(|blank| found_before(patch, blank)),
    );
    let known = placed.len();
    let mut seen_whole = vec![false; sizes.len()];
    for label in beside.iter().copied().chain(fixed.iter().map(|f| f.label)) {
        seen_whole[label as usize] = true;
    }
    // A neighbour that is proven proves a side in turn: what is not near a new one has been looked at.
    let mut new: Option<Vec<Candidate>> = None;
    loop {
        let free = |c: &Candidate| placed.iter().all(|p| p.overlap(c).max(c.overlap(p)) < 0.3);
        open.retain(free);
        let is_new = |c: &&Candidate| {
            let new = new.as_ref();
            new.is_none_or(|new| new.iter().any(|n| is_near(c, n)))
        };
        let mut found: Vec<Place> = open
            .iter()
            .filter(is_new)
            .filter_map(|c| prove(shown, *c, &placed, &kinds, sizes))
            .collect();
        found.sort_by(|a, b| {
            let by_sides = b.sides.cmp(&a.sides);
            by_sides
                .then(b.strength.total_cmp(&a.strength))
                .then(a.candidate.first.cmp(&b.candidate.first))
        });
        let before = placed.len();
        let sizes_before = seen_whole.clone();
        for place in found.iter().filter(|place| place.complete) {
            seen_whole[place.candidate.label as usize] = true;
        }
        found.retain(|place| seen_whole[place.candidate.label as usize]);
        // Of two that show as many of their sides neither is proven, unless all of them show.
        let rivals = found.clone();
        for Place {
            candidate: c,
            sides,
            ..
        } in found
        {
            let clear = |p: &Candidate| p.overlap(&c).max(c.overlap(p)) < OVERLAP;
            let is_rival = |r: &&Place| {
                let shared = r.candidate.overlap(&c).max(c.overlap(&r.candidate));
                r.sides == sides && sides < 4 && (OVERLAP..SAME).contains(&shared)
            };
            if placed.iter().all(clear) && !rivals.iter().any(|r| is_rival(&r)) {
                placed.push(c);
            }
        }
        if placed.len() == before {
            break;
        }
        // What a size that was not seen whole ruled out is looked at once more.
        let same_sizes = seen_whole == sizes_before;
        new = same_sizes.then(|| placed[before..].to_vec());
    }
    placed.split_off(known)
}

/// What was left out of a patch, as far as it lies on it: a carton that was found before, which is a neighbour like any.
fn found_before(patch: &Patch, blank: &Blank) -> Option<Candidate> {
    let origin = [patch.left, patch.bottom];
    let most = [patch.columns, patch.rows];
    let (s, c) = blank.turn.sin_cos();
    // Nearly a quarter turn: its first side lies along Y.
    let turned = s.abs() > c.abs();
    let half = if turned {
        [blank.half[1], blank.half[0]]
    } else {
        blank.half
    };
    let at = |k: usize, sign: f64| {
        let cell = (blank.middle[k] + sign * half[k] - origin[k]) / patch.pitch;
        cell.round().clamp(0.0, most[k] as f64) as usize
    };
    let first = [at(0, -1.0), at(1, -1.0)];
    let cells = [0, 1].map(|k| at(k, 1.0) - first[k]);
    let turn = s.abs().min(c.abs());
    (turn < MOST_TURN && cells.iter().all(|&n| n > 0)).then_some(Candidate {
        label: u32::MAX,
        turned,
        first,
        cells,
        sides: [0.0; 4],
        score: 0.0,
    })
}

/// True when one may show a side of the other.
fn is_near(a: &Candidate, b: &Candidate) -> bool {
    let slack = 3 * REACH as usize;
    (0..2).all(|k| {
        a.first[k] <= b.first[k] + b.cells[k] + slack
            && b.first[k] <= a.first[k] + a.cells[k] + slack
    })
}

/// A place that one carton may fill: one plane as far as it is known.
fn candidate(
    shown: &Shown,
    label: u32,
    turned: bool,
    first: [usize; 2],
    cells: [usize; 2],
) -> Option<Candidate> {
    /// Share that must be known to be surface.
    const LEAST_SEEN: f64 = 0.5;
    let (seen, known) = shares(shown, first.map(|v| v as isize), cells);
    if seen < LEAST_SEEN || known < WHOLE {
        return None;
    }
    let candidate = measure(shown.patch, label, turned, first, cells, 0.0)?;
    (!shown.breaks.within(&candidate)).then_some(candidate)
}

/// Share of a place that is surface, and that with what is unknown, its rim left out.
fn shares(shown: &Shown, first: [isize; 2], cells: [usize; 2]) -> (f64, f64) {
    let Shown { patch, unknown, .. } = shown;
    let rim = patch.rim.max(STRIDE / 2) as isize;
    let [i0, j0] = first.map(|v| v + rim);
    let [i1, j1] = [0, 1].map(|k| first[k] + cells[k] as isize - rim);
    let seen = patch.surface(i0, j0, i1, j1);
    (seen, seen + unknown.share(i0, j0, i1, j1))
}

/// Moves a candidate to where its sides show; `None` where too few do, or not its size apart.
fn prove(
    shown: &Shown,
    start: Candidate,
    placed: &[Candidate],
    kinds: &[(u32, bool, [usize; 2])],
    sizes: &[BoxSize],
) -> Option<Place> {
    const ROUNDS: usize = 3;
    // Beyond a side where nothing ends a larger known carton may go on.
    let within_another = is_within_another(sizes, start.label as usize);
    let mut at = start;
    for _ in 0..ROUNDS {
        let ends = [0, 1, 2, 3].map(|side| shown.end(&at, side, placed));
        let sides = ends.iter().flatten().count();
        if sides < LEAST_SHOWN - 1 {
            return None;
        }
        let mut first = at.first;
        for axis in 0..2 {
            let low = ends[2 * axis].as_ref().map(|e| e.line);
            let length = at.cells[axis] as isize;
            let high = ends[2 * axis + 1].as_ref().map(|e| e.line - length);
            let line = match (low, high) {
                (Some(low), Some(high)) if (low - high).abs() <= SIZE_OFF => {
                    (low + high).div_euclid(2)
                }
                (Some(line), None) | (None, Some(line)) => line,
                _ => return None,
            };
            first[axis] = usize::try_from(line).ok()?;
        }
        let moved = (0..2).any(|k| first[k].abs_diff(at.first[k]) > 1);
        at = candidate(shown, at.label, at.turned, first, at.cells)?;
        if moved {
            continue;
        }
        let looks = [0, 1, 2, 3].map(|side| match &ends[side] {
            Some(_) => None,
            None => Some(look(shown, &at, side)),
        });
        let hidden = looks.map(|look| look == Some(Open::Hidden));
        // A corner shows where a carton is, and what is hidden from its size on how large it is.
        let corner = || {
            let own = ends.iter().flatten().all(|e| e.strength > NEIGHBOUR);
            own && hidden.iter().filter(|h| **h).count() == 2
        };
        // A neighbour that meets it level is as large as any.
        let narrowest = kinds.iter().flat_map(|k| k.2).min().unwrap_or(0);
        let wrong = |(side, look): (usize, &Option<Open>)| match look {
            Some(Open::Short) => true,
            Some(Open::Reached) => shown.ends_beyond(&at, side, narrowest / 2),
            Some(Open::Hidden) | None => false,
        };
        // Without all four, each must show clearly: the ground, too, has noise and is not quite flat.
        let faint = |e: &End| !e.clear;
        if looks.iter().enumerate().any(wrong)
            || sides < 4 && ends.iter().flatten().any(faint)
            || sides < 4 && within_another
            || sides < 4 && !shown.breaks.is_one_plane(&at)
            || sides < LEAST_SHOWN && !corner()
            || may_be_larger(shown, &at, hidden, kinds)
            || has_seam(shown.patch, &at)
        {
            return None;
        }
        return Some(Place {
            candidate: at,
            sides,
            complete: ends
                .iter()
                .flatten()
                .filter(|e| e.strength > NEIGHBOUR)
                .count()
                == 4,
            strength: ends.iter().flatten().map(|e| e.strength).sum(),
        });
    }
    None
}

/// What a side looks like that nothing shows.
fn look(shown: &Shown, c: &Candidate, side: usize) -> Open {
    const INSIDE: isize = 6;
    const MOST_MISSING: f64 = 0.1;
    let (axis, across) = (side / 2, 1 - side / 2);
    let rim = shown.patch.rim as isize;
    let low = c.first[across] as isize + rim;
    let high = (c.first[across] + c.cells[across]) as isize - rim;
    let line = line_of(c, side);
    // Seen, and that with what is unknown, of a strip from so far to so far outwards.
    let strip = |from: isize, to: isize| {
        let [from, to] = if side.is_multiple_of(2) {
            [line - to, line - from]
        } else {
            [line + from, line + to]
        };
        let [i0, j0] = in_order(axis, from, low);
        let [i1, j1] = in_order(axis, to, high);
        let seen = shown.patch.surface(i0, j0, i1, j1);
        (seen, seen + shown.unknown.share(i0, j0, i1, j1))
    };
    // Where it ends is known to some cells.
    let (inside, reached) = strip(-INSIDE - SIZE_OFF, -SIZE_OFF);
    if reached < 1.0 - MOST_MISSING {
        return Open::Short;
    }
    let (seen, known) = strip(SIZE_OFF, SIZE_OFF + INSIDE);
    if inside >= 1.0 - MOST_MISSING && known - seen >= 1.0 - MOST_MISSING {
        Open::Hidden
    } else {
        Open::Reached
    }
}

/// True when a larger known size fills the place as well and goes on where it is hidden.
fn may_be_larger(
    shown: &Shown,
    c: &Candidate,
    hidden: [bool; 4],
    kinds: &[(u32, bool, [usize; 2])],
) -> bool {
    if hidden == [false; 4] {
        return false;
    }
    kinds.iter().any(|(_, _, cells)| {
        let longer = [0, 1].map(|k| cells[k] as isize - c.cells[k] as isize);
        // Along an axis without a hidden side the size shows.
        let fits = (0..2).all(|k| {
            longer[k].abs() <= SIZE_OFF || longer[k] > 0 && (hidden[2 * k] || hidden[2 * k + 1])
        });
        if !fits || longer.iter().all(|l| l.abs() <= SIZE_OFF) {
            return false;
        }
        let first = [0, 1].map(|k| {
            let back = if hidden[2 * k] { longer[k].max(0) } else { 0 };
            c.first[k] as isize - back
        });
        shares(shown, first, *cells).1 >= WHOLE
    })
}
