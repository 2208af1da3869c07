//! Stage 7c: tops of unknown size, where all four sides fall away.

use crate::{
    DetectedBox, RejectReason, RejectedSurface, VisionSettings,
    gate::DepthImage,
    patch::Patch,
    search::{Candidate, has_seam},
    verify::{Proof, verify_measured},
};

/// Least short side of a carton, metres: deck boards and rails are narrower.
const LEAST_SIDE: f64 = 0.10;
/// Greatest long side of a carton, metres: a slip sheet is larger.
const MOST_SIDE: f64 = 0.80;
/// Share of the bounding rectangle that must be surface: an L of three cartons has 0.75.
const WHOLE: f64 = 0.93;
/// The one rectangle that a patch is, if it is one. The patch reaches `margin` metres beyond the surface,
/// and its neighbours show in there.
pub fn measure_whole(
    patch: &Patch,
    image: &DepthImage,
    settings: &VisionSettings,
    area: f64,
    margin: f64,
) -> Result<DetectedBox, RejectedSurface> {
    let reject = |reason| RejectedSurface {
        reason,
        centre_in_camera: patch.frame.origin,
        area,
    };
    let candidate = rectangle(patch, margin).ok_or_else(|| reject(RejectReason::NoKnownSize))?;
    if has_seam(patch, &candidate) {
        return Err(reject(RejectReason::Ambiguous));
    }
    // The mask ends two pixels inside the real border.
    let extents = candidate.cells.map(|n| (n as f64 + 4.0) * patch.pitch);
    let (long, short) = (extents[0].max(extents[1]), extents[0].min(extents[1]));
    if short < LEAST_SIDE || long > MOST_SIDE {
        return Err(reject(RejectReason::NoKnownSize));
    }
    let (x, y) = candidate.centre(patch);
    let start = crate::plane::PlaneFrame {
        origin: patch.frame.point(x, y),
        ..patch.frame
    };
    // The second time from the sides that the first has measured.
    let (_, extents) =
        verify_measured(image, settings, start, extents, Proof::Outline).map_err(reject)?;
    let (found, _) =
        verify_measured(image, settings, start, extents, Proof::Outline).map_err(reject)?;
    if found.proven_sides < 4 || found.visible_fraction < WHOLE {
        return Err(reject(RejectReason::NoKnownSize));
    }
    Ok(found)
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
