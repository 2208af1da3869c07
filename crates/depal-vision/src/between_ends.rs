//! Stage 8a: a carton of known size lies in the middle between the ends of its surface.
//!
//! At a step some of the outermost pixels are lost or lie between both surfaces, and how many depends on the camera
//! and on what it sees beyond the side: lines fitted to edges lie inside the real sides by different amounts, and
//! a carton with one side of each sort seems to lie beside its place. Where the surface ends (`ends`) does not depend
//! on how many of its outermost pixels are lost, and an error of the known size is common to both sides.

use depal_frames::Vector;

use crate::{
    DetectedBox, VisionSettings,
    ends::surface_end,
    gate::DepthImage,
    patch::pixel_pitch,
    plane::PlaneFrame,
    sharp::sharp_tolerance,
    sides::{Fitting, fit_rectangle},
    verify::LEAST_SEEN,
};

/// The surface is at most so many pixels longer or shorter than the carton: else one of the ends is none, but lies in
/// the surface of a neighbour beyond a gap of less than a pixel.
const MOST_LONGER: f64 = 0.5;

/// Moves boxes, along each axis in which two opposite sides were seen, to the middle between them.
pub fn place_between_ends(
    boxes: &mut [DetectedBox],
    image: &DepthImage,
    settings: &VisionSettings,
) {
    // A smeared surface does not end at a pixel.
    if settings.is_smeared() {
        return;
    }
    for found in boxes {
        found.camera_from_box.translation.vector += to_middle(found, image, settings);
    }
}

/// From where the middle of the top is to the middle between the ends of its surface.
fn to_middle(found: &DetectedBox, image: &DepthImage, settings: &VisionSettings) -> Vector {
    let frame = PlaneFrame::of_top(found);
    let extents = [found.size.length, found.size.width];
    let tolerance = sharp_tolerance(image, &frame, settings);
    let pitch = pixel_pitch(&frame, &image.intrinsics);
    let fit = fit_rectangle(
        image,
        frame,
        extents,
        tolerance,
        &Fitting {
            least_seen: LEAST_SEEN,
            turn_seen: 2.0,
            least_turning: 4,
            passes: &[(3.5, 3.0)],
            sides: [true; 4],
        },
    );
    let end = |axis, sign| surface_end(image, &frame, extents, (axis, sign), tolerance, pitch);
    let mut shift = Vector::zeros();
    for (axis, direction) in [frame.x, frame.y].into_iter().enumerate() {
        let sides = [fit.sides[2 * axis], fit.sides[2 * axis + 1]];
        if sides.iter().all(|side| side.is_true_edge(LEAST_SEEN))
            && let (Some(low), Some(high)) = (end(axis, -1.0), end(axis, 1.0))
            && (low + high).abs() <= MOST_LONGER * pitch
        {
            shift += direction * ((high - low) / 2.0);
        }
    }
    shift
}
