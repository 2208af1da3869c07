//! Stage 7c: tops of unknown size, where all four sides fall away.

use depal_frames::{BoxSize, Pose};

use crate::{
    DetectedBox, RejectReason, RejectedSurface, VisionSettings,
    arrange::UNEVEN,
    beyond::beyond,
    ends::surface_end,
    gate::DepthImage,
    parted::{Parting, parting},
    patch::Patch,
    plane::PlaneFrame,
    search::{Candidate, has_seam},
    support::{Measured, Standing},
    verify::{Proof, verify_measured},
};

/// Least short side of a carton, metres: deck boards and rails are narrower.
const LEAST_SIDE: f64 = 0.10;
/// Greatest long side of a carton, metres: a slip sheet is larger.
const MOST_SIDE: f64 = 0.80;
/// Share of the bounding rectangle that must be surface: an L of three cartons has 0.75.
const WHOLE: f64 = 0.93;
/// Cartons of unknown size are told apart by gaps, whose bottom and walls are dark where the projector does not reach
/// them. All four sides of one end as straight as it does; the narrowest tape, which would end as straight, has 36 mm.
const WIDEST_DARK_GAP: f64 = 0.034;
/// Axis and sign of each side.
const SIDES: [(usize, f64); 4] = [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)];

/// The one rectangle that a patch is, if it is one. The patch reaches `margin` metres beyond the surface,
/// and its neighbours show in there.
pub fn measure_whole(
    patch: &Patch,
    image: &DepthImage,
    settings: &VisionSettings,
    area: f64,
    margin: f64,
) -> Result<Measured, RejectedSurface> {
    let reject = |reason| RejectedSurface {
        reason,
        centre_in_camera: patch.frame.origin,
        area,
    };
    let candidate = rectangle(patch, margin).ok_or_else(|| reject(RejectReason::NoKnownSize))?;
    let parting = parting_of(patch, &candidate, settings);
    let reject = |reason| {
        // What parts it is the better reason.
        reject(if parting == Parting::Plain {
            RejectReason::Ambiguous
        } else {
            reason
        })
    };
    // The mask ends two pixels inside the real border.
    let extents = candidate.cells.map(|n| (n as f64 + 4.0) * patch.pitch);
    let (long, short) = (extents[0].max(extents[1]), extents[0].min(extents[1]));
    if short < LEAST_SIDE || long > MOST_SIDE {
        return Err(reject(RejectReason::NoKnownSize));
    }
    let (x, y) = candidate.centre(patch);
    let start = PlaneFrame {
        origin: patch.frame.point(x, y),
        ..patch.frame
    };
    // The second time from the sides that the first has measured.
    let (_, extents, _) =
        verify_measured(image, settings, start, extents, Proof::Outline).map_err(reject)?;
    let (mut found, _, sharp) =
        verify_measured(image, settings, start, extents, Proof::Outline).map_err(reject)?;
    if found.proven_sides < 4 || found.visible_fraction < WHOLE {
        return Err(reject(RejectReason::NoKnownSize));
    }
    let (end, blind) = ending(image, &found, settings.plane_tolerance);
    let standing = match (end, parting) {
        (Ending::Unknown, _) => return Err(reject(RejectReason::NoKnownSize)),
        (_, Parting::Plain) => Standing::Parted,
        (Ending::Certain, Parting::None) => Standing::Certain,
        _ => Standing::InQuestion,
    };
    // A smeared step has no outermost pixel.
    if !settings.is_smeared() {
        let tolerance = sharp.min(settings.plane_tolerance);
        found = measured(image, found, tolerance, patch.pitch);
    }
    Ok(Measured {
        found,
        standing,
        blind,
    })
}

/// Whether a seam or a step runs through it. Where steps are smeared, heights beside them say nothing.
fn parting_of(patch: &Patch, candidate: &Candidate, settings: &VisionSettings) -> Parting {
    if has_seam(patch, candidate) {
        return Parting::Plain;
    }
    if patch.is_smeared() {
        return Parting::None;
    }
    let uneven = settings.plane_tolerance * UNEVEN;
    parting(patch, candidate, LEAST_SIDE, uneven)
}

/// How a surface ends at its four sides.
enum Ending {
    /// At all four, seen.
    Certain,
    /// At all four, if there is a gap before what stands beside it.
    InQuestion,
    /// Something may hide part of it, or it is a sheet.
    Unknown,
}

/// Share of a side that something nearer may hide: the rest says where it is.
const MOST_HIDDEN: f64 = 0.2;
/// Share of a side over which something stands: single lines may err.
const MOST_OVER: f64 = 0.03;

/// True when nothing hides a side of a found box or stands over one.
pub fn is_free(image: &DepthImage, found: &DetectedBox, tolerance: f64) -> bool {
    let frame = PlaneFrame::of_top(found);
    let extents = [found.size.length, found.size.width];
    SIDES.iter().all(|side| {
        let seen = beyond(image, &frame, extents, *side, tolerance, WIDEST_DARK_GAP);
        seen.hidden <= MOST_HIDDEN && seen.over <= MOST_OVER
    })
}

/// How the surface ends at all four sides (whole cartons only), and at which of them what is nearer leaves that open.
fn ending(image: &DepthImage, found: &DetectedBox, tolerance: f64) -> (Ending, [bool; 4]) {
    /// Share of a side at which it must be seen to end: noise and lost pixels leave more of any true side.
    const LEAST_OPEN: f64 = 0.6;
    /// So many sides beneath which something lies close by are those of a sheet; at one, a lower carton may
    /// stand without a gap.
    const SHEET: usize = 2;
    /// Share of what is seen beneath such a side that lies close by: noise takes some of it.
    const MOSTLY_THIN: f64 = 0.5;
    let frame = PlaneFrame::of_top(found);
    let extents = [found.size.length, found.size.width];
    let mut thin = 0;
    let mut blind = [false; 4];
    for (side, blind) in SIDES.into_iter().zip(&mut blind) {
        let seen = beyond(image, &frame, extents, side, tolerance, WIDEST_DARK_GAP);
        if seen.open + seen.narrow + seen.beside < LEAST_OPEN
            || seen.hidden > MOST_HIDDEN
            || seen.over > MOST_OVER
        {
            return (Ending::Unknown, [false; 4]);
        }
        *blind = seen.open < LEAST_OPEN || seen.beside + seen.hidden > MOST_HIDDEN;
        thin += usize::from(seen.thin >= MOSTLY_THIN * seen.open);
    }
    let end = match (thin < SHEET, blind.contains(&true)) {
        (false, _) => Ending::Unknown,
        (true, true) => Ending::InQuestion,
        (true, false) => Ending::Certain,
    };
    (end, blind)
}

/// The same box with its sides where its surface ends.
fn measured(image: &DepthImage, found: DetectedBox, tolerance: f64, pitch: f64) -> DetectedBox {
    let frame = PlaneFrame::of_top(&found);
    let extents = [found.size.length, found.size.width];
    let [left, right, low, high] = SIDES
        .map(|side| surface_end(image, &frame, extents, side, tolerance, pitch).unwrap_or(0.0));
    let middle = frame.point((right - left) / 2.0, (high - low) / 2.0);
    let sides = [extents[0] + left + right, extents[1] + low + high];
    DetectedBox {
        camera_from_box: Pose::from_parts(middle.coords.into(), found.camera_from_box.rotation),
        size: BoxSize {
            length: sides[0].max(sides[1]),
            width: sides[0].min(sides[1]),
            height: 0.0,
        },
        ..found
    }
}

/// The patch without its margin; `None` when that is not one filled block.
fn rectangle(patch: &Patch, margin: f64) -> Option<Candidate> {
    let edge = (margin / patch.pitch).round() as usize;
    let width = patch.columns.checked_sub(2 * edge)?;
    let height = patch.rows.checked_sub(2 * edge)?;
    let filled = patch.surface(
        edge as isize,
        edge as isize,
        (edge + width) as isize,
        (edge + height) as isize,
    );
    let whole = filled >= WHOLE && width >= 24 && height >= 24;
    whole.then_some(Candidate {
        label: 0,
        turned: height > width,
        first: [edge, edge],
        cells: [width, height],
        sides: [0.0; 4],
        score: 0.0,
    })
}
