//! Stage 8a: lines across a side of a rectangle, and where each of them leaves the surface.

use depal_frames::Intrinsics;

use crate::{gate::DepthImage, plane::PlaneFrame, resample::int, widest::with_widest_vectors};

/// Where a scan line across a side left the surface.
#[derive(Debug, Clone, Copy)]
pub struct Crossing {
    /// Position along the side, metres from its middle.
    pub along: f64,
    /// Beyond (+) or short of (-) the expected side, metres.
    pub beyond: f64,
    /// Something taller stands behind what was not measured there: its shadow, perhaps no edge at all.
    pub shadowed: bool,
    /// Something deeper was measured close behind it.
    pub lit: bool,
}

/// What the scan lines across one side found.
pub struct ScanLines {
    pub crossings: Vec<Crossing>,
    /// How many there were.
    pub lines: usize,
    /// Nearly all of them left the surface into the shadow of something taller.
    pub shadowed: bool,
}

impl ScanLines {
    /// Crossings into the shadow of something taller only count where there is next to nothing else.
    fn new(mut crossings: Vec<Crossing>, lines: usize, least_seen: f64) -> Self {
        let clear = crossings.iter().filter(|c| !c.shadowed).count();
        let enough = clear as f64 >= least_seen * lines as f64;
        if enough {
            crossings.retain(|c| !c.shadowed);
        }
        let shadowed = !enough && 2 * clear < crossings.len();
        Self {
            crossings,
            lines,
            shadowed,
        }
    }
}

/// Something this much nearer than a plane throws a shadow that matters, metres.
const TALLER: f32 = 0.010;
/// What is seen within so many pixels beyond an edge belongs to its step.
const LIT_WITHIN: i32 = 3;
/// The longest shadow that is followed, pixels.
const LONGEST_SHADOW: i32 = 80;

/// So many places along a line are worked out at once.
const TOGETHER: usize = 16;
/// Stands for the pixel of a place beyond the image.
const OUTSIDE: i32 = -1;

/// What is to be looked across: lengths in metres.
pub struct Scan<'a> {
    pub image: &'a DepthImage<'a>,
    /// Origin in the middle of a rectangle of `extents`.
    pub frame: &'a PlaneFrame,
    pub extents: [f64; 2],
    /// Axis and direction of the side.
    pub side: (usize, f64),
    /// From so far inside of where the side is expected to so far beyond it.
    pub reach: f64,
    /// Distance of the lines.
    pub stride: f64,
    /// How far a point of the surface lies from the plane at most.
    pub tolerance: f64,
    /// Share of the lines that must leave the surface elsewhere than into a shadow, or shadows count too.
    pub least_seen: f64,
}

impl Scan<'_> {
    /// Where each line leaves the surface.
    pub fn lines(&self) -> ScanLines {
        with_widest_vectors(
            #[inline(always)]
            || scan_lines(self),
        )
    }
}

#[inline(always)]
fn scan_lines(scan: &Scan) -> ScanLines {
    let &Scan {
        image,
        frame,
        extents,
        side: (axis, sign),
        reach,
        stride,
        tolerance,
        least_seen,
    } = scan;
    let k: &Intrinsics = &image.intrinsics;
    let (outward, tangent) = if axis == 0 {
        (frame.x * sign, frame.y * sign)
    } else {
        (frame.y * sign, frame.x * -sign)
    };
    let (half, length) = (extents[axis] / 2.0, extents[1 - axis] * 0.94);
    let lines = (length / stride).floor().max(1.0) as usize;
    let tolerance = tolerance as f32;
    // First where all of them lie, then where each ends: the processor does several of the former at once.
    let mut across = Vec::with_capacity(lines);
    for line in 0..lines {
        let along = (line as f64 + 0.5) / lines as f64 * length - length / 2.0;
        let base = frame.origin + tangent * along;
        let ends = [half - reach, half + reach].map(|at| base + outward * at);
        let [(u0, v0), (u1, v1)] = ends.map(|p| k.project(&p));
        // From pixel to pixel along the longer axis; so short a line is straight in depth, too.
        let count = (u1 - u0).abs().max((v1 - v0).abs()).min(1e4) as i32 + 1;
        let per = 1.0 / f64::from(count);
        let (du, dv) = (((u1 - u0) * per) as f32, ((v1 - v0) * per) as f32);
        let dz = ((ends[1].z - ends[0].z) * per) as f32;
        // Half a pixel added: cutting off rounds to the nearest.
        across.push(Places {
            first: [(u0 + 0.5) as f32, (v0 + 0.5) as f32, ends[0].z as f32],
            step: [du, dv, dz],
            last: count,
        });
    }
    let mut crossings = Vec::with_capacity(lines);
    for places in &across {
        let mut last: Option<i32> = None;
        let mut from = 0;
        'line: while from <= places.last {
            let (pixels, expected) = places.together(from, image);
            let together = TOGETHER.min((places.last + 1 - from) as usize);
            for (n, (&pixel, &expected)) in pixels.iter().zip(&expected).enumerate().take(together)
            {
                let step = from + n as i32;
                if pixel == OUTSIDE {
                    break 'line;
                }
                let z = image.depth[pixel as usize];
                if z != 0.0 && (z - expected).abs() <= tolerance {
                    last = Some(step);
                    continue;
                }
                if let Some(inner) = last
                    && (z == 0.0 || z > expected)
                {
                    // Half way between the centres of the last surface pixel and this one.
                    // Lone pixels are lost at any step: what counts is the first one that was measured.
                    let (shadowed, lit) = if z == 0.0 {
                        match places.first_measured(image, step + 1) {
                            Some((at, z, expected)) => (
                                z < expected - tolerance.max(TALLER),
                                at < step + LIT_WITHIN && z > expected + tolerance,
                            ),
                            None => (false, false),
                        }
                    } else {
                        // Not on the surface, and not above it.
                        (false, true)
                    };
                    let middle = |axis: usize| {
                        let [inner, outer] = [inner, step].map(|s| places.at(axis, s) as i32);
                        f64::from(inner + outer) / 2.0
                    };
                    let ray = k.ray(middle(0), middle(1));
                    let at = frame.plane.meet(&ray) - frame.origin;
                    crossings.push(Crossing {
                        along: at.dot(&tangent),
                        beyond: at.dot(&outward) - half,
                        shadowed,
                        lit,
                    });
                }
                break 'line;
            }
            from += TOGETHER as i32;
        }
    }
    ScanLines::new(crossings, lines, least_seen)
}

/// Evenly spaced places in the image along a line: column and row, to be cut off, and the depth expected there.
struct Places {
    first: [f32; 3],
    step: [f32; 3],
    /// Number of the last one.
    last: i32,
}

impl Places {
    #[inline(always)]
    fn at(&self, k: usize, s: i32) -> f32 {
        self.first[k] + self.step[k] * s as f32
    }

    /// The pixels, [`OUTSIDE`] beyond the image, and the expected depths of some places from number `from` on.
    #[inline(always)]
    fn together(&self, from: i32, image: &DepthImage) -> ([i32; TOGETHER], [f32; TOGETHER]) {
        let (width, height) = (image.width as f32, image.height as f32);
        let stride = image.width as i32;
        let mut pixels = [OUTSIDE; TOGETHER];
        let mut expected = [0.0f32; TOGETHER];
        for (k, (pixel, expected)) in pixels.iter_mut().zip(&mut expected).enumerate() {
            let s = from + k as i32;
            let (u, v) = (self.at(0, s), self.at(1, s));
            // False of NaN, too.
            let inside = (u >= 0.0) & (v >= 0.0) & (u < width) & (v < height);
            let (u, v) = if inside { (u, v) } else { (0.0, 0.0) };
            let place = int(v) * stride + int(u);
            *pixel = if inside { place } else { OUTSIDE };
            *expected = self.at(2, s);
        }
        (pixels, expected)
    }

    /// The first place from `s` on where something was measured, if one is no farther than the longest shadow: its
    /// number, the depth and the expected depth.
    #[inline(always)]
    fn first_measured(&self, image: &DepthImage, s: i32) -> Option<(i32, f32, f32)> {
        let end = s + LONGEST_SHADOW;
        for from in (s..end).step_by(TOGETHER) {
            let (pixels, expected) = self.together(from, image);
            for (k, (&pixel, &expected)) in pixels.iter().zip(&expected).enumerate() {
                if pixel == OUTSIDE || from + k as i32 == end {
                    return None;
                }
                let z = image.depth[pixel as usize];
                if z != 0.0 {
                    return Some((from + k as i32, z, expected));
                }
            }
        }
        None
    }
}
