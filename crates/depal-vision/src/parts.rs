//! Cartons of several known sizes in one dictionary: two of one may cover just what one of another does. Where
//! cartons lie at different heights, what makes one plane is one carton.

use depal_frames::BoxSize;

use crate::{
    VisionSettings,
    breaks::BY_CHANCE,
    patch::BLOCK,
    relief::Relief,
    seams::SEEN_SEAM,
    search::{Candidate, extents},
};

/// True when `finer` only parts cartons of `coarser` into smaller ones, and their heights do not ask for it.
pub fn is_needless(
    finer: &[Candidate],
    coarser: &[Candidate],
    relief: &Relief,
    noise: f64,
) -> bool {
    let beyond = |c: &Candidate| {
        let plane = relief.misfit(&[*c]);
        plane.squares - noise * plane.blocks as f64
    };
    only_parts(finer, coarser, |whole, parts| {
        let apart: f64 = parts.iter().map(|c| beyond(c)).sum();
        beyond(whole) - apart < BY_CHANCE * noise * (parts.len() - 1) as f64
    })
}

/// True when `finer` has all cartons of `coarser`, some of them as smaller ones without a seam between them, and what
/// is asked of each of those (the whole and its parts) holds.
pub fn only_parts(
    finer: &[Candidate],
    coarser: &[Candidate],
    holds: impl Fn(&Candidate, &[&Candidate]) -> bool,
) -> bool {
    finer.len() > coarser.len()
        && coarser.iter().all(|whole| {
            if finer.iter().any(|c| c.is_like(whole)) {
                return true;
            }
            let parts: Vec<&Candidate> = finer.iter().filter(|c| c.overlap(whole) > 0.9).collect();
            let covered: f64 = parts.iter().map(|c| whole.overlap(c)).sum();
            parts.len() > 1
                && covered > 0.9
                && parts.iter().all(|c| inner_edge(c, whole) < SEEN_SEAM)
                && holds(whole, &parts)
        })
}

/// The most edge along a side of a part that is none of the whole's.
fn inner_edge(part: &Candidate, whole: &Candidate) -> f64 {
    (0..4usize)
        .filter(|&side| {
            let axis = side / 2;
            let line = |c: &Candidate| {
                if side.is_multiple_of(2) {
                    c.first[axis]
                } else {
                    c.first[axis] + c.cells[axis]
                }
            };
            line(part).abs_diff(line(whole)) > 6
        })
        .map(|side| part.sides[side])
        .fold(0.0, f64::max)
}

/// True when `part` lies within `whole`, no seam parts it from the rest of that, and the rest is wide enough that
/// heights would.
pub fn is_part(part: &Candidate, whole: &Candidate) -> bool {
    /// Cells by which two that end at the same line may differ, and the least width of a rest.
    const SAME: usize = 6;
    const LEAST_REST: usize = 4 * BLOCK;
    let area = |c: &Candidate| c.cells[0] * c.cells[1];
    let tells = |k: usize| {
        let end = |c: &Candidate| c.first[k] + c.cells[k];
        [
            part.first[k].abs_diff(whole.first[k]),
            end(part).abs_diff(end(whole)),
        ]
        .iter()
        .all(|&off| off <= SAME || off >= LEAST_REST)
    };
    area(part) < area(whole)
        && part.overlap(whole) > 0.9
        && tells(0)
        && tells(1)
        && inner_edge(part, whole) < SEEN_SEAM
}

/// True when smaller cartons of known sizes side by side cover just what one of size `label` does.
pub fn made_of_others(settings: &VisionSettings, label: usize) -> bool {
    /// Gaps make them longer together, metres.
    const GAPS: f64 = 0.004;
    let slack = settings.size_tolerance + GAPS;
    let size = &settings.sizes[label];
    settings.sizes.len() > 1 && fills(&settings.sizes, size, [size.length, size.width], slack)
}

/// True when cartons smaller than `whole` fill a rectangle, cut from side to side again and again.
fn fills(sizes: &[BoxSize], whole: &BoxSize, rectangle: [f64; 2], slack: f64) -> bool {
    let area = |s: &BoxSize| s.length * s.width;
    sizes
        .iter()
        .filter(|s| area(s) < 0.9 * area(whole))
        .flat_map(|s| [extents(s, false), extents(s, true)])
        .any(|piece| {
            (0..2).any(|axis| {
                let across = 1 - axis;
                let rest = rectangle[axis] - piece[axis];
                let same = (rectangle[across] - piece[across]).abs() <= slack;
                let mut beyond = rectangle;
                beyond[axis] = rest;
                same && (rest.abs() <= slack || rest > slack && fills(sizes, whole, beyond, slack))
            })
        })
}

/// True when a larger known size covers all of one of size `label`.
pub fn is_within_another(sizes: &[BoxSize], label: usize) -> bool {
    let size = &sizes[label];
    sizes.iter().any(|other| {
        other.length * other.width > 1.1 * size.length * size.width
            && other.length >= size.length
            && other.width >= size.width
    })
}
