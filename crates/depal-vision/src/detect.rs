//! The stages in order.

use depal_frames::{BoxSize, DepthFrame, Point};

use crate::{
    DetectedBox, Detection, RejectReason, RejectedSurface, VisionSettings,
    arrange::{arrange, touches},
    components::{Component, components},
    gate::{DepthImage, gate},
    obstacles::obstacle_points,
    orientation::{main_direction, outline},
    patch::{Patch, pixel_pitch},
    plane::{PlaneFrame, fit_plane},
    search::{Candidate, extents, search},
    sides::fit_rectangle,
    steps::surface_mask,
    verify::{LEAST_SEEN, Proof, verify},
};

/// Finds every whole uncovered top face of a known size. A frame that is empty, all invalid or
/// contradicts itself gives an empty detection. Pure: the same frame gives the same bits.
pub fn detect(frame: &DepthFrame, settings: &VisionSettings) -> Detection {
    let Some(image) = gate(frame, settings) else {
        return Detection::default();
    };
    let mut detection = Detection {
        points_in_region: image.points_in_region,
        ..Detection::default()
    };
    if image.points_in_region == 0 {
        return detection;
    }
    let settings = &VisionSettings {
        sizes: settings.sizes.clone(),
        ..settings.clone()
    };
    if settings.sizes.iter().any(is_usable) {
        find_boxes(&image, settings, &mut detection);
    }
    detection.obstacle_points = obstacle_points(&image, &detection.boxes, settings.obstacle_voxel);
    detection
}

fn is_usable(size: &BoxSize) -> bool {
    [size.length, size.width]
        .iter()
        .all(|s| s.is_finite() && (0.02..5.0).contains(s))
}

fn find_boxes(image: &DepthImage, settings: &VisionSettings, detection: &mut Detection) {
    let (depth, inside) = image.with_lone_holes_filled();
    let mask = surface_mask(&depth, &inside, image.width, image.height, settings.step);
    let smallest = settings
        .sizes
        .iter()
        .filter(|s| is_usable(s))
        .map(|s| s.length * s.width)
        .fold(f64::MAX, f64::min);
    let mut found: Vec<DetectedBox> = Vec::new();
    for component in components(&mask, image.width) {
        match surface(&component, &depth, image, settings, smallest) {
            Surface::Small => {}
            Surface::Rejected(rejected) => detection.rejected.push(rejected),
            Surface::Flat { frame, area } => {
                let centre = frame.origin;
                let boxes = boxes_on(
                    &component,
                    &mask,
                    frame,
                    image,
                    settings,
                    &mut detection.rejected,
                    area,
                );
                if boxes.is_empty()
                    && detection
                        .rejected
                        .last()
                        .is_none_or(|r| r.centre_in_camera != centre)
                {
                    let reason = RejectReason::NoKnownSize;
                    detection.rejected.push(RejectedSurface {
                        reason,
                        centre_in_camera: centre,
                        area,
                    });
                }
                found.extend(boxes);
            }
        }
    }
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
fn overlap(a: &DetectedBox, b: &DetectedBox) -> bool {
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

enum Surface {
    Small,
    Rejected(RejectedSurface),
    Flat { frame: PlaneFrame, area: f64 },
}

/// Plane and rough size of a component.
fn surface(
    component: &Component,
    depth: &[f32],
    image: &DepthImage,
    settings: &VisionSettings,
    smallest: f64,
) -> Surface {
    let k = &image.intrinsics;
    // A component smaller than this part of a carton cannot be the visible rest of one.
    const LEAST_PART: f64 = 0.25;
    let stride = (component.pixels / 4000).max(1);
    let mut samples = Vec::with_capacity(4200);
    let mut skip = stride / 2;
    for run in &component.runs {
        let length = run.last - run.first + 1;
        while skip < length {
            let u = run.first + skip;
            samples.push((
                u as f64,
                run.row as f64,
                f64::from(depth[run.row * image.width + u]),
            ));
            skip += stride;
        }
        skip -= length;
    }
    let n = samples.len().max(1) as f64;
    let (u, v, z) = samples.iter().fold((0.0, 0.0, 0.0), |s, p| {
        (s.0 + p.0 / n, s.1 + p.1 / n, s.2 + p.2 / n)
    });
    let area = component.pixels as f64 * (z / k.fx) * (z / k.fy);
    if area < LEAST_PART * smallest || samples.len() < 50 {
        return Surface::Small;
    }
    let centre_in_camera = k.deproject(u, v, z);
    let reject = |reason| {
        Surface::Rejected(RejectedSurface {
            reason,
            centre_in_camera,
            area,
        })
    };
    // Loose at first: several cartons of slightly different heights may hang together.
    let Some((plane, rms)) = fit_plane(&samples, k, 3.0 * settings.plane_tolerance) else {
        return reject(RejectReason::NotFlat);
    };
    if rms > settings.plane_tolerance {
        return reject(RejectReason::NotFlat);
    }
    if (-plane.normal().z).clamp(-1.0, 1.0).acos() > settings.max_tilt {
        return reject(RejectReason::Tilted);
    }
    Surface::Flat {
        frame: PlaneFrame::new(plane, &k.ray(u, v)),
        area,
    }
}

fn boxes_on(
    component: &Component,
    mask: &[u8],
    frame: PlaneFrame,
    image: &DepthImage,
    settings: &VisionSettings,
    rejected: &mut Vec<RejectedSurface>,
    area: f64,
) -> Vec<DetectedBox> {
    const MARGIN: f64 = 0.030;
    let pitch = pixel_pitch(&frame, &image.intrinsics);
    let border = outline(component, mask, image, &frame);
    let yaw = main_direction(&border, 2.0 * pitch);
    let frame = frame.turned(yaw);
    let (s, c) = yaw.sin_cos();
    let (mut x, mut y) = ([f64::MAX, f64::MIN], [f64::MAX, f64::MIN]);
    for &(px, py) in &border {
        let (along, across) = (px * c + py * s, py * c - px * s);
        x = [x[0].min(along), x[1].max(along)];
        y = [y[0].min(across), y[1].max(across)];
    }
    let mut refuse = |reason, centre_in_camera| {
        rejected.push(RejectedSurface {
            reason,
            centre_in_camera,
            area,
        })
    };
    if (x[1] - x[0]).max(y[1] - y[0]) > settings.max_surface_side {
        refuse(RejectReason::Background, frame.origin);
        return Vec::new();
    }
    let x = [x[0] - MARGIN, x[1] + MARGIN];
    let y = [y[0] - MARGIN, y[1] + MARGIN];
    let patch = Patch::new(image, frame, x, y, pitch, settings.plane_tolerance);
    let outlined = search(&patch, &settings.sizes, settings.min_visible);
    let mut boxes = Vec::new();
    let mut fixed = Vec::new();
    for candidate in outlined {
        let start = start_frame(&patch, &candidate);
        match verify(
            image,
            settings,
            start,
            candidate.label,
            candidate.turned,
            Proof::Outline,
        ) {
            Ok(found) => {
                boxes.push(found);
                fixed.push(candidate);
            }
            Err(reason) => refuse(reason, start.origin),
        }
    }
    let Some(arrangement) = arrange(&patch, &settings.sizes, &fixed) else {
        return boxes;
    };
    if arrangement.ambiguous {
        refuse(RejectReason::Ambiguous, patch.frame.origin);
    }
    for (candidate, start) in settle(image, settings, &patch, &arrangement.boxes, &fixed) {
        match verify(
            image,
            settings,
            start,
            candidate.label,
            candidate.turned,
            Proof::Arrangement,
        ) {
            Ok(found) => boxes.push(found),
            Err(reason) => refuse(reason, start.origin),
        }
    }
    boxes
}

/// Where an arranged box starts its exact fit: along an axis with a seen side from that side, else
/// midway between its neighbours, which share the slack of the row equally.
fn settle(
    image: &DepthImage,
    settings: &VisionSettings,
    patch: &Patch,
    arranged: &[Candidate],
    fixed: &[Candidate],
) -> Vec<(Candidate, PlaneFrame)> {
    const ROUNDS: usize = 60;
    let all: Vec<Candidate> = arranged.iter().chain(fixed).copied().collect();
    let half =
        |c: &Candidate| extents(&settings.sizes[c.label as usize], c.turned).map(|e| e / 2.0);
    let mut centres = Vec::new();
    let mut held = Vec::new();
    for candidate in &all {
        let start = start_frame(patch, candidate);
        let sides = half(candidate).map(|h| 2.0 * h);
        let fit = fit_rectangle(image, start, sides, settings.plane_tolerance, LEAST_SEEN);
        let offset = fit.frame.origin - patch.frame.origin;
        centres.push([offset.dot(&patch.frame.x), offset.dot(&patch.frame.y)]);
        held.push([0, 1].map(|axis: usize| {
            fit.sides[2 * axis].seen >= LEAST_SEEN || fit.sides[2 * axis + 1].seen >= LEAST_SEEN
        }));
    }
    for _ in 0..ROUNDS {
        for b in 0..all.len() {
            for axis in 0..2 {
                if held[b][axis] {
                    continue;
                }
                let (mut sum, mut count) = (0.0, 0.0);
                for (o, other) in all.iter().enumerate() {
                    for (side, sign) in [(2 * axis, 1.0), (2 * axis + 1, -1.0)] {
                        if o != b && touches(&all[b], other, side, patch.pitch) {
                            sum +=
                                centres[o][axis] + sign * (half(other)[axis] + half(&all[b])[axis]);
                            count += 1.0;
                        }
                    }
                }
                if count > 0.0 {
                    centres[b][axis] = sum / count;
                }
            }
        }
    }
    arranged
        .iter()
        .zip(centres)
        .map(|(candidate, [x, y])| {
            (
                *candidate,
                PlaneFrame {
                    origin: patch.frame.point(x, y),
                    ..patch.frame
                },
            )
        })
        .collect()
}

fn start_frame(patch: &Patch, candidate: &Candidate) -> PlaneFrame {
    let (x, y) = candidate.centre(patch);
    PlaneFrame {
        origin: patch.frame.point(x, y),
        ..patch.frame
    }
}
