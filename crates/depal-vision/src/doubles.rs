//! Two cartons of one known size that look like one of another. A gap narrower than a pixel may fall between two rows of
//! pixels along all of its length; then only their heights tell two from one. How likely it is that both fail follows
//! from the other cartons of the layer: how many gaps are not seen, and by how much neighbours differ in height.

use depal_frames::{Point, Vector};

use crate::{
    DetectedBox, Detection, RejectReason, RejectedSurface, VisionSettings,
    breaks::BY_CHANCE,
    gaps::lost_beside,
    gate::DepthImage,
    noise::noise_of_pixels,
    parts::made_of_others,
    plane::{Plane, PlaneFrame},
};

/// Tops of one layer are at most this far apart in height, metres.
const LEVEL: f64 = 0.01;
/// Neighbours are at most this far apart, metres.
const FARTHEST: f64 = 0.010;
/// Fewer pairs of neighbours say nothing of how cartons differ.
const LEAST_PAIRS: usize = 3;
/// A gap that loses so many pixels is wider than one: of those none can hide.
const WIDER_THAN_A_PIXEL: f64 = 1.5;
/// One that loses fewer is not seen.
const SEEN: f64 = 0.5;
/// A box is refused where two cartons look like it with more than this chance.
const LIKELY: f64 = 0.02;

/// Refuses each box that smaller known cartons would make up as well, where neither gaps nor heights say that they do
/// not.
pub fn refuse_doubles(image: &DepthImage, settings: &VisionSettings, detection: &mut Detection) {
    let doubtful: Vec<usize> = (0..detection.boxes.len())
        .filter(|&n| is_doubtful(image, settings, &detection.boxes[n]))
        .collect();
    if doubtful.is_empty() {
        return;
    }
    let noise = noise_of_pixels(image.depth, image.width).unwrap_or(0.0);
    let lost: Vec<[Option<f64>; 4]> = detection
        .boxes
        .iter()
        .map(|b| lost_at(image, settings, b))
        .collect();
    let refused: Vec<usize> = doubtful
        .into_iter()
        .filter(|&n| {
            let b = &detection.boxes[n];
            let pitch = b.camera_from_box.translation.z / image.intrinsics.fx;
            // A step in the middle leaves a quarter of itself after the best single plane, on all pixels.
            let pixels = b.size.length * b.size.width / (pitch * pitch);
            let hidden = noise * (16.0 * BY_CHANCE / pixels).sqrt();
            chance(&detection.boxes, &lost, b, hidden) > LIKELY
        })
        .collect();
    for n in refused.into_iter().rev() {
        let b = detection.boxes.remove(n);
        detection.rejected.push(RejectedSurface {
            reason: RejectReason::Ambiguous,
            centre_in_camera: Point::from(b.camera_from_box.translation.vector),
            area: b.size.length * b.size.width,
        });
    }
}

/// The chance that a gap like those in the layer of `of` is not seen and heights differ by less than noise hides,
/// `hidden` metres. How two planes differ at both ends of a side are two numbers, so that the share of neighbours that
/// differ by less than a part of the median goes with the square of that part.
fn chance(boxes: &[DetectedBox], lost: &[[Option<f64>; 4]], of: &DetectedBox, hidden: f64) -> f64 {
    let layer = |b: &DetectedBox| seen_from(of, b).z.abs() <= LEVEL;
    let gaps: Vec<f64> = boxes
        .iter()
        .zip(lost)
        .filter(|(b, _)| layer(b))
        .flat_map(|(_, sides)| sides.iter().flatten().copied())
        .collect();
    let unseen = gaps.iter().filter(|&&lost| lost < SEEN).count();
    // Laplace's rule of succession: none unseen of few is no proof.
    let hides = (unseen + 1) as f64 / (gaps.len() + 2) as f64;
    let in_layer: Vec<&DetectedBox> = boxes.iter().filter(|b| layer(b)).collect();
    let alike = match median_step(&in_layer) {
        Some(step) => (0.5 * (hidden / step).powi(2)).min(1.0),
        None => 1.0,
    };
    hides * alike
}

/// True for a box that smaller known cartons would make up as well, with a gap that may hide.
pub fn is_doubtful(image: &DepthImage, settings: &VisionSettings, b: &DetectedBox) -> bool {
    made_of_others(settings, b.label as usize)
        && lost_at(image, settings, b)
            .into_iter()
            .flatten()
            .any(|lost| lost < WIDER_THAN_A_PIXEL)
}

/// Pixels lost at its sides where others stand beside it.
fn lost_at(image: &DepthImage, settings: &VisionSettings, b: &DetectedBox) -> [Option<f64>; 4] {
    let origin = Point::from(b.camera_from_box.translation.vector);
    let axis = |k: usize| b.camera_from_box.rotation * Vector::ith(k, 1.0);
    let normal = axis(2);
    let frame = PlaneFrame {
        plane: Plane {
            coefficient: normal / normal.dot(&origin.coords),
        },
        origin,
        x: axis(0),
        y: axis(1),
    };
    let extents = [b.size.length, b.size.width];
    lost_beside(image, &frame, extents, settings.plane_tolerance)
}

/// Median over all pairs of neighbours of how far their planes are apart at the ends of their common side, metres;
/// `None` where there are few.
fn median_step(layer: &[&DetectedBox]) -> Option<f64> {
    let mut steps: Vec<f64> = Vec::new();
    for (n, a) in layer.iter().enumerate() {
        steps.extend(layer[n + 1..].iter().filter_map(|b| step(a, b)));
    }
    let middle = steps.len() / 2;
    (steps.len() >= LEAST_PAIRS).then(|| *steps.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The middle of the second's top in the first's axes, metres.
fn seen_from(a: &DetectedBox, b: &DetectedBox) -> Vector {
    let middle = Point::from(b.camera_from_box.translation.vector);
    a.camera_from_box.inverse_transform_point(&middle).coords
}

/// The larger of the two steps at the ends of the side that two cartons have in common, metres; `None` if they have
/// none.
fn step(a: &DetectedBox, b: &DetectedBox) -> Option<f64> {
    /// A common side is at least this long, metres.
    const LEAST_COMMON: f64 = 0.04;
    let to = seen_from(a, b);
    let turned = |v: Vector| {
        a.camera_from_box
            .rotation
            .inverse_transform_vector(&(b.camera_from_box.rotation * v))
    };
    let (x, normal) = (turned(Vector::x()), turned(Vector::z()));
    let mine = [a.size.length / 2.0, a.size.width / 2.0];
    let mut other = [b.size.length / 2.0, b.size.width / 2.0];
    if x.y.abs() > x.x.abs() {
        other.swap(0, 1);
    }
    (0..2).find_map(|axis| {
        let across = 1 - axis;
        let gap = to[axis].abs() - mine[axis] - other[axis];
        let low = (-mine[across]).max(to[across] - other[across]);
        let high = mine[across].min(to[across] + other[across]);
        if gap.abs() > FARTHEST || high - low < LEAST_COMMON {
            return None;
        }
        let height = |end: f64| {
            let mut at = [0.0; 2];
            at[axis] = mine[axis] * to[axis].signum();
            at[across] = end;
            to.z - (normal.x * (at[0] - to.x) + normal.y * (at[1] - to.y)) / normal.z
        };
        Some(height(low).abs().max(height(high).abs()))
    })
}
