//! Stage 8c: cartons with rounded edges are placed by where their tops begin to fall.
//!
//! How far down a rounded edge is seen depends on from where it is looked at: the side towards the camera's axis is
//! seen down to its wall, the one away from it is lost before, where light grazes it. What ends of surfaces tell is
//! then off towards the axis, by a millimetre for each metre beside it. How the top falls before it is lost is the
//! same at all sides. So the radius is taken from the fall of all sides of the picture together, and each side from
//! where its own fall begins; an error of the radius is the same at opposite sides and moves no carton.

mod strip;

use depal_frames::Vector;
use strip::Strip;

use crate::{
    DetectedBox, VisionSettings, gate::DepthImage, patch::pixel_pitch, plane::PlaneFrame,
    sharp::sharp_tolerance,
};

/// Width of the bins of a profile, metres.
const BIN: f64 = 0.000_25;
/// Where the profile of all sides begins and ends, from where the known size puts the side, metres.
const INSIDE: f64 = 0.016;
const BEYOND: f64 = 0.001;
const BINS: usize = 68;
/// Lines across sides from which the radius is taken.
const LINES: f64 = 2000.0;
/// A mean fall of so much is no sharp edge, metres: what noise and pixels that look aside leave there is a third.
const FALLS: f64 = 0.000_1;
/// Edges of less than this radius cannot be told from sharp ones, metres.
const SHARPEST: f64 = 0.000_75;
/// The fall is followed down to this, metres, or to this share of the radius, where it is at 45 degrees: below, a
/// camera loses more of it at one side than at the other.
const DEEPEST: f64 = 0.000_6;
const DEEPEST_SHARE: f64 = 0.29;
/// So much of the flat top before the fall tells its level, metres.
const LEVEL: f64 = 0.004;

/// A rounded edge, a quarter of a cylinder of that radius, metres.
#[derive(Debug, Clone, Copy)]
struct Fold {
    radius: f64,
}

impl Fold {
    /// How far the fall is followed from where it begins, metres.
    fn followed(&self) -> f64 {
        let fall = DEEPEST.min(DEEPEST_SHARE * self.radius);
        (fall * (2.0 * self.radius - fall)).sqrt()
    }

    /// Fall and slope at a distance from where it begins, metres and metres per metre.
    fn fall(&self, x: f64) -> (f64, f64) {
        if x <= 0.0 {
            return (0.0, 0.0);
        }
        let below = (self.radius * self.radius - x * x).max(1e-12).sqrt();
        (self.radius - below, x / below)
    }
}

/// Moves boxes to where the falls of their sides put them, where the edges of this image are rounded.
pub fn place_by_folds(boxes: &mut [DetectedBox], image: &DepthImage, settings: &VisionSettings) {
    /// The second time the places of the first blur the common fall no more.
    const ROUNDS: usize = 2;
    // Smeared steps and averaged depths have no edge that could be told from a round one.
    if settings.is_smeared() || settings.average_px > 0 {
        return;
    }
    let tolerances: Vec<f64> = boxes
        .iter()
        .map(|found| sharp_tolerance(image, &PlaneFrame::of_top(found), settings))
        .collect();
    for _ in 0..ROUNDS {
        let Some(fold) = fold_of(boxes, &tolerances, image) else {
            return;
        };
        place(boxes, &tolerances, &fold, image);
    }
}

/// Moves boxes to where the falls of their sides put them.
fn place(boxes: &mut [DetectedBox], tolerances: &[f64], fold: &Fold, image: &DepthImage) {
    /// No carton is moved farther than this, pixels.
    const FARTHEST: f64 = 1.5;
    /// Opposite sides are as far apart as with the other cartons, or one of them is none, metres.
    const ALIKE: f64 = 0.001;
    let mut pixels = Vec::new();
    let sides: Vec<[[Option<f64>; 2]; 2]> = boxes
        .iter()
        .zip(tolerances)
        .map(|(found, tolerance)| {
            [[0, 1], [2, 3]].map(|pair| {
                pair.map(|side| {
                    let strip = Strip::new(image, found, side);
                    side_by_fall(&strip, fold, *tolerance, &mut pixels)
                })
            })
        })
        .collect();
    let mut beyond: Vec<f64> = sides
        .iter()
        .flatten()
        .filter_map(|[low, high]| Some(f64::midpoint((*low)?, (*high)?)))
        .collect();
    if beyond.is_empty() {
        return;
    }
    let middle = beyond.len() / 2;
    let common = *beyond.select_nth_unstable_by(middle, f64::total_cmp).1;
    for (found, sides) in boxes.iter_mut().zip(sides) {
        let frame = PlaneFrame::of_top(found);
        let shift = sides.map(|side| match side {
            [Some(low), Some(high)] if (low + high - 2.0 * common).abs() <= ALIKE => {
                (high - low) / 2.0
            }
            [Some(low), None] => common - low,
            [None, Some(high)] => high - common,
            _ => 0.0,
        });
        let most = FARTHEST * pixel_pitch(&frame, &image.intrinsics);
        if shift.iter().all(|s| s.abs() <= most) {
            let by: Vector = frame.x * shift[0] + frame.y * shift[1];
            found.camera_from_box.translation.vector += by;
        }
    }
}

/// The fold that the sides of all boxes show together, if their edges are rounded.
fn fold_of(boxes: &[DetectedBox], tolerances: &[f64], image: &DepthImage) -> Option<Fold> {
    let strips: Vec<Strip> = boxes
        .iter()
        .flat_map(|found| [0, 1, 2, 3].map(|side| Strip::new(image, found, side)))
        .collect();
    let lines: f64 = strips.iter().map(|strip| strip.length / strip.pitch).sum();
    let stride = (lines / LINES).max(1.0);
    let mut profile = [Bin::default(); BINS];
    for (strip, tolerance) in strips.iter().zip(tolerances.iter().flat_map(|t| [t; 4])) {
        // By where the pixels look: where their points lie, a bin between two rows would gather the deepest alone.
        strip.walk(-INSIDE, BEYOND, stride, |looked_at, _, fall| {
            let bin = (looked_at + INSIDE) / BIN;
            if bin >= 0.0 && bin < BINS as f64 && fall > -tolerance && fall < tolerance + DEEPEST {
                let bin = &mut profile[bin as usize];
                bin.count += 1.0;
                bin.sum += fall;
                bin.squares += fall * fall;
            }
        });
    }
    let pitch = strips.iter().map(|strip| strip.pitch).fold(0.0, f64::max);
    fold_of_profile(&profile, (pitch / BIN).ceil() as usize)
}

/// Falls of pixels at about the same distance from a side.
#[derive(Debug, Clone, Copy, Default)]
struct Bin {
    count: f64,
    sum: f64,
    squares: f64,
}

impl std::ops::Add for Bin {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
        }
    }
}

/// The fold of a mean profile; a pixel is so many bins wide.
fn fold_of_profile(profile: &[Bin; BINS], pixel: usize) -> Option<Fold> {
    /// Bins of the flat top from which its level and its number of pixels are taken.
    const FLAT: usize = 16;
    /// Where the side's known place is: beyond it a neighbour without a gap begins.
    const SIDE: usize = (INSIDE / BIN) as usize;
    /// A fall is none that is less than so many of its deviations.
    const SURE: f64 = 5.0;
    /// A rounding leaves at most this share of the squared falls.
    const EXPLAINED: f64 = 0.3;
    /// Radii that are tried, metres.
    const LEAST: f64 = 0.000_5;
    const STEP: f64 = 0.000_125;
    const RADII: usize = 120;
    let flat = profile[..FLAT]
        .iter()
        .fold(Bin::default(), |sum, bin| sum + *bin);
    if flat.count < 4.0 * FLAT as f64 {
        return None;
    }
    let level = flat.sum / flat.count;
    let variance = (flat.squares / flat.count - level * level).max(0.0);
    let dense = flat.count / FLAT as f64 / 2.0;
    let fall = |bin: &Bin| bin.sum / bin.count.max(1.0) - level;
    // Up to where the surface ends, or falls deeper than it is followed. Sides along the rows of pixels have all
    // of them in one bin.
    let end = (FLAT..SIDE)
        .find(|&n| {
            let half = (pixel / 2).min(n);
            let around = &profile[n - half..BINS.min(n + half + 1)];
            let count: f64 = around.iter().map(|bin| bin.count).sum();
            count < dense * around.len() as f64 || fall(&profile[n]) > DEEPEST
        })
        .unwrap_or(SIDE);
    let seen = &profile[..end];
    let falls = |bin: &Bin| {
        let least = FALLS.max(SURE * (variance / bin.count.max(1.0)).sqrt());
        fall(bin) > least
    };
    if !seen[FLAT..].iter().any(falls) {
        return None;
    }
    let misfit = |fold: &Fold| -> f64 {
        let at = |n: usize| (n as f64 + 0.5) * BIN - INSIDE + fold.radius;
        let off = |n: usize, bin: &Bin| fall(bin) - fold.fall(at(n).min(fold.radius)).0;
        seen.iter()
            .enumerate()
            .map(|(n, bin)| bin.count * off(n, bin).powi(2))
            .sum()
    };
    let best = (0..RADII)
        .map(|n| Fold {
            radius: LEAST + STEP * n as f64,
        })
        .map(|fold| (misfit(&fold), fold))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    // A single deep bin that no rounding explains is none.
    let flat: f64 = seen.iter().map(|bin| bin.count * fall(bin).powi(2)).sum();
    best.filter(|(misfit, fold)| fold.radius >= SHARPEST && *misfit < EXPLAINED * flat)
        .map(|(_, fold)| fold)
}

/// How far beyond its known place a side lies by where its fall begins, metres; `None` where too little is seen.
fn side_by_fall(
    strip: &Strip,
    fold: &Fold,
    tolerance: f64,
    pixels: &mut Vec<[f64; 2]>,
) -> Option<f64> {
    /// Lines are so many pixels apart.
    const STRIDE: f64 = 2.0;
    const ROUNDS: usize = 6;
    /// A side farther than this from its known place is none, metres.
    const SEARCHED: f64 = 0.002_5;
    /// Places to start from, to both sides of the known one, and how far apart, metres.
    const STARTS: i32 = 3;
    const APART: f64 = 0.000_5;
    /// Of so many pixels one tells where to start.
    const SPARSE: usize = 4;
    /// Share of the pixels on the followed part that must be seen.
    const LEAST_SEEN: f64 = 0.4;
    let followed = fold.followed();
    let start = -fold.radius;
    pixels.clear();
    let lines = strip.walk(
        start - LEVEL - SEARCHED,
        start + followed + SEARCHED,
        STRIDE,
        |_, outward, fall| pixels.push([outward, fall]),
    );
    // The fall of a side that lies elsewhere is followed from where it fits roughly.
    let misfit = |beyond: f64| {
        let (mut sum, mut count) = (0.0, 1e-12);
        for [outward, fall] in pixels.iter().step_by(SPARSE) {
            let x = outward - start - beyond;
            if x >= -LEVEL && x <= followed {
                let error = (fall - fold.fall(x).0).abs().min(tolerance);
                sum += error * error;
                count += 1.0;
            }
        }
        sum / count
    };
    let roughly = (-STARTS..=STARTS)
        .map(|n| f64::from(n) * APART)
        .map(|beyond| (misfit(beyond), beyond))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let (mut beyond, mut level) = (roughly.map_or(0.0, |r| r.1), 0.0);
    let mut count = 0.0;
    for _ in 0..ROUNDS {
        // Normal equations of level and place; the fall of a side farther out is less.
        let (mut n, mut g, mut gg, mut e, mut ge) = (0.0, 0.0, 1e-12, 0.0, 0.0);
        count = 0.0;
        for [outward, fall] in pixels.iter() {
            let x = outward - start - beyond;
            if x < -LEVEL || x > followed {
                continue;
            }
            let (expected, slope) = fold.fall(x);
            let error = fall - level - expected;
            if error.abs() > tolerance {
                continue;
            }
            count += f64::from(u8::from(x > 0.0));
            n += 1.0;
            g -= slope;
            gg += slope * slope;
            e += error;
            ge -= slope * error;
        }
        let determinant = n * gg - g * g;
        if determinant <= 1e-9 {
            return None;
        }
        level += (gg * e - g * ge) / determinant;
        beyond += (n * ge - g * e) / determinant;
        if beyond.abs() > SEARCHED {
            return None;
        }
    }
    let expected = lines as f64 * followed / strip.pitch;
    (count >= LEAST_SEEN * expected).then_some(beyond)
}

#[cfg(test)]
mod tests;
