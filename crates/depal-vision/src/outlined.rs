//! Stage 5b: the outlines that a search found, each verified.

use crate::{
    DetectedBox, RejectReason, RejectedSurface, VisionSettings,
    arrange::UNEVEN,
    breaks::Breaks,
    doubles::is_doubtful,
    gate::DepthImage,
    patch::Patch,
    search::{Candidate, search},
    settle::start_frame,
    verify::{Proof, verify},
};

/// Searches a patch and verifies what it finds.
pub fn outlined(
    patch: &Patch,
    image: &DepthImage,
    settings: &VisionSettings,
    rejected: &mut Vec<RejectedSurface>,
) -> (Vec<Candidate>, Vec<DetectedBox>) {
    let (mut fixed, mut boxes) = (Vec::new(), Vec::new());
    let candidates = search(patch, &settings.sizes, settings.min_visible);
    // Where steps are smeared, heights beside them say nothing.
    let relief = (!candidates.is_empty() && !patch.is_smeared()).then(|| patch.relief());
    let breaks = relief
        .map(|relief| Breaks::new(relief, relief.noise(1), settings.plane_tolerance * UNEVEN));
    for candidate in candidates {
        let start = start_frame(patch, &candidate);
        match verify(
            image,
            settings,
            start,
            candidate.label,
            candidate.turned,
            Proof::Outline,
        ) {
            Ok(found)
                if !breaks.as_ref().is_some_and(|b| {
                    let doubtful = is_doubtful(image, settings, &found);
                    b.refute(patch, &candidate, doubtful)
                }) =>
            {
                boxes.push(found);
                fixed.push(candidate);
            }
            refused => {
                let reason = refused.err().unwrap_or(RejectReason::NoKnownSize);
                let size = settings.sizes[candidate.label as usize];
                rejected.push(RejectedSurface {
                    reason,
                    centre_in_camera: start.origin,
                    area: size.length * size.width,
                });
            }
        }
    }
    (fixed, boxes)
}
