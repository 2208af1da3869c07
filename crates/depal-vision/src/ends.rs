//! Where a surface ends across its sides.
//!
//! A line fitted to where scan lines leave a surface lies inside its real side, by how many of the outermost pixels
//! the camera loses; that differs between cameras and between what lies beyond the sides. The place where the share of
//! pixels that are surface falls hardly depends on it.

use crate::{gate::DepthImage, plane::PlaneFrame};

/// Of the outermost pixels of a surface a camera loses or mixes up to four in ten, beyond them one in twenty shows it:
/// where fewer than this share of the pixels are surface it has ended, whatever the camera loses.
const SHARE: f64 = 1.0 / 3.0;
/// Where six of ten outermost pixels are left, chance takes that sum so far down again once in some thousand sides.
const A_FEW: f64 = 5.0;
/// How far inside and beyond a side is looked, pixels: less than a gap that parts two surfaces.
const WINDOW: [f64; 2] = [-3.0, 1.8];
/// So wide a line without surface ends it, pixels: what comes then is the neighbour.
const ENDED: f64 = 0.7;

/// How far beyond (+) or short of (-) the side `(axis, sign)` of a rectangle in a plane the surface ends, metres;
/// `None` where that is not to be seen. `pitch`: metres per pixel.
pub fn surface_end(
    image: &DepthImage,
    frame: &PlaneFrame,
    extents: [f64; 2],
    (axis, sign): (usize, f64),
    tolerance: f64,
    pitch: f64,
) -> Option<f64> {
    let k = &image.intrinsics;
    let half = extents[axis] / 2.0;
    let reach = extents[1 - axis] * 0.47;
    let at = |beyond: f64, along: f64| {
        let (x, y) = if axis == 0 {
            (sign * (half + beyond), along)
        } else {
            (along, sign * (half + beyond))
        };
        k.project(&frame.point(x, y))
    };
    let window = WINDOW.map(|w| w * pitch);
    let corners = [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)].map(|(w, s)| at(window[w], s * reach));
    let range = |of: fn(&(f64, f64)) -> f64, count: usize| {
        let (low, high) = corners
            .iter()
            .map(of)
            .fold((f64::MAX, f64::MIN), |r, c| (r.0.min(c), r.1.max(c)));
        let clip = |c: f64| c.clamp(0.0, count as f64) as usize;
        clip(low.floor())..clip(high.ceil() + 1.0)
    };
    let columns = range(|c| c.0, image.width);
    let mut pixels: Vec<(f64, bool)> = Vec::new();
    for v in range(|c| c.1, image.height) {
        let row = frame.of_row(k, v as f64);
        for u in columns.clone() {
            let (place, expected) = row.at(u as f64);
            let beyond = sign * place[axis] - half;
            if place[1 - axis].abs() > reach || beyond < window[0] || beyond > window[1] {
                continue;
            }
            let z = f64::from(image.depth[v * image.width + u]);
            pixels.push((beyond, z > 0.0 && (z - expected).abs() <= tolerance));
        }
    }
    pixels.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    // The sum of (surface - SHARE) from inside outwards is greatest where the share falls below it; between two
    // rows of pixels, and but for a few pixels, it is as great over a whole range: the end is in its middle.
    let enough = ENDED * SHARE * pixels.len() as f64 / (WINDOW[1] - WINDOW[0]);
    let mut sums: Vec<f64> = Vec::with_capacity(pixels.len());
    let (mut sum, mut best) = (0.0, (0.0, 0));
    for (n, &(_, on)) in pixels.iter().enumerate() {
        sum += f64::from(u8::from(on)) - SHARE;
        if sum > best.0 {
            best = (sum, n);
        } else if best.0 - sum > enough {
            break;
        }
        sums.push(sum);
    }
    let great = |n: &usize| sums[*n] >= best.0 - A_FEW;
    let first = (0..=best.1).rev().take_while(great).last()?;
    let last = (best.1..sums.len()).take_while(great).last()?;
    let (inner, outer) = (pixels.get(first)?, pixels.get(last + 1)?);
    Some(f64::midpoint(inner.0, outer.0))
}
