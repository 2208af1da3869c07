//! The cartons of a surface on which not every outline can be seen: what is left is covered by the known sizes.

use super::{Searched, Surface};
use crate::{
    DetectedBox, RejectReason, RejectedSurface, VisionSettings,
    arrange::{Open, arrange},
    gate::DepthImage,
    joint::place_together,
    outlined::outlined,
    search::sides_with_edges,
    settle::settle,
    stands::{goes_on, stands},
    verify::{Proof, verify},
};

impl Surface {
    /// Boxes whose outline can be seen, and those that follow from covering the rest. `beside`: those
    /// already found on the same level, which are no part of it. `proven`: labels of sizes of which some stand proven
    /// anywhere.
    pub fn cover(
        &mut self,
        mask: &[u8],
        image: &DepthImage,
        settings: &VisionSettings,
        beside: &[DetectedBox],
        proven: &[u32],
        rejected: &mut Vec<RejectedSurface>,
    ) -> Vec<DetectedBox> {
        let Searched {
            patch,
            fixed,
            mut boxes,
        } = match self.searched.take() {
            Some(searched) => searched,
            None => match self.patch(mask, image, settings, beside) {
                Ok(patch) => {
                    let (fixed, boxes) = outlined(&patch, image, settings, rejected);
                    Searched {
                        patch,
                        fixed,
                        boxes,
                    }
                }
                Err(background) => {
                    rejected.push(background);
                    return Vec::new();
                }
            },
        };
        let mut labels: Vec<u32> = beside.iter().map(|b| b.label).collect();
        if patch.averaged || self.reach > 0.0 {
            // Such a camera shows few seams, and what leans stands among others: those say which sizes there are.
            labels.extend(proven);
        }
        let open = Open {
            patch: &patch,
            image,
            tolerance: settings.plane_tolerance,
            sizes: &settings.sizes,
            beside: &labels,
        };
        let Some(arrangement) = arrange(&open, &fixed) else {
            if boxes.is_empty() {
                rejected.push(self.rejected(RejectReason::NoKnownSize));
            }
            return boxes;
        };
        if arrangement.ambiguous {
            rejected.push(self.rejected(RejectReason::Ambiguous));
        }
        let goes_on = patch.averaged
            && !arrangement.ambiguous
            && goes_on(&patch, settings, &arrangement.boxes, &fixed);
        if goes_on
            || !stands(
                &patch,
                image,
                settings,
                &arrangement.boxes,
                arrangement.plain,
            )
        {
            rejected.push(self.rejected(RejectReason::NoKnownSize));
            return boxes;
        }
        let mut arranged = Vec::new();
        for (candidate, start) in settle(image, settings, &patch, &arrangement.boxes, &fixed) {
            match verify(
                image,
                settings,
                start,
                candidate.label,
                candidate.turned,
                Proof::Arrangement {
                    sides: sides_with_edges(&patch, &candidate),
                },
            ) {
                Ok(found) => arranged.push((candidate, found)),
                Err(reason) => rejected.push(RejectedSurface {
                    reason,
                    centre_in_camera: start.origin,
                    area: self.area,
                }),
            }
        }
        let seen = arranged.len();
        arranged.extend(fixed.iter().copied().zip(boxes.iter().cloned()));
        place_together(image, settings, &patch, &mut arranged);
        for (placed, (_, moved)) in boxes.iter_mut().zip(arranged.drain(seen..)) {
            *placed = moved;
        }
        let arranged: Vec<DetectedBox> = arranged.into_iter().map(|(_, found)| found).collect();
        // A box in the middle has no side of its own to show; those around it must have theirs.
        let proven = |b: &DetectedBox| b.proven_sides > 0;
        let all = || arranged.iter().chain(&boxes).chain(beside);
        let around = all().filter(|b| proven(b)).count();
        let enclosed = arrangement.each_proven || arrangement.unique && 2 * around >= all().count();
        for found in arranged {
            if proven(&found) || enclosed {
                boxes.push(found);
            } else {
                rejected.push(RejectedSurface {
                    reason: RejectReason::Ambiguous,
                    centre_in_camera: found.camera_from_box.translation.vector.into(),
                    area: found.size.length * found.size.width,
                });
            }
        }
        boxes
    }
}
