//! Stage 7b: where two cartons of a covering meet: which sides show a seam, how wide the gaps are, what hangs together.

use crate::{breaks::Breaks, patch::Patch, search::Candidate};

/// Share of edge from which a side between two boxes counts as a seam.
pub const SEEN_SEAM: f64 = 0.1;

/// Share of dark line from which on it is one.
pub const LEAST_LINE: f64 = 0.6;

/// Boxes in a row lie at most so far apart and beside the row, metres: farther and the gap is seen.
const LEVEL_ROW: f64 = 0.005;

/// Two cartons beside each other are at most so far apart, metres.
pub const TOUCHES: f64 = 0.010;

/// True when a side between two boxes shows a seam.
pub fn any_seam(boxes: &[Candidate], pitch: f64) -> bool {
    boxes.iter().any(|a| {
        (0..4).any(|side| {
            a.sides[side] >= SEEN_SEAM
                && boxes
                    .iter()
                    .any(|b| b.first != a.first && touches(a, b, side, pitch))
        })
    })
}

/// Share of the sides between two boxes that show a seam; 0 where no two touch.
pub fn seams_seen(boxes: &[Candidate], pitch: f64) -> f64 {
    let (mut inner, mut seen) = (0, 0);
    for a in boxes {
        for side in 0..4 {
            let meets = |b: &Candidate| b.first != a.first && touches(a, b, side, pitch);
            if boxes.iter().any(meets) {
                inner += 1;
                seen += usize::from(a.sides[side] >= LEAST_LINE);
            }
        }
    }
    seen as f64 / f64::from(inner.max(1))
}

/// The widest measured gap between two neighbours, metres; 0 when no two have a seam seen.
pub fn widest_gap(patch: &Patch, boxes: &[Candidate]) -> f64 {
    const BESIDE: isize = 3;
    let mut widest = 0.0f64;
    for a in boxes {
        for b in boxes {
            for side in [1, 3] {
                if !touches(a, b, side, patch.pitch) || a.sides[side] < SEEN_SEAM {
                    continue;
                }
                let (axis, across) = (side / 2, 1 - side / 2);
                let from = (a.first[axis] + a.cells[axis]) as isize - BESIDE;
                let to = b.first[axis] as isize + BESIDE;
                let low = a.first[across].max(b.first[across]) as isize;
                let high = (a.first[across] + a.cells[across])
                    .min(b.first[across] + b.cells[across]) as isize;
                let surface = if axis == 0 {
                    patch.surface(from, low, to, high)
                } else {
                    patch.surface(low, from, high, to)
                };
                widest = widest.max((1.0 - surface) * (to - from) as f64 * patch.pitch);
            }
        }
    }
    widest
}

/// For each box the lowest index among the boxes it hangs together with, without a seam or a height break between.
pub fn islands(boxes: &[Candidate], patch: &Patch, breaks: &Breaks, unlevel: bool) -> Vec<usize> {
    let mut island: Vec<usize> = (0..boxes.len()).collect();
    for _ in 0..boxes.len() {
        for a in 0..boxes.len() {
            for b in 0..boxes.len() {
                let joined = a != b
                    && (0..4).any(|side| {
                        touches(&boxes[a], &boxes[b], side, patch.pitch)
                            && boxes[a].sides[side] < SEEN_SEAM
                            && !(unlevel && breaks.between(&boxes[a], &boxes[b], side))
                    });
                if joined {
                    let low = island[a].min(island[b]);
                    island[a] = low;
                    island[b] = low;
                }
            }
        }
    }
    island
}

/// True when the boxes may as well be parts of larger cartons: two, three or more in a row, all along their length or
/// all across it, of one island (as of [`islands`]) each, none left over.
pub fn may_be_parts(boxes: &[Candidate], islands: &[usize], pitch: f64) -> bool {
    let near = (LEVEL_ROW / pitch).ceil() as usize;
    let next = |b: usize, axis: usize| {
        (0..boxes.len()).find(|&o| {
            islands[b] == islands[o]
                && boxes[o].label == boxes[b].label
                && boxes[o].turned == boxes[b].turned
                && (boxes[b].first[axis] + boxes[b].cells[axis]).abs_diff(boxes[o].first[axis])
                    <= near
                && boxes[b].first[1 - axis].abs_diff(boxes[o].first[1 - axis]) <= near
        })
    };
    [false, true].iter().any(|across| {
        let axis = |b: usize| usize::from(boxes[b].turned != *across);
        let followed: Vec<Option<usize>> = (0..boxes.len()).map(|b| next(b, axis(b))).collect();
        let starts = (0..boxes.len()).filter(|b| !followed.contains(&Some(*b)));
        let length = |b: usize| std::iter::successors(Some(b), |b| followed[*b]).count();
        starts.map(length).fold(0, greatest_common_divisor) > 1
    })
}

fn greatest_common_divisor(a: usize, b: usize) -> usize {
    if b == 0 {
        a
    } else {
        greatest_common_divisor(b, a % b)
    }
}

/// True when `other` lies directly beyond side `side` (-X, +X, -Y, +Y) of `b`, within 10 mm, along
/// at least a third of it.
pub fn touches(b: &Candidate, other: &Candidate, side: usize, pitch: f64) -> bool {
    let axis = side / 2;
    let reach = (TOUCHES / pitch).ceil() as isize;
    let (first, last) = (
        b.first[axis] as isize,
        (b.first[axis] + b.cells[axis]) as isize,
    );
    let (other_first, other_last) = (
        other.first[axis] as isize,
        (other.first[axis] + other.cells[axis]) as isize,
    );
    let distance = if side.is_multiple_of(2) {
        first - other_last
    } else {
        other_first - last
    };
    let across = 1 - axis;
    let low = b.first[across].max(other.first[across]);
    let high = (b.first[across] + b.cells[across]).min(other.first[across] + other.cells[across]);
    distance.abs() <= reach
        && high.saturating_sub(low) * 3 >= b.cells[across].min(other.cells[across])
}
