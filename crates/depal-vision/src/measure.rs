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
/// Share of cells on a column or row from which it belongs to the rectangle.
const INSIDE: f64 = 0.5;

/// The one rectangle that a patch is, if it is one.
pub fn measure_whole(
    patch: &Patch,
    image: &DepthImage,
    settings: &VisionSettings,
    area: f64,
) -> Result<DetectedBox, RejectedSurface> {
    let reject = |reason| RejectedSurface {
        reason,
        centre_in_camera: patch.frame.origin,
        area,
    };
    let candidate = rectangle(patch).ok_or_else(|| reject(RejectReason::NoKnownSize))?;
    if has_seam(patch, &candidate) {
        return Err(reject(RejectReason::Ambiguous));
    }
    let extents = candidate.cells.map(|n| n as f64 * patch.pitch);
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

/// Bounds of the columns and rows that are mostly surface; `None` when they are not one filled block.
fn rectangle(patch: &Patch) -> Option<Candidate> {
    let (columns, rows) = (patch.columns as isize, patch.rows as isize);
    // The share is taken within the rows that hold anything at all.
    let occupied = |share: &dyn Fn(isize) -> f64, count: isize| {
        let first = (0..count).find(|&k| share(k) > 0.0)?;
        let last = (0..count).rev().find(|&k| share(k) > 0.0)?;
        Some((first, last + 1))
    };
    let (j0, j1) = occupied(&|j| thin(patch.shares(0, j, columns, j + 1).0), rows)?;
    let (i0, i1) = occupied(&|i| thin(patch.shares(i, 0, i + 1, rows).0), columns)?;
    let column = |i: isize| patch.shares(i, j0, i + 1, j1).0 > INSIDE;
    let row = |j: isize| patch.shares(i0, j, i1, j + 1).0 > INSIDE;
    let left = (i0..i1).find(|&i| column(i))?;
    let right = (i0..i1).rev().find(|&i| column(i))? + 1;
    let low = (j0..j1).find(|&j| row(j))?;
    let high = (j0..j1).rev().find(|&j| row(j))? + 1;
    let (width, height) = ((right - left) as usize, (high - low) as usize);
    let filled = patch.shares(left, low, right, high).0 >= WHOLE - 0.03;
    (filled && width >= 24 && height >= 24).then_some(Candidate {
        label: 0,
        turned: height > width,
        first: [left as usize, low as usize],
        cells: [width, height],
        sides: [0.0; 4],
        score: 0.0,
    })
}

/// A line with less than a twentieth of surface holds only strays of its neighbours.
fn thin(share: f64) -> f64 {
    if share < 0.05 { 0.0 } else { share }
}
