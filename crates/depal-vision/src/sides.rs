//! Stage 8: the exact rectangle, from where scan lines across each side leave the surface.

use crate::{
    gate::DepthImage,
    patch::pixel_pitch,
    plane::PlaneFrame,
    scan::{Scan, ScanLines},
};

/// What was measured at one side.
#[derive(Debug, Clone, Copy, Default)]
pub struct SideFit {
    /// Share 0..1 of the scan lines that found an edge close to the fitted line.
    pub seen: f64,
    /// Mean of (edge - expected) along the outward direction at the middle of the side, metres.
    pub offset: f64,
    /// Nearly all of it ends in the shadow of something taller: the real side may lie farther out.
    pub shadowed: bool,
    /// Share 0..1 of its edge behind which something deeper was measured.
    pub lit: f64,
}

impl SideFit {
    /// A side that shows where the surface really ends.
    pub fn is_true_edge(&self, least_seen: f64) -> bool {
        self.seen >= least_seen && !self.shadowed
    }
}

/// A rectangle in a plane, moved onto the edges of the image.
#[derive(Debug, Clone, Copy)]
pub struct RectangleFit {
    /// Origin in the middle, X along `extents[0]`.
    pub frame: PlaneFrame,
    /// -X, +X, -Y, +Y, measured from the final frame.
    pub sides: [SideFit; 4],
}

/// Outward axis of each side as (axis, sign).
const OUTWARD: [(usize, f64); 4] = [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)];

/// How far an edge seen by pixels lies inside the real one, in pixels: of the outermost surface
/// pixels a third is lost or mixed at a step, which moves the crossing by one pixel each.
pub const INSET_PIXELS: f64 = 0.4;
/// How well a side that is seen over its whole length is known, pixels: most of it is where between two pixels
/// it lies, when it runs along their rows.
pub const SIDE_PIXELS: f64 = 0.3;

/// How a rectangle is fitted.
#[derive(Debug, Clone, Copy)]
pub struct Fitting {
    /// Share of its length from which on a side takes part; with none along an axis the middle stays there.
    pub least_seen: f64,
    /// Share from which on a side turns the rectangle: a few stray crossings along an invisible seam
    /// would too.
    pub turn_seen: f64,
    /// It is turned only when so many sides can.
    pub least_turning: usize,
    /// How far to both sides of the expected edge is looked for it, and how far apart, pixels.
    pub passes: &'static [(f64, f64)],
    /// The sides worth looking at.
    pub sides: [bool; 4],
}

/// Wide and sparse first, then narrow and dense.
pub const FROM_AFAR: &[(f64, f64)] = &[(6.0, 4.0), (4.0, 3.0), (3.5, 1.0)];
/// For a start that was fitted before.
pub const FROM_CLOSE: &[(f64, f64)] = &[(4.0, 3.0), (3.5, 1.0)];
/// Where roughly.
pub const ROUGHLY: &[(f64, f64)] = &[(6.0, 4.0), (4.0, 2.0)];

/// Fits centre and turn of a rectangle with known `extents`.
pub fn fit_rectangle(
    image: &DepthImage,
    start: PlaneFrame,
    extents: [f64; 2],
    tolerance: f64,
    fitting: &Fitting,
) -> RectangleFit {
    let least_seen = fitting.least_seen;
    let pitch = pixel_pitch(&start, &image.intrinsics);
    let inset = INSET_PIXELS * pitch;
    let mut frame = start;
    let mut sides = [SideFit::default(); 4];
    for &(reach, stride) in fitting.passes {
        let lines = [0, 1, 2, 3].map(|side| {
            if !fitting.sides[side] {
                return ScanLines {
                    crossings: Vec::new(),
                    lines: 1,
                    shadowed: false,
                };
            }
            Scan {
                image,
                frame: &frame,
                extents,
                side: OUTWARD[side],
                reach: reach * pitch + 0.001,
                stride: stride * pitch,
                tolerance,
                least_seen,
            }
            .lines()
        });
        let (turn, fitted) = fit_lines(&lines, pitch, fitting);
        sides = fitted;
        frame = frame.turned(turn);
        for axis in 0..2 {
            let (low, high) = (sides[2 * axis], sides[2 * axis + 1]);
            // A shadowed side says nothing where the one opposite is a true edge.
            let counts = |one: &SideFit, other: &SideFit| {
                one.is_true_edge(least_seen)
                    || one.seen >= least_seen && !other.is_true_edge(least_seen)
            };
            let shift = match (counts(&low, &high), counts(&high, &low)) {
                (true, true) => (high.offset - low.offset) / 2.0,
                (true, false) => -(low.offset + inset),
                (false, true) => high.offset + inset,
                (false, false) => 0.0,
            };
            let shift = shift.clamp(-reach * pitch, reach * pitch);
            let direction = if axis == 0 { frame.x } else { frame.y };
            frame.origin += direction * shift;
            sides[2 * axis].offset += shift;
            sides[2 * axis + 1].offset -= shift;
        }
    }
    RectangleFit { frame, sides }
}

/// Moves a rectangle along an axis on which only the shadow of something taller was seen, onto the true edge that
/// its surface shows up to `reach` metres inside one of the two sides; `None` without exactly one such edge.
pub fn anchored(
    image: &DepthImage,
    frame: &PlaneFrame,
    extents: [f64; 2],
    tolerance: f64,
    axis: usize,
    reach: f64,
) -> Option<PlaneFrame> {
    let edge = |sign: f64| {
        edge_inside(image, frame, extents, tolerance, (axis, sign), reach)
            .map(|beyond| sign * beyond)
    };
    let ((Some(shift), None) | (None, Some(shift))) = (edge(-1.0), edge(1.0)) else {
        return None;
    };
    let direction = if axis == 0 { frame.x } else { frame.y };
    Some(PlaneFrame {
        origin: frame.origin + direction * shift,
        ..*frame
    })
}

/// How far beyond its place (-: short of it) a side `(axis, sign)` shows a true edge, up to `reach` metres away;
/// `None` where half of its length shows none.
pub fn edge_inside(
    image: &DepthImage,
    frame: &PlaneFrame,
    extents: [f64; 2],
    tolerance: f64,
    side: (usize, f64),
    reach: f64,
) -> Option<f64> {
    /// Share of the scan lines that must end in it.
    const MOST_OF_IT: f64 = 0.5;
    let stride = 2.0 * pixel_pitch(frame, &image.intrinsics);
    let found = Scan {
        image,
        frame,
        extents,
        side,
        reach,
        stride,
        tolerance,
        least_seen: MOST_OF_IT,
    }
    .lines();
    let enough = found.crossings.len() as f64 >= MOST_OF_IT * found.lines as f64;
    if found.shadowed || !enough {
        return None;
    }
    let mut beyond: Vec<f64> = found.crossings.iter().map(|c| c.beyond).collect();
    let middle = beyond.len() / 2;
    Some(*beyond.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// One turn for all sides (they stay orthogonal) and an offset for each, by reweighted least
/// squares. With the tangent a quarter turn left of the outward axis, a turn by `a` moves a point
/// at `along` outwards by `-a along`.
fn fit_lines(sides: &[ScanLines; 4], pitch: f64, fitting: &Fitting) -> (f64, [SideFit; 4]) {
    let mut offsets = [0.0; 4];
    for (offset, side) in offsets.iter_mut().zip(sides) {
        let mut beyond: Vec<f64> = side.crossings.iter().map(|c| c.beyond).collect();
        if !beyond.is_empty() {
            let middle = beyond.len() / 2;
            *offset = *beyond.select_nth_unstable_by(middle, f64::total_cmp).1;
        }
    }
    let mut turn = 0.0;
    let mut seen = [0.0; 4];
    let mut lit = [0.0; 4];
    let any_clear = sides.iter().any(|side| {
        !side.shadowed && side.crossings.len() as f64 >= fitting.turn_seen * side.lines as f64
    });
    for (round, width) in [3.0, 2.0, 1.2, 1.0, 1.0].into_iter().enumerate() {
        let scale = 1.0 / (width * pitch).powi(2);
        let (mut top, mut bottom) = (0.0, 1e-12);
        let mut turning = 0;
        let mut means = [(0.0, 0.0); 4];
        for (k, side) in sides.iter().enumerate() {
            let (mut w, mut wt, mut wd, mut wtt, mut wtd, mut wl, mut close) =
                (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0usize);
            for c in &side.crossings {
                let error = c.beyond - offsets[k] + turn * c.along;
                let q = error * error * scale;
                // At last the plain mean of all that are close: how many of them lie a pixel farther out tells
                // where between two pixels the side is, and a mean has the inset that was reckoned.
                let weight = if round == 4 {
                    f64::from(u8::from(q < 3.0))
                } else {
                    1.0 / ((1.0 + q) * (1.0 + q))
                };
                close += usize::from(q < 2.25);
                w += weight;
                wt += weight * c.along;
                wd += weight * c.beyond;
                wtt += weight * c.along * c.along;
                wtd += weight * c.along * c.beyond;
                wl += weight * f64::from(u8::from(c.lit));
            }
            seen[k] = close as f64 / side.lines as f64;
            if w < 1.0 {
                continue;
            }
            let (mean_t, mean_d) = (wt / w, wd / w);
            means[k] = (mean_t, mean_d);
            lit[k] = wl / w;
            if seen[k] >= fitting.turn_seen && (!side.shadowed || !any_clear) {
                turning += 1;
                top += wtd - w * mean_t * mean_d;
                bottom += wtt - w * mean_t * mean_t;
            }
        }
        turn = if turning >= fitting.least_turning {
            -(top / bottom).clamp(-0.05, 0.05)
        } else {
            0.0
        };
        for k in 0..4 {
            offsets[k] = means[k].1 + turn * means[k].0;
        }
    }
    let fits = [0, 1, 2, 3].map(|k| SideFit {
        seen: seen[k],
        offset: offsets[k],
        shadowed: sides[k].shadowed,
        lit: lit[k],
    });
    (turn, fits)
}
