//! How wide the gaps beside a carton are: whether one between two others could hide.

use crate::{class::Class, gate::DepthImage, patch::pixel_pitch, plane::PlaneFrame};

/// Where gaps measure this much (lost pixels at their rims included), all gaps can be seen, metres.
const WIDE_GAP: f64 = 0.0035;
/// The same in cells: one for a gap that fills a pixel, 0.4 lost at each rim, and noise.
const WIDE_GAP_CELLS: f64 = 2.2;

/// True when a gap measures so much (metres, lost pixels at its rims included) that all gaps like it are seen.
pub fn is_wide(gap: f64, pitch: f64) -> bool {
    gap >= WIDE_GAP.max(WIDE_GAP_CELLS * pitch)
}

/// How much of the surface is lost at each side (-X, +X, -Y, +Y) of a rectangle where another one stands beside it,
/// pixels, mean over its length; `None` where nothing of the same height does. Origin of `frame` in its middle, sides
/// `extents` along its axes, metres.
pub fn lost_beside(
    image: &DepthImage,
    frame: &PlaneFrame,
    extents: [f64; 2],
    tolerance: f64,
) -> [Option<f64>; 4] {
    /// Lines across each side.
    const LINES: usize = 20;
    /// They begin so many pixels inside the side,
    const INSIDE: f64 = 4.0;
    /// and reach so far beyond it, metres.
    const BEYOND: f64 = 0.012;
    /// Steps along them, pixels.
    const STEP: f64 = 0.5;
    let k = &image.intrinsics;
    let pitch = pixel_pitch(frame, k);
    let is_on = |at: [f64; 2]| {
        let (u, v) = k.project(&frame.point(at[0], at[1]));
        let expected = frame.plane.depth(&k.ray(u, v));
        image.class(u, v, expected, tolerance) == Class::On
    };
    let steps = ((BEYOND / pitch + INSIDE) / STEP).ceil() as usize;
    [0, 1, 2, 3].map(|side| {
        let (axis, across) = (side / 2, 1 - side / 2);
        let sign = if side % 2 == 0 { -1.0 } else { 1.0 };
        let (mut lines, mut lost) = (0, 0);
        for line in 0..LINES {
            let along = 0.9 * ((line as f64 + 0.5) / LINES as f64 - 0.5) * extents[across];
            let on = |pixels: f64| {
                let mut at = [along; 2];
                at[axis] = sign * (extents[axis] / 2.0 + pixels * pitch);
                is_on(at)
            };
            // What begins there stands beside it.
            let beyond = (0..4).filter(|&n| on(BEYOND / pitch + f64::from(n)));
            if beyond.count() >= 3 {
                lines += 1;
                lost += (0..steps)
                    .filter(|&n| !on(n as f64 * STEP - INSIDE))
                    .count();
            }
        }
        (3 * lines >= LINES).then(|| lost as f64 * STEP / f64::from(lines as u32))
    })
}
