//! Two cartons of one known size that look like one of another. Where gaps are narrower than a pixel, the one between
//! them may fall between two rows of pixels along all of its length; then only their heights tell two from one, and
//! only if cartons hereabouts differ in height by much more than what noise hides.

use depal_frames::{Point, Vector};

use crate::{
    DetectedBox, Detection, RejectReason, RejectedSurface, VisionSettings,
    breaks::BY_CHANCE,
    gaps::{is_wide, narrowest_gap},
    gate::DepthImage,
    noise::noise_of_pixels,
    parts::made_of_others,
    patch::pixel_pitch,
    plane::{Plane, PlaneFrame},
};

/// Tops of one layer are at most this far apart in height, metres.
const LEVEL: f64 = 0.01;
/// Neighbours are at most this far apart, metres.
const FARTHEST: f64 = 0.010;
/// Fewer pairs of neighbours say nothing of how cartons differ.
const LEAST_PAIRS: usize = 3;
/// Half of all neighbours must differ by so many times the step that noise hides. How two planes differ at both ends of
/// a side are two numbers, so that the share that differs by less than a part of the median goes with its square: half
/// of 1/25 is one in fifty, and of those the gap must hide as well.
const TELLING: f64 = 5.0;

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
    let refused: Vec<usize> = doubtful
        .into_iter()
        .filter(|&n| {
            let b = &detection.boxes[n];
            let pitch = b.camera_from_box.translation.z / image.intrinsics.fx;
            // A step in the middle leaves a quarter of itself after the best single plane, on all pixels.
            let pixels = b.size.length * b.size.width / (pitch * pitch);
            let hidden = noise * (16.0 * BY_CHANCE / pixels).sqrt();
            !median_step(&detection.boxes, b).is_some_and(|step| step >= TELLING * hidden)
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

fn is_doubtful(image: &DepthImage, settings: &VisionSettings, b: &DetectedBox) -> bool {
    made_of_others(settings, b.label as usize) && {
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
        has_narrow_gaps(image, settings, &frame, [b.size.length, b.size.width])
    }
}

/// True when a gap beside a rectangle is so narrow that one like it could hide within.
pub fn has_narrow_gaps(
    image: &DepthImage,
    settings: &VisionSettings,
    frame: &PlaneFrame,
    extents: [f64; 2],
) -> bool {
    narrowest_gap(image, frame, extents, settings.plane_tolerance)
        .is_some_and(|gap| !is_wide(gap, pixel_pitch(frame, &image.intrinsics)))
}

/// Median over all pairs of neighbours in the layer of `of` of how far their planes are apart at the ends of their
/// common side, metres; `None` where there are few.
fn median_step(boxes: &[DetectedBox], of: &DetectedBox) -> Option<f64> {
    let layer: Vec<&DetectedBox> = boxes
        .iter()
        .filter(|b| seen_from(of, b).z.abs() <= LEVEL)
        .collect();
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
