//! Stage 7: rectangles of the known sizes whose sides show edges, by exhaustive search.

use depal_frames::BoxSize;

use crate::patch::Patch;

/// A side counts as seen from this share of edge on. Lone holes and noise give 0.02 anywhere; a
/// 1 mm gap seen with 2 mm pixels, along which both camera and projector look, gives 0.2.
pub const SEEN: f64 = 0.15;
/// Within a carton this share is a seam: more careful than for its sides.
const SEAM: f64 = 0.1;

/// A rectangle of cells with a known size.
#[derive(Debug, Clone, Copy)]
pub struct Candidate {
    pub label: u32,
    /// True when the long side lies along the patch's Y.
    pub turned: bool,
    /// First column and row.
    pub first: [usize; 2],
    /// Columns and rows.
    pub cells: [usize; 2],
    /// Edge shares: -X, +X, -Y, +Y.
    pub sides: [f64; 4],
    pub score: f64,
}

impl Candidate {
    /// True when both are the same carton, give or take some cells.
    pub fn is_like(&self, other: &Self) -> bool {
        self.label == other.label
            && self.turned == other.turned
            && (0..2).all(|k| self.first[k].abs_diff(other.first[k]) <= 6)
    }

    /// True of a place inside, cells.
    pub fn holds(&self, at: [f64; 2]) -> bool {
        (0..2).all(|k| {
            let from_first = at[k] - self.first[k] as f64;
            (0.0..self.cells[k] as f64).contains(&from_first)
        })
    }

    /// Middle in plane coordinates of the patch's frame.
    pub fn centre(&self, patch: &Patch) -> (f64, f64) {
        (
            patch.left + (self.first[0] as f64 + self.cells[0] as f64 / 2.0) * patch.pitch,
            patch.bottom + (self.first[1] as f64 + self.cells[1] as f64 / 2.0) * patch.pitch,
        )
    }

    /// Share of this rectangle that also belongs to the other one.
    pub fn overlap(&self, other: &Self) -> f64 {
        let common = |k: usize| {
            let high = (self.first[k] + self.cells[k]).min(other.first[k] + other.cells[k]);
            high.saturating_sub(self.first[k].max(other.first[k])) as f64
        };
        common(0) * common(1) / (self.cells[0] * self.cells[1]) as f64
    }
}

/// Sides of a size along the patch's axes, metres.
pub fn extents(size: &BoxSize, turned: bool) -> [f64; 2] {
    if turned {
        [size.width, size.length]
    } else {
        [size.length, size.width]
    }
}

/// Share of edge along one side (-X, +X, -Y, +Y), its ends left out, `off` cells farther along the axis.
pub fn side_edge(
    patch: &Patch,
    first: [usize; 2],
    cells: [usize; 2],
    side: usize,
    off: isize,
) -> f64 {
    let [i0, j0] = first;
    let [a, b] = cells;
    let (si0, si1) = (i0 + left_out(a), i0 + a - left_out(a));
    let (sj0, sj1) = (j0 + left_out(b), j0 + b - left_out(b));
    match side {
        0 => patch.vertical_edge(i0 as isize - 1 + off, sj0, sj1),
        1 => patch.vertical_edge((i0 + a) as isize + off, sj0, sj1),
        2 => patch.horizontal_edge(j0 as isize - 1 + off, si0, si1),
        _ => patch.horizontal_edge((j0 + b) as isize + off, si0, si1),
    }
}

/// Cells at each end of a side that do not count: corners are round and hidden.
pub fn left_out(cells: usize) -> usize {
    cells / 20
}

/// Sides of a candidate along which, give or take three cells, there is any edge to be fitted.
pub fn sides_with_edges(patch: &Patch, candidate: &Candidate) -> [bool; 4] {
    /// A third of what a side must show to count as seen.
    const ANY: f64 = 0.05;
    [0, 1, 2, 3].map(|side| {
        (-3..=3).any(|off| side_edge(patch, candidate.first, candidate.cells, side, off) >= ANY)
    })
}

/// Measures one placement; `None` when it is not a whole surface.
pub fn measure(
    patch: &Patch,
    label: u32,
    turned: bool,
    first: [usize; 2],
    cells: [usize; 2],
    min_visible: f64,
) -> Option<Candidate> {
    let [i0, j0] = first;
    let [a, b] = cells;
    let (i1, j1) = (i0 + a, j0 + b);
    if i1 > patch.columns || j1 > patch.rows {
        return None;
    }
    let rim = patch.rim as isize;
    let (left, right) = (i0 as isize + rim, i1 as isize - rim);
    let (low, high) = (j0 as isize + rim, j1 as isize - rim);
    let on = patch.surface(left, low, right, high);
    if on < min_visible
        || patch.deep(
            i0 + patch.rim,
            j0 + patch.rim,
            i1 - patch.rim,
            j1 - patch.rim,
        ) > 0.01
    {
        return None;
    }
    // Just inside each side there must be surface: this pins the rectangle to the outline.
    let inner = [
        patch.surface(left, low, left + 2, high),
        patch.surface(right - 2, low, right, high),
        patch.surface(left, low, right, low + 2),
        patch.surface(left, high - 2, right, high),
    ];
    let sides = [0, 1, 2, 3].map(|side| side_edge(patch, first, cells, side, 0));
    let score = sides.iter().zip(inner).map(|(e, s)| e * s).sum::<f64>() + 0.1 * on;
    Some(Candidate {
        label,
        turned,
        first,
        cells,
        sides,
        score,
    })
}

/// True when a line of edge runs through the inside with surface on both sides of it: a seam
/// between two cartons. A wide stripe without measurement (tape) is none.
pub fn has_seam(patch: &Patch, candidate: &Candidate) -> bool {
    const MARGIN: usize = 8;
    const BESIDE: isize = 5;
    let [i0, j0] = candidate.first;
    let (i1, j1) = (i0 + candidate.cells[0], j0 + candidate.cells[1]);
    let (si0, si1) = (i0 + 4, i1 - 4);
    let (sj0, sj1) = (j0 + 4, j1 - 4);
    // Holes that go on beside the line (tape across it) are none of its own.
    let stands_out = |edge: f64, before: f64, after: f64| {
        let beside = before.min(after);
        beside > 0.7 && edge > SEAM + (1.0 - beside)
    };
    let across = (i0 + MARGIN..i1 - MARGIN.min(i1)).any(|i| {
        let k = i as isize;
        let edge = patch.vertical_edge(k, sj0, sj1);
        let (low, high) = (sj0 as isize, sj1 as isize);
        edge > SEAM
            && stands_out(
                edge,
                patch.surface(k - BESIDE - 3, low, k - BESIDE, high),
                patch.surface(k + BESIDE, low, k + BESIDE + 3, high),
            )
    });
    let along = (j0 + MARGIN..j1 - MARGIN.min(j1)).any(|j| {
        let k = j as isize;
        let edge = patch.horizontal_edge(k, si0, si1);
        let (low, high) = (si0 as isize, si1 as isize);
        edge > SEAM
            && stands_out(
                edge,
                patch.surface(low, k - BESIDE - 3, high, k - BESIDE),
                patch.surface(low, k + BESIDE, high, k + BESIDE + 3),
            )
    });
    across || along
}

/// True when the surface does not simply go on beyond side `k` (-X, +X, -Y, +Y): something hides it.
pub fn is_hidden(patch: &Patch, candidate: &Candidate, side: usize) -> bool {
    const REACH: isize = 6;
    let [i0, j0] = candidate.first.map(|v| v as isize);
    let (i1, j1) = (
        i0 + candidate.cells[0] as isize,
        j0 + candidate.cells[1] as isize,
    );
    let on = match side {
        0 => patch.surface(i0 - REACH, j0, i0, j1),
        1 => patch.surface(i1, j0, i1 + REACH, j1),
        2 => patch.surface(i0, j0 - REACH, i1, j0),
        _ => patch.surface(i0, j1, i1, j1 + REACH),
    };
    on < 0.3
}

/// Candidates with at least three seen sides, none overlapping a better one or what was left out
/// of the patch, best first.
pub fn search(patch: &Patch, sizes: &[BoxSize], min_visible: f64) -> Vec<Candidate> {
    /// Share of a candidate that may lie in a blank: what was cut out hides nothing.
    const MOST_BLANK: f64 = 0.08;
    const STRIDE: usize = 2;
    const LEAST_SIDES: u8 = 3;
    /// So many places are passed over at once; a multiple of the stride.
    const PART: usize = 32;
    const MOST: usize = 20_000;
    let mut found: Vec<Candidate> = Vec::new();
    let mut seen = Vec::new();
    for (label, size) in sizes.iter().enumerate() {
        for turned in [false, true] {
            if turned && size.length - size.width < patch.pitch {
                continue;
            }
            let cells = extents(size, turned).map(|side| (side / patch.pitch).round() as usize);
            if cells.iter().any(|&n| n < 24) || cells[0] > patch.columns || cells[1] > patch.rows {
                continue;
            }
            for j in (0..=patch.rows - cells[1]).step_by(STRIDE) {
                patch.seen_sides(j, cells, SEEN * 0.75, &mut seen);
                for (n, part) in seen.chunks(PART).enumerate() {
                    // There are few.
                    if part.iter().fold(0, |most, &sides| sides.max(most)) < LEAST_SIDES {
                        continue;
                    }
                    for (k, _) in (0..)
                        .zip(part)
                        .step_by(STRIDE)
                        .filter(|(_, sides)| **sides >= LEAST_SIDES)
                    {
                        found.extend(measure(
                            patch,
                            label as u32,
                            turned,
                            [PART * n + k, j],
                            cells,
                            min_visible,
                        ));
                    }
                }
            }
        }
    }
    found.sort_by(|a, b| {
        b.score
            .total_cmp(&a.score)
            .then(a.first.cmp(&b.first))
            .then(a.label.cmp(&b.label))
    });
    found.truncate(MOST);
    let mut kept: Vec<Candidate> = Vec::new();
    let mut failed: Vec<Candidate> = Vec::new();
    for candidate in found {
        let same = |other: &Candidate| {
            other.label == candidate.label
                && other.turned == candidate.turned
                && (0..2).all(|k| other.first[k].abs_diff(candidate.first[k]) <= 3)
        };
        // Those close by have about the same score.
        if failed.iter().rev().any(same)
            || kept
                .iter()
                .any(|k| k.overlap(&candidate) > 0.08 || candidate.overlap(k) > 0.08)
        {
            continue;
        }
        let raw = candidate;
        let candidate = climb(patch, candidate, min_visible, 0.0);
        let seen = candidate.sides.iter().filter(|&&s| s >= SEEN).count();
        if blanked(patch, &candidate) > MOST_BLANK {
            failed.push(raw);
            continue;
        }
        let whole = seen == 4
            || (seen == 3
                && (0..4).all(|k| candidate.sides[k] >= SEEN || is_hidden(patch, &candidate, k)));
        if whole && !has_seam(patch, &candidate) {
            kept.push(candidate);
        } else {
            failed.push(raw);
        }
    }
    kept
}

/// Share of a candidate that lies in what was left out of the patch.
fn blanked(patch: &Patch, candidate: &Candidate) -> f64 {
    const SAMPLES: usize = 16;
    if patch.blanks.is_empty() {
        return 0.0;
    }
    let at = |k: usize, n: usize| {
        let low = if k == 0 { patch.left } else { patch.bottom };
        let share = (n as f64 + 0.5) / SAMPLES as f64;
        low + (candidate.first[k] as f64 + share * candidate.cells[k] as f64) * patch.pitch
    };
    let inside = (0..SAMPLES * SAMPLES)
        .filter(|n| {
            let (x, y) = (at(0, n % SAMPLES), at(1, n / SAMPLES));
            patch.blanks.iter().any(|b| b.holds(x, y))
        })
        .count();
    inside as f64 / (SAMPLES * SAMPLES) as f64
}

/// Moves a candidate cell by cell while each move raises the score by more than `gain`.
pub fn climb(patch: &Patch, mut candidate: Candidate, min_visible: f64, gain: f64) -> Candidate {
    for _ in 0..8 {
        let mut better = candidate;
        for (di, dj) in [(-1isize, 0isize), (1, 0), (0, -1), (0, 1)] {
            let (Some(i), Some(j)) = (
                candidate.first[0].checked_add_signed(di),
                candidate.first[1].checked_add_signed(dj),
            ) else {
                continue;
            };
            if let Some(moved) = measure(
                patch,
                candidate.label,
                candidate.turned,
                [i, j],
                candidate.cells,
                min_visible,
            ) && moved.score > better.score.max(candidate.score + gain)
            {
                better = moved;
            }
        }
        if better.score <= candidate.score {
            break;
        }
        candidate = better;
    }
    candidate
}
