//! Stage 7g: where cartons hang together and some of the picture's sizes were measured elsewhere, those sizes are
//! looked for. Only what all four sides prove counts: nothing here is covered by what would fit.

use depal_frames::BoxSize;

use crate::{
    DetectedBox, RejectedSurface, VisionSettings,
    gate::DepthImage,
    measure::is_free,
    support::{sizes_of, support},
    surface::Surface,
};

/// A surface of which one carton is more than this share was looked at as a whole already.
const MOST_OF_IT: f64 = 0.8;

/// Looks through the surfaces of which no carton was measured; a surface that is all found loses its refusal.
pub fn look_again(
    surfaces: &mut [(Surface, Option<RejectedSurface>)],
    found: &[DetectedBox],
    mask: &[u8],
    image: &DepthImage,
    settings: &VisionSettings,
) -> Vec<DetectedBox> {
    let sizes = sizes_of(found);
    let area = |size: &BoxSize| size.length * size.width;
    let Some(smallest) = sizes.iter().map(|(s, _)| area(s)).reduce(f64::min) else {
        return Vec::new();
    };
    let known = VisionSettings {
        sizes: sizes.iter().map(|(size, _)| *size).collect(),
        ..settings.clone()
    };
    let mut more = Vec::new();
    for (surface, refusal) in surfaces {
        if surface.area * MOST_OF_IT < smallest {
            continue;
        }
        let Ok(boxes) = surface.search(mask, image, &known, smallest) else {
            continue;
        };
        let seen = boxes.len();
        let before = more.len();
        for one in boxes {
            let proven = one.proven_sides == 4
                && area(&one.size) < MOST_OF_IT * surface.area
                && is_free(image, &one, settings.plane_tolerance);
            if proven {
                let (_, count) = sizes[one.label as usize];
                more.push(DetectedBox {
                    label: 0,
                    confidence: one.confidence * support(count),
                    ..one
                });
            }
        }
        if surface.solved && more.len() - before == seen {
            *refusal = None;
        }
    }
    more
}
