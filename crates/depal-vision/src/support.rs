//! Stage 7f: which tops of unknown size are believed. One outline may be two cartons that touch; what else the picture
//! shows tells.
//!
//! A size is supported by every top that is plainly one, and contradicted by every one of the same sides that is parted
//! by a seam or a step. A top that smaller sizes seen in the picture would make up, put side by side, may just be those:
//! such a size must be seen more than once, for two that touch and lie quite level are chance, and the same chance
//! again is rare.

use depal_frames::{BoxSize, Point, Vector};
use nalgebra::Translation3;

use crate::{DetectedBox, RejectReason, RejectedSurface};

/// Two sides measured, each to less than two millimetres.
const ALIKE: f64 = 0.003;
/// The same where one of the two is known to a pixel or two only.
const ROUGHLY_ALIKE: f64 = 0.006;
/// What each carton of a row adds to that: a gap too narrow to be seen.
const NARROW: f64 = 0.0015;
/// A size that others make up must be seen so often.
const REPEATED: usize = 2;

/// How sure it is that a measured top is one whole carton.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// It ends at all four sides, and nothing parts it.
    Certain,
    /// Beside one of its sides something nearer stands, behind a gap or on the surface with a shadow beside it, or its
    /// heights leave it open: only others of the same sides tell that this one is.
    InQuestion,
    /// A seam or a step parts it.
    Parted,
}

/// A top that was measured.
pub struct Measured {
    /// Its box.
    pub found: DetectedBox,
    /// How sure it is.
    pub standing: Standing,
    /// Sides (-X, +X, -Y, +Y) whose end is not to be seen for what is nearer.
    pub blind: [bool; 4],
}

impl Measured {
    fn sides(&self) -> [f64; 2] {
        let BoxSize { length, width, .. } = self.found.size;
        [length, width]
    }

    /// The box as long as others of its size along an axis of which a side is not to be seen; the other side stays.
    fn completed(&self, size: [f64; 2]) -> DetectedBox {
        let mut sides = self.sides();
        let mut shift = Vector::zeros();
        for axis in 0..2 {
            let [low, high] = [self.blind[2 * axis], self.blind[2 * axis + 1]];
            if low || high {
                let more = size[axis] - sides[axis];
                shift[axis] = 0.5 * more * (f64::from(u8::from(high)) - f64::from(u8::from(low)));
                sides[axis] = size[axis];
            }
        }
        DetectedBox {
            camera_from_box: self.found.camera_from_box * Translation3::from(shift),
            size: BoxSize {
                length: sides[0],
                width: sides[1],
                height: self.found.size.height,
            },
            ..self.found
        }
    }
}

/// Each that is believed, with a confidence that says how well its size is supported; the others with the reason.
pub fn believed(measured: Vec<Measured>) -> Vec<Result<DetectedBox, RejectedSurface>> {
    let supported = supported(&measured);
    let judged = |top: Measured| {
        let alike = |sides: &&[f64; 2]| are_alike(sides, &top.sides(), ALIKE);
        let count = supported.iter().filter(alike).count();
        if count > 0 && top.standing != Standing::Parted {
            let mean = [0, 1].map(|k| {
                let alike = supported.iter().filter(alike);
                alike.map(|sides| sides[k]).sum::<f64>() / count as f64
            });
            let confidence = top.found.confidence * support(count);
            return Ok(DetectedBox {
                confidence,
                ..top.completed(mean)
            });
        }
        let [length, width] = top.sides();
        Err(RejectedSurface {
            reason: if top.standing == Standing::InQuestion {
                RejectReason::NoKnownSize
            } else {
                RejectReason::Ambiguous
            },
            centre_in_camera: Point::from(top.found.camera_from_box.translation.vector),
            area: length * width,
        })
    };
    measured.into_iter().map(judged).collect()
}

/// The different sizes of some tops, each the mean of those that are alike, and how many those are; without those that
/// smaller ones make up, for they would be found wherever such stand side by side.
pub fn sizes_of(found: &[DetectedBox]) -> Vec<(BoxSize, usize)> {
    let mut sizes: Vec<([f64; 2], usize)> = Vec::new();
    for one in found {
        let sides = [one.size.length, one.size.width];
        match sizes
            .iter_mut()
            .find(|(mean, _)| are_alike(mean, &sides, ALIKE))
        {
            Some((mean, count)) => {
                let n = *count as f64;
                *mean = [0, 1].map(|k| (mean[k] * n + sides[k]) / (n + 1.0));
                *count += 1;
            }
            None => sizes.push((sides, 1)),
        }
    }
    sizes.sort_by(|(a, _), (b, _)| (a[0] * a[1]).total_cmp(&(b[0] * b[1])));
    let mut smaller: Vec<[f64; 2]> = Vec::new();
    sizes.retain(|(sides, _)| {
        let is_basic = !is_made_up(sides, &smaller);
        if is_basic {
            smaller.push(*sides);
        }
        is_basic
    });
    let size = |([length, width], count): ([f64; 2], usize)| {
        let height = 0.0;
        (
            BoxSize {
                length,
                width,
                height,
            },
            count,
        )
    };
    sizes.into_iter().map(size).collect()
}

/// Share of the confidence that is left where a size was seen so often: a half is in doubt without any, and each top
/// halves that.
pub fn support(count: usize) -> f64 {
    1.0 - 0.5f64.powi(1 + count.min(20) as i32)
}

/// The sides of all tops that are certain and whose size is believed.
fn supported(measured: &[Measured]) -> Vec<[f64; 2]> {
    let of = |standing: Standing| {
        let tops = measured.iter().filter(move |top| top.standing == standing);
        tops.map(Measured::sides).collect::<Vec<_>>()
    };
    let (mut certain, parted) = (of(Standing::Certain), of(Standing::Parted));
    // The smallest first: larger ones may be made up of them.
    certain.sort_by(|a, b| (a[0] * a[1]).total_cmp(&(b[0] * b[1])));
    let mut believed: Vec<[f64; 2]> = Vec::new();
    for sides in &certain {
        let count = |all: &[[f64; 2]], within: f64| {
            let same = all.iter().filter(|other| are_alike(other, sides, within));
            same.count()
        };
        let seen = count(&certain, ALIKE);
        let smaller: Vec<[f64; 2]> = believed
            .iter()
            .copied()
            .filter(|other| !are_alike(other, sides, ALIKE))
            .collect();
        let needed = if is_made_up(sides, &smaller) {
            REPEATED
        } else {
            1
        };
        if seen >= needed && seen > count(&parted, ROUGHLY_ALIKE) {
            believed.push(*sides);
        }
    }
    believed
}

fn are_alike(a: &[f64; 2], b: &[f64; 2], within: f64) -> bool {
    (0..2).all(|k| (a[k] - b[k]).abs() < within)
}

/// True when rows of cartons of these sizes, side by side, are as large as a top.
fn is_made_up(top: &[f64; 2], sizes: &[[f64; 2]]) -> bool {
    // Length and depth of each size, both ways round.
    let ways: Vec<[f64; 2]> = sizes.iter().flat_map(|&[a, b]| [[a, b], [b, a]]).collect();
    [[top[0], top[1]], [top[1], top[0]]]
        .iter()
        .any(|&[length, depth]| {
            // Depths of rows that are as long as the top.
            let rows: Vec<f64> = ways
                .iter()
                .filter(|row| {
                    let along: Vec<f64> = ways
                        .iter()
                        .filter(|way| (way[1] - row[1]).abs() < ALIKE)
                        .map(|way| way[0])
                        .collect();
                    adds_up(length, &along, ALIKE)
                })
                .map(|row| row[1])
                .collect();
            adds_up(depth, &rows, ALIKE)
        })
}

/// True when some of the parts, each as often as wanted, add up to a length.
fn adds_up(length: f64, parts: &[f64], slack: f64) -> bool {
    length.abs() <= slack
        || parts.iter().enumerate().any(|(n, part)| {
            *part <= length + slack && adds_up(length - part, &parts[n..], slack + NARROW)
        })
}

#[cfg(test)]
mod tests;
