//! Where one carton's plane gives way to its neighbour's.

use super::{Edge, Member, Pair, Seen};
use crate::{
    VisionSettings,
    gate::DepthImage,
    patch::pixel_pitch,
    verify::{LEAST_SHARP, SHARP},
};

/// Pixels looked at across a seam, to each side of its middle one.
const REACH: i32 = 3;
/// What planes are mistaken by near their ends, metres.
const PLANE_ERROR: f64 = 0.000_05;
/// The place along each line across a seam where one plane gives way to the other: how many of its pixels lie on
/// the first tells it, and the distance of each pixel from the second, in parts of that between the planes, counts
/// them. Lines count by the square of that distance. What is seen there is the edge of the higher one. `noise`:
/// variance of a pixel's depth, square metres.
pub(super) fn observe_seam(
    image: &DepthImage,
    settings: &VisionSettings,
    members: &[Member],
    pair: &Pair,
    noise: f64,
    seen: &mut Vec<Seen>,
) {
    /// Lines are so many pixels apart.
    const STRIDE: f64 = 2.0;
    /// Away from the corners, metres.
    const MARGIN: f64 = 0.008;
    let (a, b) = (&members[pair.low], &members[pair.high]);
    let (axis, across) = (pair.axis, 1 - pair.axis);
    let k = &image.intrinsics;
    let pitch = pixel_pitch(&a.frame, k);
    let low = (a.top[across] - a.half[across]).max(b.top[across] - b.half[across]) + MARGIN;
    let high = (a.top[across] + a.half[across]).min(b.top[across] + b.half[across]) - MARGIN;
    let lines = ((high - low) / (STRIDE * pitch)).floor();
    if lines < 8.0 {
        return;
    }
    let (outward, tangent) = (a.direction(axis), a.direction(across));
    let (width, height) = (image.width as i32, image.height as i32);
    let tolerance = settings.plane_tolerance;
    // A wall inside the gap, or a mixed pixel, may lie closer to a plane than its tolerance.
    let sharp = tolerance.min((SHARP * noise.sqrt()).max(LEAST_SHARP));
    let pixels = f64::from(2 * REACH + 1);
    // For the lines where the first and where the second is the higher one.
    let mut weights = [0.0; 2];
    let mut places = [0.0; 2];
    let mut counts = [0.0; 2];
    let seam = f64::midpoint(a.top[axis] + a.half[axis], b.top[axis] - b.half[axis]) - a.top[axis];
    for line in 0..lines as usize {
        let along = low + (line as f64 + 0.5) / lines * (high - low) - a.top[across];
        let middle = a.frame.origin + outward * seam + tangent * along;
        let (u, v) = k.project(&middle);
        let (u1, v1) = k.project(&(middle + outward * pitch));
        let (du, dv) = (u1 - u, v1 - v);
        // One pixel for each step along the longer axis of the image, from centre to centre.
        let (du, dv, u, v) = if du.abs() > dv.abs() {
            (
                du.signum(),
                dv / du.abs(),
                u.round(),
                v + (u.round() - u) * dv / du,
            )
        } else {
            (
                du / dv.abs(),
                dv.signum(),
                u + (v.round() - v) * du / dv,
                v.round(),
            )
        };
        let at = |s: i32| (u + du * f64::from(s), v + dv * f64::from(s));
        let depths = [-REACH, REACH].map(|s| {
            let (u, v) = at(s);
            let ray = k.ray(u, v);
            [a.frame.plane.depth(&ray), b.frame.plane.depth(&ray)]
        });
        let expected = |s: i32, n: usize| {
            let share = f64::from(s + REACH) / f64::from(2 * REACH);
            depths[0][n] + (depths[1][n] - depths[0][n]) * share
        };
        let apart = expected(0, 1) - expected(0, 0);
        let mut sum = 0.0;
        for s in -REACH..=REACH {
            let (u, v) = at(s);
            let (u, v) = (u.round() as i32, v.round() as i32);
            if u < 0 || v < 0 || u >= width || v >= height {
                return;
            }
            let z = f64::from(image.depth[v as usize * image.width + u as usize]);
            let [on_a, on_b] = [expected(s, 0), expected(s, 1)];
            let known = z > 0.0 && (z - on_a).abs().min((z - on_b).abs()) <= sharp;
            // What is lost may belong to either.
            sum += if known { on_b - z } else { apart / 2.0 };
        }
        let upper = usize::from(apart < 0.0);
        let frame = [&a.frame, &b.frame][upper];
        let of = |(u, v): (f64, f64)| {
            let (x, y) = frame.of_pixel(k, u, v);
            [x, y][axis]
        };
        let (first, last) = (of(at(-REACH)), of(at(REACH)));
        let step = (last - first) / f64::from(2 * REACH);
        let weight = apart * apart;
        weights[upper] += weight;
        counts[upper] += 1.0;
        places[upper] += weight * (first - step / 2.0) + step * apart * sum;
    }
    let shifts = [0, 1].map(|n| {
        let member = [a, b][n];
        let sign = [1.0, -1.0][n];
        let place = places[n] / weights[n].max(1e-12);
        let shift = place - sign * member.half[axis];
        let sides = noise * pixels + PLANE_ERROR * PLANE_ERROR * counts[n] * pixels * pixels / 4.0;
        let variance = pitch * pitch * (sides / weights[n].max(1e-12) + 0.04);
        (shift, variance)
    });
    for (n, member) in [pair.low, pair.high].into_iter().enumerate() {
        let (shift, variance) = shifts[n];
        if counts[n] >= 8.0 && shift.abs() < 2.0 * pitch {
            seen.push(Seen {
                member,
                axis,
                sign: [1.0, -1.0][n],
                place: members[member].top[axis] + shift,
                weight: 1.0 / variance,
                what: Edge::Seam,
            });
        }
    }
}
