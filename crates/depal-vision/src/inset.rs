//! Stage 8a: how far inside the real edges of this image the edges lie that its pixels show.
//!
//! At a step some of the outermost pixels are lost or lie between both surfaces, so a side seems to lie inside the
//! real one. How much is lost depends on the camera, and on whether it sees anything beyond the side: some cameras
//! tear only steps between two measured surfaces, others also those into a shadow. A carton with one side of each
//! sort then seems to lie beside its place. Both insets follow from cartons that show two opposite sides, since
//! their size is known; an error of that size itself is common to all and moves no carton.

use depal_frames::{Point, Vector};
use nalgebra::{Matrix2, Vector2};

use crate::{
    DetectedBox, VisionSettings,
    gate::{DepthImage, LEAST_SMEAR},
    patch::pixel_pitch,
    plane::{Plane, PlaneFrame},
    sides::{Fitting, INSET_PIXELS, SIDE_PIXELS, fit_rectangle},
    verify::{LEAST_SEEN, sharp_tolerance},
};

/// How much the insets of cameras differ, pixels: from next to nothing to most of the outermost pixels.
const SPREAD: f64 = 0.3;
/// Sums farther from what is expected than so many deviations count less and less.
const LOOSE: f64 = 2.0;

/// Insets in pixels, of sides beyond which something deeper is seen, and of those beyond which nothing is.
#[derive(Debug, Clone, Copy)]
pub struct Insets {
    pub lit: f64,
    pub dark: f64,
}

impl Insets {
    /// What is expected of a camera before its image was looked at.
    pub const USUAL: Self = Self {
        lit: INSET_PIXELS,
        dark: INSET_PIXELS,
    };

    /// True when the two differ by more than a side is known: less comes of how sides lie to the pixel rows.
    pub fn differ(&self) -> bool {
        (self.lit - self.dark).abs() > SIDE_PIXELS
    }

    /// Of a side that is lit on a share of its length, pixels.
    pub fn of(&self, lit: f64) -> f64 {
        self.lit * lit + self.dark * (1.0 - lit)
    }
}

/// Least squares over observed insets, drawn to what is usual.
pub struct InsetSums {
    matrix: Matrix2<f64>,
    right: Vector2<f64>,
}

impl InsetSums {
    pub fn new() -> Self {
        let weight = 1.0 / (SPREAD * SPREAD);
        Self {
            matrix: Matrix2::identity() * weight,
            right: Vector2::repeat(INSET_PIXELS * weight),
        }
    }

    /// Takes in that `lit` times the one and `dark` times the other inset are so many pixels together.
    pub fn add(&mut self, lit: f64, dark: f64, pixels: f64, weight: f64) {
        let row = Vector2::new(lit, dark);
        self.matrix += row * row.transpose() * weight;
        self.right += row * (pixels * weight);
    }

    pub fn solve(&self) -> Insets {
        match self.matrix.cholesky() {
            Some(factor) => {
                let found = factor.solve(&self.right);
                Insets {
                    lit: found.x,
                    dark: found.y,
                }
            }
            None => Insets::USUAL,
        }
    }
}

/// Two opposite sides of a box that were both seen.
struct Opposite {
    found: usize,
    direction: Vector,
    pitch: f64,
    /// Shares of the lower and the upper side that are lit.
    lit: [f64; 2],
    /// By how many pixels they seem to lie too close together.
    short: f64,
}

/// Moves boxes with seen opposite sides to where the insets of this image put them.
pub fn place_by_insets(boxes: &mut [DetectedBox], image: &DepthImage, settings: &VisionSettings) {
    // Smeared sides have no torn pixels.
    if settings.smear_px >= LEAST_SMEAR {
        return;
    }
    let seen: Vec<Opposite> = boxes
        .iter()
        .enumerate()
        .flat_map(|(n, found)| opposite_sides(n, found, image, settings))
        .collect();
    let insets = insets_of(&seen);
    if insets.differ() {
        for pair in &seen {
            let shift = pair.shift(&insets);
            boxes[pair.found].camera_from_box.translation.vector += shift;
        }
    }
}

impl Opposite {
    /// From where the middle of both sides is seen to where it is.
    fn shift(&self, insets: &Insets) -> Vector {
        self.direction * ((insets.of(self.lit[1]) - insets.of(self.lit[0])) / 2.0 * self.pitch)
    }
}

/// What the opposite sides of all cartons tell together.
fn insets_of(seen: &[Opposite]) -> Insets {
    const ROUNDS: usize = 4;
    let deviation = SIDE_PIXELS * std::f64::consts::SQRT_2;
    let mut insets = Insets::USUAL;
    for _ in 0..ROUNDS {
        let mut sums = InsetSums::new();
        for pair in seen {
            let lit = pair.lit[0] + pair.lit[1];
            let off = pair.short - insets.of(pair.lit[0]) - insets.of(pair.lit[1]);
            let loose = 1.0 + (off / (LOOSE * deviation)).powi(2);
            let weight = 1.0 / (deviation * loose).powi(2);
            sums.add(lit, 2.0 - lit, pair.short, weight);
        }
        insets = sums.solve();
    }
    insets
}

fn opposite_sides(
    n: usize,
    found: &DetectedBox,
    image: &DepthImage,
    settings: &VisionSettings,
) -> Vec<Opposite> {
    let frame = frame_of(found);
    let fit = fit_rectangle(
        image,
        frame,
        [found.size.length, found.size.width],
        sharp_tolerance(image, &frame, settings),
        &Fitting {
            least_seen: LEAST_SEEN,
            turn_seen: 2.0,
            least_turning: 4,
            passes: &[(3.5, 3.0)],
            sides: [true; 4],
        },
    );
    let pitch = pixel_pitch(&frame, &image.intrinsics);
    [frame.x, frame.y]
        .into_iter()
        .zip(fit.sides.as_chunks::<2>().0)
        .filter(|(_, [low, high])| low.is_true_edge(LEAST_SEEN) && high.is_true_edge(LEAST_SEEN))
        .map(|(direction, [low, high])| Opposite {
            found: n,
            direction,
            pitch,
            lit: [low.lit, high.lit],
            short: -(low.offset + high.offset) / pitch,
        })
        .collect()
}

/// Origin in the middle of the top, X along the long side.
pub fn frame_of(found: &DetectedBox) -> PlaneFrame {
    let pose = &found.camera_from_box;
    let origin = Point::from(pose.translation.vector);
    let axis = |k: usize| pose.rotation * Vector::ith(k, 1.0);
    let normal = axis(2);
    PlaneFrame {
        plane: Plane {
            coefficient: normal / normal.dot(&origin.coords),
        },
        origin,
        x: axis(0),
        y: axis(1),
    }
}

#[cfg(test)]
mod tests;
