//! Stage 8c: a top between two taller ones. The shadow of the one hides where it ends, the wall of the other stands where
//! it does: only together they say how long it is.

use crate::{
    beyond::WIDEST_BLIND_GAP,
    gate::DepthImage,
    patch::pixel_pitch,
    plane::PlaneFrame,
    sides::{RectangleFit, SideFit},
    verify::LEAST_SEEN,
};

/// What is nearer than a plane by less is no wall, metres.
const LEAST_HEIGHT: f64 = 0.010;
/// Lines across each side, and the share of them that must meet the wall.
const LINES: usize = 40;
const MOST: f64 = 0.7;

/// True when the one side along an axis that is seen ends in front of something taller, and of all sizes only such as that
/// of the rectangle fill the room from there to what hides the other. `off`: by how much sides may be off, metres.
pub fn is_between(
    image: &DepthImage,
    fit: &RectangleFit,
    extents: [f64; 2],
    axis: usize,
    off: f64,
) -> bool {
    is_half_hidden(fit, axis)
        && walls(image, &fit.frame, extents, axis).is_some_and(|beyond| {
            let near = |b: &f64| (-off..WIDEST_BLIND_GAP).contains(b);
            beyond.iter().all(near)
        })
}

/// The same rectangle in the middle of the room between what is taller on both sides, if only such as that fill it: it may
/// have been put to where a shadow begins.
pub fn between(
    image: &DepthImage,
    fit: &RectangleFit,
    extents: [f64; 2],
    axis: usize,
    off: f64,
) -> Option<PlaneFrame> {
    if !is_half_hidden(fit, axis) {
        return None;
    }
    let [low, high] = walls(image, &fit.frame, extents, axis)?;
    let frame = fit.frame;
    let room = (-off..2.0 * WIDEST_BLIND_GAP).contains(&(low + high));
    room.then(|| PlaneFrame {
        origin: frame.origin + [frame.x, frame.y][axis] * (0.5 * (high - low)),
        ..frame
    })
}

/// True when one side along an axis is seen, in front of something taller, and the other is not.
fn is_half_hidden(fit: &RectangleFit, axis: usize) -> bool {
    let sides = [fit.sides[2 * axis], fit.sides[2 * axis + 1]];
    let seen = |side: &SideFit| side.seen >= LEAST_SEEN;
    seen(&sides[0]) != seen(&sides[1]) && sides.iter().any(|s| seen(s) && s.shadowed)
}

/// How far beyond both sides along an axis something taller stands, metres; `None` where it does not along most of each.
fn walls(
    image: &DepthImage,
    frame: &PlaneFrame,
    extents: [f64; 2],
    axis: usize,
) -> Option<[f64; 2]> {
    let beyond = |sign: f64| {
        let mut walls: Vec<f64> = (0..LINES)
            .filter_map(|line| {
                let along = 0.94 * ((line as f64 + 0.5) / LINES as f64 - 0.5) * extents[1 - axis];
                wall(image, frame, extents, (axis, sign), along)
            })
            .collect();
        if (walls.len() as f64) < MOST * LINES as f64 {
            return None;
        }
        let middle = walls.len() / 2;
        Some(*walls.select_nth_unstable_by(middle, f64::total_cmp).1)
    };
    Some([beyond(-1.0)?, beyond(1.0)?])
}

/// How far beyond a side `(axis, sign)` something taller stands, metres, along the line that crosses it at `along`.
fn wall(
    image: &DepthImage,
    frame: &PlaneFrame,
    extents: [f64; 2],
    (axis, sign): (usize, f64),
    along: f64,
) -> Option<f64> {
    /// Where the line begins, as a share of the rectangle inside its side, and how far beyond it ends, metres.
    const INSIDE: f64 = 0.2;
    const BEYOND: f64 = 0.1;
    /// So many pixels in a row are no mixed ones.
    const IN_A_ROW: usize = 3;
    let k = &image.intrinsics;
    let pitch = pixel_pitch(frame, k);
    let half = extents[axis] / 2.0;
    let from = half - INSIDE * extents[axis];
    let steps = ((half + BEYOND - from) / pitch) as usize;
    let mut taller = 0;
    for step in 0..steps {
        let mut at = [along; 2];
        at[axis] = sign * (from + step as f64 * pitch);
        let (u, v) = k.project(&frame.point(at[0], at[1]));
        let (u, v) = (u.round(), v.round());
        let inside = u >= 0.0 && v >= 0.0 && u < image.width as f64 && v < image.height as f64;
        if !inside {
            return None;
        }
        let z = f64::from(image.depth[v as usize * image.width + u as usize]);
        if z == 0.0 {
            continue;
        }
        if z > frame.plane.depth(&k.ray(u, v)) - LEAST_HEIGHT {
            taller = 0;
            continue;
        }
        taller += 1;
        if taller == IN_A_ROW {
            // It stands upright: where it is seen, its foot is.
            let place = (k.deproject(u, v, z) - frame.origin).dot(&[frame.x, frame.y][axis]);
            return Some(sign * place - half - (IN_A_ROW - 1) as f64 * pitch);
        }
    }
    None
}
