//! Stage 7e: whether what looks like one top is two that touch. Two cartons are two planes that do not meet at the line
//! between them; a carton that bulges is best explained by two planes that do.

use std::ops::Range;

use crate::{
    patch::{BLOCK, Patch},
    relief::Relief,
    search::Candidate,
};

/// A step stands out from noise by so many deviations of the two fitted planes.
const SIGMAS: f64 = 5.0;
/// Fewer blocks than this make no plane worth looking at.
const LEAST_BLOCKS: usize = 4;

/// What the heights of a top say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parting {
    /// One plane, or a bulge.
    None,
    /// A step that is more than noise and no more than one carton may be uneven.
    Doubtful,
    /// A step: two cartons.
    Plain,
}

/// Cuts a candidate in two where that explains its heights best, and looks whether the two planes meet there. `least`:
/// the shortest side a carton has, metres; `uneven`: how much one carton may deviate from a plane, metres.
pub fn parting(patch: &Patch, candidate: &Candidate, least: f64, uneven: f64) -> Parting {
    let relief = patch.relief();
    let noise = relief.noise(1);
    let blocks = relief.blocks_of(candidate);
    let least = ((least / patch.pitch) as usize / BLOCK)
        .saturating_sub(1)
        .max(LEAST_BLOCKS);
    let Some([low, high]) = best_cut(relief, &blocks, least, noise) else {
        return Parting::None;
    };
    let fit = |r: &[Range<usize>; 2]| relief.fit(r[0].clone(), r[1].clone());
    let (Some(a), Some(b)) = (fit(&low), fit(&high)) else {
        return Parting::None;
    };
    let axis = usize::from(low[0] == high[0]);
    let across = &blocks[1 - axis];
    let mut parting = Parting::None;
    for end in [across.start, across.end.saturating_sub(1)] {
        // The middle of the block left out between the two.
        let mut at = [low[axis].end as f64, end as f64];
        if axis == 1 {
            at.reverse();
        }
        let step = (a.height(at) - b.height(at)).abs();
        let deviation = (noise * (a.spread(at) + b.spread(at))).sqrt();
        if step <= SIGMAS * deviation {
            continue;
        }
        if step > uneven {
            return Parting::Plain;
        }
        parting = Parting::Doubtful;
    }
    parting
}

/// The cut after which two planes leave the least; the block on the cut belongs to neither.
fn best_cut(
    relief: &Relief,
    blocks: &[Range<usize>; 2],
    least: usize,
    noise: f64,
) -> Option<[[Range<usize>; 2]; 2]> {
    let beyond = |r: &[Range<usize>; 2]| {
        let plane = relief.misfit_within(r[0].clone(), r[1].clone());
        plane.squares - noise * plane.blocks as f64
    };
    let mut best: Option<(f64, [[Range<usize>; 2]; 2])> = None;
    for axis in 0..2 {
        let whole = &blocks[axis];
        for cut in whole.start + least..whole.end.saturating_sub(least) {
            let part = |along: Range<usize>| {
                let mut part = blocks.clone();
                part[axis] = along;
                part
            };
            let parts = [part(whole.start..cut), part(cut + 1..whole.end)];
            let left = beyond(&parts[0]) + beyond(&parts[1]);
            if best.as_ref().is_none_or(|(least, _)| left < *least) {
                best = Some((left, parts));
            }
        }
    }
    best.map(|(_, parts)| parts)
}
