//! Stage 7b: surfaces on which gaps are too small to be seen are covered exactly by known sizes.

use depal_frames::BoxSize;

use crate::{
    breaks::Breaks,
    cover::{Covering, cover},
    gaps::is_wide,
    gate::DepthImage,
    ink::dark_sides,
    parts::{is_needless, only_parts},
    patch::Patch,
    proven::proven,
    seams::{
        LEAST_LINE, TOUCHES, any_seam, islands, may_be_parts, seams_seen, touches, widest_gap,
    },
    search::Candidate,
    shown::Shown,
    unknown::Unknown,
};

/// A carton may be as uneven as this share of the plane tolerance: 0.13 mm by default.
pub const UNEVEN: f64 = 1.0 / 30.0;
/// And as this multiple of the noise says.
const MOST_NOISE: f64 = 1.5;
/// A reading must beat every different one by this much edge per box, else it is ambiguous.
const CLEAR_LEAD: f64 = 0.05;
/// The same where heights say nothing: which outer sides a box has is no reason, seams between are.
const CLEAR_LEAD_WHEN_LEVEL: f64 = 0.3;
/// One plane must explain a surface worse by this factor than its cartons do, else it is level.
const UNLEVEL: f64 = 1.3;
/// Fewer cartons than this without a seam between them are doubtful.
const LEAST_WITHOUT_SEAM: usize = 3;

/// Share of edge along each side of a lone carton that a piece of floor has by no chance.
const FRAMED: f64 = 0.8;
/// A reading of whose inner sides so many show a seam needs no other proof.
const MOST_SEAMS: f64 = 0.7;

/// What covers a surface.
pub struct Arrangement {
    /// The new boxes (those given as fixed are not repeated).
    pub boxes: Vec<Candidate>,
    /// Other coverings explain the surface equally well; `boxes` is what all of them share.
    pub ambiguous: bool,
    /// The heights show that this is more than one plane, or no other reading fits the outline.
    pub unique: bool,
    /// Edges and heights prove each of the boxes by itself.
    pub each_proven: bool,
    /// Nothing tells it from a floor or a sheet: one level surface without a seam.
    pub plain: bool,
}

/// A surface that is to be covered.
pub struct Open<'a> {
    pub patch: &'a Patch,
    pub image: &'a DepthImage<'a>,
    /// How far a pixel may lie from its carton's plane, metres.
    pub tolerance: f64,
    /// The known sizes.
    pub sizes: &'a [BoxSize],
    /// Which of them stand proven beside the patch.
    pub beside: &'a [u32],
}

/// Covers what `fixed` leaves uncovered. `None` when the known sizes cannot cover it.
pub fn arrange(open: &Open, fixed: &[Candidate]) -> Option<Arrangement> {
    let Open {
        patch,
        image,
        tolerance,
        ..
    } = *open;
    // Where steps are smeared, so are the heights beside them; and a plane has none.
    if patch.is_smeared() || is_one_plane(patch) {
        return arrange_with(open, fixed, false);
    }
    if let Some(exact) = arrange_with(open, fixed, true) {
        return Some(exact);
    }
    let unknown = Unknown::new(image, patch, tolerance);
    let relief = patch.relief();
    let shown = Shown {
        image,
        patch,
        tolerance,
        relief,
        breaks: &Breaks::new(
            relief,
            relief.noise(1).max(relief.noise(2)),
            tolerance * UNEVEN,
        ),
        unknown: &unknown,
    };
    let boxes = proven(&shown, open.sizes, fixed, open.beside);
    (!boxes.is_empty()).then_some(Arrangement {
        boxes,
        ambiguous: true,
        unique: true,
        each_proven: true,
        plain: false,
    })
}

/// True when all heights of a patch make one plane, as those of a pallet or a floor do: nothing proves a carton there.
fn is_one_plane(patch: &Patch) -> bool {
    let relief = patch.relief();
    let all = Candidate {
        label: 0,
        turned: false,
        first: [0, 0],
        cells: [patch.columns, patch.rows],
        sides: [0.0; 4],
        score: 0.0,
    };
    let plane = relief.misfit(&[all]);
    plane.squares < UNLEVEL * relief.noise(1) * plane.blocks as f64
}

/// `unbroken`: no height break runs through a carton.
fn arrange_with(open: &Open, fixed: &[Candidate], unbroken: bool) -> Option<Arrangement> {
    let Open {
        patch,
        image,
        tolerance,
        sizes,
        beside,
    } = *open;
    let uneven = tolerance * UNEVEN;
    let relief = patch.relief();
    let Covering { least, readings } = cover(patch, sizes, fixed, unbroken.then_some(uneven))?;
    // Even the best reading leaves steps in the middle of cartons: the right one is not among them.
    let noise = lags(patch).iter().map(|&lag| relief.noise(lag));
    let most = MOST_NOISE * noise.fold(0.0, f64::max) + uneven * uneven;
    if least.squares > most * least.blocks as f64 {
        return None;
    }
    let as_one = relief.misfit(readings.first()?);
    let level = patch.averaged || as_one.squares < UNLEVEL * least.mean() * as_one.blocks as f64;
    // Heights prove nothing on a level surface, nor do breaks.
    if unbroken && level {
        return arrange_with(open, fixed, false);
    }
    let lead = if level {
        CLEAR_LEAD_WHEN_LEVEL
    } else {
        CLEAR_LEAD
    };
    let mut unique = !level || readings.len() == 1;
    let mut readings: Vec<Vec<Candidate>> = readings
        .into_iter()
        .map(|r| r[fixed.len()..].to_vec())
        .filter(|r| !r.is_empty())
        .collect();
    // Where cartons lie at different heights, two that make one plane are one, if there is one of that size.
    if !level {
        let all = readings.clone();
        readings.retain(|finer| {
            !all.iter()
                .any(|coarser| is_needless(finer, coarser, relief, least.mean()))
        });
    }
    // Lines in the intensity image are seams as well.
    let mut lined: Vec<(Candidate, [f64; 4])> = Vec::new();
    for b in readings.iter_mut().flatten() {
        let same =
            |known: &&(Candidate, [f64; 4])| known.0.first == b.first && known.0.cells == b.cells;
        let dark = if let Some(known) = lined.iter().find(same) {
            known.1
        } else {
            let dark = dark_sides(patch, image, b);
            lined.push((*b, dark));
            dark
        };
        for (side, dark) in b.sides.iter_mut().zip(dark) {
            if dark >= LEAST_LINE {
                *side = side.max(dark);
            }
        }
    }
    let merit = |r: &Vec<Candidate>| merit(r, fixed, patch.pitch);
    readings.sort_by(|a, b| merit(b).total_cmp(&merit(a)));
    let best = readings.first()?.clone();
    let breaks = Breaks::new(relief, relief.noise(1), uneven);
    unique |= seams_seen(&best, patch.pitch) >= MOST_SEAMS;
    // One carton in a pit of higher ones, or among others, stands on nothing that is seen, but all its sides are, or
    // another one begins there.
    let framed = best.len() == 1
        && (0..4).all(|k| best[0].sides[k] >= FRAMED || meets_found(patch, &best[0], k, fixed));
    let plain = level && !any_seam(&best, patch.pitch) && !framed;
    // What nothing but its outline tells from a sheet must end where the cartons do, all around.
    if plain && !patch.is_smeared() && !is_outlined(&best, fixed, patch.pitch) {
        return None;
    }
    let narrow = !is_wide(widest_gap(patch, &best), patch.pitch);
    let rivals: Vec<&Vec<Candidate>> = readings[1..]
        .iter()
        .filter(|r| {
            // A seam not seen is none only where gaps are wide: else heights alone tell two cartons from one.
            narrow && only_parts(r, &best, |_, _| true)
                || merit(r) > merit(&best) - lead && !same(&best, r)
        })
        .collect();
    if !rivals.is_empty() {
        // A level sheet can be covered in several ways, of which only some were tried: no proof.
        let shared = best
            .iter()
            .filter(|_| !level)
            .filter(|b| rivals.iter().all(|r| r.iter().any(|o| b.is_like(o))))
            .copied()
            .collect();
        return Some(Arrangement {
            boxes: shared,
            ambiguous: true,
            unique: false,
            each_proven: false,
            plain,
        });
    }
    // Cartons joined without any seam seen may as well be one larger carton, unless one of that
    // size stands proven beside them, or there are many of them and the gaps that are seen are so
    // narrow that others may well be invisible.
    let islands = islands(&best, patch, &breaks, !level && !patch.is_smeared());
    let together = |b: usize| islands.iter().filter(|&&i| i == islands[b]).count();
    // Halves of cartons lie level in twos, all of them; whole ones only by chance.
    let whole = level || patch.is_smeared() || !may_be_parts(&best, &islands, patch.pitch);
    let believable = |b: usize| {
        together(b) == 1
            || narrow && whole && best.len() >= LEAST_WITHOUT_SEAM
            || fixed.iter().any(|f| f.label == best[b].label)
            || beside.contains(&best[b].label)
    };
    let kept: Vec<Candidate> = (0..best.len())
        .filter(|&b| believable(b))
        .map(|b| best[b])
        .collect();
    if kept.len() < best.len() {
        return Some(Arrangement {
            boxes: kept,
            ambiguous: true,
            unique: false,
            each_proven: false,
            plain,
        });
    }
    Some(Arrangement {
        boxes: best,
        ambiguous: false,
        unique,
        each_proven: false,
        plain,
    })
}

/// Distances in blocks over which noise is measured: that of a camera that smears goes on over many pixels.
fn lags(patch: &Patch) -> &'static [usize] {
    if patch.is_smeared() { &[1, 2, 4] } else { &[1] }
}

/// Edge seen along the sides of the boxes, in sides per box. Counted by length, and the outline as all seen: it is
/// then the same for all readings, whether their outer rows lie a cell off or not, and only seams between boxes make
/// one better.
fn merit(boxes: &[Candidate], fixed: &[Candidate], pitch: f64) -> f64 {
    let (mut seen, mut whole) = (0.0, 0.0);
    for b in boxes {
        let meets = |side: usize| {
            let all = boxes.iter().chain(fixed);
            all.filter(|o| o.first != b.first)
                .any(|o| touches(b, o, side, pitch))
        };
        for (side, share) in b.sides.iter().enumerate() {
            let length = b.cells[1 - side / 2] as f64;
            let share = if meets(side) { *share } else { 1.0 };
            seen += share * length;
            whole += length;
        }
    }
    4.0 * seen / f64::max(whole, 1.0)
}

/// True when the surface ends along each side at which no other carton begins.
fn is_outlined(boxes: &[Candidate], fixed: &[Candidate], pitch: f64) -> bool {
    const MOSTLY: f64 = 0.5;
    let others = |b: &Candidate, side: usize| {
        let all = boxes.iter().chain(fixed);
        all.filter(|o| o.first != b.first)
            .any(|o| touches(b, o, side, pitch))
    };
    boxes
        .iter()
        .all(|b| (0..4).all(|side| b.sides[side] >= MOSTLY || others(b, side)))
}

/// True when along a side stands what was found before.
fn meets_found(patch: &Patch, b: &Candidate, side: usize, fixed: &[Candidate]) -> bool {
    /// Share of the side along which it does.
    const MET: f64 = 0.6;
    const SAMPLES: usize = 20;
    let (axis, across) = (side / 2, 1 - side / 2);
    let (x, y) = b.centre(patch);
    let half = b.cells.map(|n| 0.5 * n as f64 * patch.pitch);
    let out = half[axis] + TOUCHES;
    let met = (0..SAMPLES).filter(|n| {
        let mut at = [x, y];
        at[axis] += if side.is_multiple_of(2) { -out } else { out };
        at[across] += half[across] * (2.0 * (*n as f64 + 0.5) / SAMPLES as f64 - 1.0);
        let cell = [
            (at[0] - patch.left) / patch.pitch,
            (at[1] - patch.bottom) / patch.pitch,
        ];
        patch.blanks.iter().any(|blank| blank.holds(at[0], at[1]))
            || fixed.iter().any(|f| f.holds(cell))
    });
    met.count() as f64 >= MET * SAMPLES as f64
}

fn same(a: &[Candidate], b: &[Candidate]) -> bool {
    a.len() == b.len() && a.iter().all(|x| b.iter().any(|y| x.is_like(y)))
}
