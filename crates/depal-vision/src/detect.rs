//! The stages in order.

use depal_frames::{BoxSize, DepthFrame, Point};

use crate::{
    DetectedBox, Detection, VisionSettings,
    again::look_again,
    bearers::{Board, refuse_boards},
    between_ends::place_between_ends,
    components::{Component, components},
    doubles::refuse_doubles,
    fold::place_by_folds,
    gate::{DepthImage, gate},
    leaning::{is_about_level, leaning},
    neighbours::neighbours,
    obstacles::obstacle_points,
    smeared::find_smeared,
    steps::surface_mask,
    support::believed,
    surface::{Surface, least_pixels},
    turn_together::turn_together,
};

/// Finds every whole uncovered top face of a known size. A frame that is empty, all invalid or
/// contradicts itself gives an empty detection. Pure: the same frame gives the same bits.
pub fn detect(frame: &DepthFrame, settings: &VisionSettings) -> Detection {
    detect_staged(frame, settings, &mut |_| {})
}

/// A part of the estimation, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Valid pixels, depth range, region.
    Gate,
    /// Step mask and connected pieces with their planes.
    Pieces,
    /// Cartons whose outline can be seen.
    Outlines,
    /// Surfaces without visible gaps.
    Coverings,
    /// What no reported carton explains.
    Obstacles,
}

/// As [`detect`]; calls `entered` as each stage begins, so that a bench can tell their times.
pub fn detect_staged(
    frame: &DepthFrame,
    settings: &VisionSettings,
    entered: &mut dyn FnMut(Stage),
) -> Detection {
    entered(Stage::Gate);
    let mut cleaned = Vec::new();
    let Some(image) = gate(frame, &mut cleaned, settings) else {
        return Detection::default();
    };
    let mut detection = Detection {
        points_in_region: image.points_in_region,
        ..Detection::default()
    };
    if image.points_in_region == 0 {
        return detection;
    }
    if settings.sizes.iter().any(is_usable) {
        find_boxes(frame, &image, settings, &mut detection, entered);
    }
    entered(Stage::Obstacles);
    detection.obstacle_points = obstacle_points(&image, &detection.boxes, settings.obstacle_voxel);
    detection
}

/// Finds every whole uncovered top face of any size with four true edges, and measures it; the
/// settings' sizes are not looked at. The height is unknown and given as 0. Pure, as [`detect`].
///
/// A box that spans two cartons is worse than none, so what may be two is refused as
/// [`RejectReason::Ambiguous`](crate::RejectReason::Ambiguous): a top through which a seam or a step in height runs; one
/// whose size is parted so as often as not elsewhere in the picture; one that smaller sizes in the picture would make
/// up, unless its own size is there twice. A size measured once is looked for where cartons hang together. Cartons that
/// touch, lie level and end flush look like one larger carton: where nothing else in the picture speaks against it,
/// that one is reported. The confidence says how well a size is supported: a quarter is taken off one that is seen
/// once, an eighth off one seen twice, and so on.
pub fn detect_any_size(frame: &DepthFrame, settings: &VisionSettings) -> Detection {
    let mut cleaned = Vec::new();
    let Some(image) = gate(frame, &mut cleaned, settings) else {
        return Detection::default();
    };
    let mut detection = Detection {
        points_in_region: image.points_in_region,
        ..Detection::default()
    };
    if image.points_in_region == 0 {
        return detection;
    }
    let mask = surface_mask(
        &image,
        &image.lone_holes(),
        settings.step,
        settings.step_noise,
    );
    let least = least_pixels(&image, settings, SMALLEST_MEASURED);
    let (mut measured, mut whole, mut open) = (Vec::new(), Vec::new(), Vec::new());
    for component in components(&mask, image.width, least) {
        match Surface::new(component, &image, settings, SMALLEST_MEASURED) {
            Ok(mut surface) => match surface.measure(&mask, &image, settings) {
                Ok(top) => {
                    measured.push(top);
                    whole.push(surface);
                }
                Err(refusal) => open.push((surface, Some(refusal))),
            },
            Err(rejected) => detection.rejected.extend(rejected),
        }
    }
    let mut found: Vec<DetectedBox> = Vec::new();
    for (judged, surface) in believed(measured).into_iter().zip(whole) {
        match judged {
            Ok(one) => found.push(one),
            Err(refusal) => open.push((surface, Some(refusal))),
        }
    }
    found.extend(look_again(&mut open, &found, &mask, &image, settings));
    let refused = open.into_iter().filter_map(|(_, refusal)| refusal);
    detection.rejected.extend(refused);
    keep_best(found, settings, &mut detection);
    detection.obstacle_points = obstacle_points(&image, &detection.boxes, settings.obstacle_voxel);
    detection
}

/// Smallest top face looked for when sizes are unknown, square metres.
const SMALLEST_MEASURED: f64 = 0.02;

fn is_usable(size: &BoxSize) -> bool {
    [size.length, size.width]
        .iter()
        .all(|s| s.is_finite() && (0.02..5.0).contains(s))
}

fn find_boxes(
    frame: &DepthFrame,
    image: &DepthImage,
    settings: &VisionSettings,
    detection: &mut Detection,
    entered: &mut dyn FnMut(Stage),
) {
    entered(Stage::Pieces);
    let mask = surface_mask(
        image,
        &image.lone_holes(),
        settings.step,
        settings.step_noise,
    );
    let smallest = settings
        .sizes
        .iter()
        .filter(|s| is_usable(s))
        .map(|s| s.length * s.width)
        .fold(f64::MAX, f64::min);
    let mut found: Vec<DetectedBox> = Vec::new();
    let mut surfaces: Vec<Surface> = Vec::new();
    let least = least_pixels(image, settings, smallest);
    for component in components(&mask, image.width, least) {
        match Surface::new(component, image, settings, smallest) {
            Ok(surface) => surfaces.push(surface),
            Err(rejected) => detection.rejected.extend(rejected),
        }
    }
    let boards: Vec<Board> = surfaces
        .iter_mut()
        .filter_map(|surface| Board::new(surface, &mask, image, settings))
        .collect();
    entered(Stage::Outlines);
    // First every piece by itself, with its own direction.
    surfaces.retain_mut(|surface| {
        if let Some(single) = surface.single(&mask, image, settings) {
            surface.solved = true;
            found.push(single);
            return true;
        }
        match surface.search(&mask, image, settings, smallest) {
            Ok(boxes) => {
                found.extend(boxes);
                true
            }
            Err(rejected) => {
                detection.rejected.push(rejected);
                false
            }
        }
    });
    entered(Stage::Coverings);
    // Then what is left together with its neighbours of the same height.
    let mut covered: Vec<DetectedBox> = Vec::new();
    for group in neighbours(&surfaces, &image.intrinsics, settings) {
        let open: Vec<usize> = group
            .iter()
            .copied()
            .filter(|&s| !surfaces[s].solved)
            .collect();
        if open.is_empty() {
            continue;
        }
        let proven = proven_labels(found.iter().chain(&covered));
        let rejected = &mut detection.rejected;
        if let [alone] = group[..] {
            let more = surfaces[alone].cover(&mask, image, settings, &[], &proven, rejected);
            // Those with an outline of their own are among them, placed together with the others.
            let again = |b: &DetectedBox| {
                more.iter()
                    .any(|m| m.confidence.to_bits() == b.confidence.to_bits() && overlap(m, b))
            };
            found.retain(|b| !again(b));
            covered.extend(more);
            continue;
        }
        let mut whole = Component::default();
        for &s in &open {
            whole.pixels += surfaces[s].component.pixels;
            whole.runs.extend(&surfaces[s].component.runs);
        }
        whole.runs.sort_by_key(|r| (r.row, r.first));
        match Surface::new(whole, image, settings, smallest) {
            Ok(mut surface) => {
                let beside: Vec<DetectedBox> = found
                    .iter()
                    .chain(&covered)
                    .filter(|b| is_about_level(&surface, b, settings))
                    .cloned()
                    .collect();
                covered.extend(surface.cover(&mask, image, settings, &beside, &proven, rejected));
            }
            Err(rejected) => detection.rejected.extend(rejected),
        }
    }
    // What leans against the others is no part of their coverings, but of their sizes.
    let proven = proven_labels(found.iter().chain(&covered));
    for surface in surfaces.iter().filter(|s| !s.solved) {
        let all: Vec<&DetectedBox> = found.iter().chain(&covered).collect();
        for mut part in leaning(surface, &all, image, settings, smallest) {
            let rejected = &mut detection.rejected;
            let level = |b: &&DetectedBox| is_about_level(surface, b, settings);
            let beside: Vec<DetectedBox> = found
                .iter()
                .chain(&covered)
                .filter(level)
                .cloned()
                .collect();
            covered.extend(part.cover(&mask, image, settings, &beside, &proven, rejected));
        }
    }
    place_between_ends(&mut found, image, settings);
    found.extend(covered);
    let on_boards = refuse_boards(&mut found, &boards, settings.plane_tolerance);
    detection.rejected.extend(on_boards);
    keep_best(found, settings, detection);
    place_by_folds(&mut detection.boxes, image, settings);
    turn_together(&mut detection.boxes, &image.intrinsics);
    refuse_doubles(image, settings, detection);
    // Outlines are known roughly there: each height of the stack must be looked at as one.
    if settings.is_smeared() {
        let (mut cleaned, mut as_seen) = (Vec::new(), settings.clone());
        as_seen.smear_px = 0;
        if let Some(smeared) = gate(frame, &mut cleaned, &as_seen) {
            let more = find_smeared(&mask, image, &smeared, settings, smallest, detection);
            keep_best(more, settings, detection);
        }
    }
}

/// The sizes of which some stand proven.
fn proven_labels<'a>(boxes: impl Iterator<Item = &'a DetectedBox>) -> Vec<u32> {
    let proven = boxes.filter(|b| b.proven_sides >= 3);
    proven.map(|b| b.label).collect()
}

/// Of boxes that overlap the most confident one, inside the region, nearest first.
fn keep_best(mut found: Vec<DetectedBox>, settings: &VisionSettings, detection: &mut Detection) {
    found.sort_by(|a, b| b.confidence.total_cmp(&a.confidence).then(nearer(a, b)));
    for b in found {
        let inside_region = settings
            .region
            .as_ref()
            .is_none_or(|r| r.contains(&Point::from(b.camera_from_box.translation.vector)));
        if inside_region && !detection.boxes.iter().any(|other| overlap(other, &b)) {
            detection.boxes.push(b);
        }
    }
    detection.boxes.sort_by(nearer);
}

/// Nearest first; equal depths (to 1 mm) by row, then column of the view.
fn nearer(a: &DetectedBox, b: &DetectedBox) -> std::cmp::Ordering {
    let key = |d: &DetectedBox| d.camera_from_box.translation.vector;
    let (a, b) = (key(a), key(b));
    a.z.total_cmp(&b.z)
        .then(a.y.total_cmp(&b.y))
        .then(a.x.total_cmp(&b.x))
}

/// True when the middle of one top lies well inside the other's, at about the same height.
pub fn overlap(a: &DetectedBox, b: &DetectedBox) -> bool {
    let reach = |d: &DetectedBox| d.size.width / 2.0;
    let inside = |a: &DetectedBox, b: &DetectedBox| {
        let p = a
            .camera_from_box
            .inverse_transform_point(&Point::from(b.camera_from_box.translation.vector));
        p.x.abs() < a.size.length / 2.0 + reach(b) * 0.9
            && p.y.abs() < a.size.width / 2.0 + reach(b) * 0.9
            && p.z.abs() < 0.02
    };
    inside(a, b) && inside(b, a)
}
