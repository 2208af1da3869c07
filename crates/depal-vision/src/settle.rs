//! Stage 7e: where the cartons of an arrangement start their exact fit.

use crate::{
    VisionSettings,
    gate::DepthImage,
    patch::Patch,
    plane::PlaneFrame,
    seams::touches,
    search::{Candidate, extents, sides_with_edges},
    sides::{Fitting, ROUGHLY, fit_rectangle},
    verify::{LEAST_SEEN, TURN_SEEN},
};

/// Where an arranged box starts its exact fit: along an axis with a seen side from that side, else
/// midway between its neighbours, which share the slack of the row equally.
pub fn settle(
    image: &DepthImage,
    settings: &VisionSettings,
    patch: &Patch,
    arranged: &[Candidate],
    fixed: &[Candidate],
) -> Vec<(Candidate, PlaneFrame)> {
    const ROUNDS: usize = 60;
    let all: Vec<Candidate> = arranged.iter().chain(fixed).copied().collect();
    let half =
        |c: &Candidate| extents(&settings.sizes[c.label as usize], c.turned).map(|e| e / 2.0);
    let mut centres = Vec::new();
    let mut held = Vec::new();
    let mut turns = Vec::new();
    for candidate in &all {
        let start = start_frame(patch, candidate);
        let sides = half(candidate).map(|h| 2.0 * h);
        let fit = fit_rectangle(
            image,
            start,
            sides,
            settings.plane_tolerance,
            &Fitting {
                least_seen: LEAST_SEEN,
                turn_seen: TURN_SEEN,
                least_turning: 1,
                passes: ROUGHLY,
                sides: sides_with_edges(patch, candidate),
            },
        );
        // A line's direction is known the better the longer it is and the more of it is seen.
        let weight: f64 = (0..4)
            .filter(|&k| fit.sides[k].seen >= TURN_SEEN)
            .map(|k| fit.sides[k].seen * sides[1 - k / 2].powi(3))
            .sum();
        if weight > 0.0 {
            let x = fit.frame.x;
            turns.push((x.dot(&patch.frame.y).atan2(x.dot(&patch.frame.x)), weight));
        }
        let offset = fit.frame.origin - patch.frame.origin;
        centres.push([offset.dot(&patch.frame.x), offset.dot(&patch.frame.y)]);
        held.push([0, 1].map(|axis: usize| {
            fit.sides[2 * axis].seen >= LEAST_SEEN || fit.sides[2 * axis + 1].seen >= LEAST_SEEN
        }));
    }
    // Of each box and axis that nothing holds: its neighbours, and how far from each its centre lies.
    let mut free: Vec<(usize, usize, Vec<(usize, f64)>)> = Vec::new();
    for (b, one) in all.iter().enumerate() {
        for axis in (0..2).filter(|&axis| !held[b][axis]) {
            let mut beside = Vec::new();
            for (o, other) in all.iter().enumerate() {
                for (side, sign) in [(2 * axis, 1.0), (2 * axis + 1, -1.0)] {
                    if o != b && touches(one, other, side, patch.pitch) {
                        beside.push((o, sign * (half(other)[axis] + half(one)[axis])));
                    }
                }
            }
            free.push((b, axis, beside));
        }
    }
    for _ in 0..ROUNDS {
        for (b, axis, beside) in free.iter().filter(|(_, _, beside)| !beside.is_empty()) {
            let places = beside.iter().map(|(o, apart)| centres[*o][*axis] + apart);
            centres[*b][*axis] = places.sum::<f64>() / beside.len() as f64;
        }
    }
    // Boxes that hang together share their direction; outer sides show it best.
    let turned = patch.frame.turned(shared_turn(&mut turns));
    arranged
        .iter()
        .zip(centres)
        .map(|(candidate, [x, y])| {
            (
                *candidate,
                PlaneFrame {
                    origin: patch.frame.point(x, y),
                    ..turned
                },
            )
        })
        .collect()
}

/// Weighted mean of (turn, weight) close to their median; 0 of none.
fn shared_turn(turns: &mut [(f64, f64)]) -> f64 {
    const CLOSE: f64 = 0.01;
    turns.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some(&(median, _)) = turns.get(turns.len() / 2) else {
        return 0.0;
    };
    let close = turns.iter().filter(|t| (t.0 - median).abs() <= CLOSE);
    let (sum, weight) = close.fold((0.0, 0.0), |s, t| (s.0 + t.0 * t.1, s.1 + t.1));
    sum / weight
}

/// A candidate's rectangle: origin in its middle, axes of the patch.
pub fn start_frame(patch: &Patch, candidate: &Candidate) -> PlaneFrame {
    let (x, y) = candidate.centre(patch);
    PlaneFrame {
        origin: patch.frame.point(x, y),
        ..patch.frame
    }
}
