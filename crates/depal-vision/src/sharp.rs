//! Stage 8: how far from a top's plane its pixels lie at most.

use crate::{
    VisionSettings,
    gate::DepthImage,
    plane::PlaneFrame,
    spaced_points::SpacedPoints,
    verify::{LEAST_SHARP, SHARP},
};

/// How far from a top's plane its pixels lie at most, metres, from the noise in its middle: what lies farther shows
/// something else.
pub fn sharp_tolerance(image: &DepthImage, frame: &PlaneFrame, settings: &VisionSettings) -> f64 {
    /// Half the side of the square that is looked at, metres, and samples along it.
    const HALF: f64 = 0.03;
    const SAMPLES: usize = 12;
    const STEP: f64 = 2.0 * HALF / SAMPLES as f64;
    let (mut squares, mut count) = (0.0, 0.0);
    let (width, height) = (image.width as f32, image.height as f32);
    let tolerance = settings.plane_tolerance as f32;
    for j in 0..SAMPLES {
        let first = frame.point(0.5 * STEP - HALF, (j as f64 + 0.5) * STEP - HALF);
        let points = SpacedPoints::new(&image.intrinsics, first, frame.x * STEP);
        for i in 0..SAMPLES {
            let (u, v, expected) = points.at(i);
            let inside = u >= 0.0 && v >= 0.0 && u < width && v < height;
            if !inside {
                continue;
            }
            let (u, v) = (u as i32, v as i32);
            let off = image.depth[v as usize * image.width + u as usize] - expected;
            if off.abs() <= tolerance {
                squares += f64::from(off * off);
                count += 1.0;
            }
        }
    }
    let rms = (squares / f64::max(count, 1.0)).sqrt();
    settings.plane_tolerance.min((SHARP * rms).max(LEAST_SHARP))
}
