//! Stage 5c: cartons that stand tilted hang together with those that they touch.

use depal_frames::Vector;

use crate::{
    DetectedBox, VisionSettings,
    components::{Run, connected},
    gate::DepthImage,
    plane::{Plane, PlaneFrame},
    surface::{Surface, least_pixels},
    widest::with_widest_vectors,
};

/// Lower angles are those of uneven ground and of noise, radians.
const LEAST_LEAN: f64 = 0.02;

/// Parts of a surface that rise out of its plane on planes of their own; out of that of what was found beside it where
/// its own was fitted to both.
pub fn leaning(
    surface: &Surface,
    found: &[&DetectedBox],
    image: &DepthImage,
    settings: &VisionSettings,
    smallest: f64,
) -> Vec<Surface> {
    let own = rising(surface, &surface.frame.plane, image, settings, smallest);
    if !own.is_empty() {
        return own;
    }
    let level = nearest(surface, found, settings).map(|b| PlaneFrame::of_top(b).plane);
    // One fitted to both leans by half of what the one does.
    let normal = surface.frame.plane.normal();
    match level {
        Some(level) if level.normal().angle(&normal) > 0.5 * LEAST_LEAN => {
            rising(surface, &level, image, settings, smallest)
        }
        _ => own,
    }
}

/// True for what was found about as high as a surface, as a plane was fitted to cartons that hang together.
pub fn is_about_level(surface: &Surface, found: &DetectedBox, settings: &VisionSettings) -> bool {
    let height = from_middle(surface, found).dot(&surface.frame.plane.normal());
    height.abs() < 3.0 * settings.plane_tolerance
}

/// The nearest of what was found about as high as a surface.
fn nearest<'a>(
    surface: &Surface,
    found: &[&'a DetectedBox],
    settings: &VisionSettings,
) -> Option<&'a DetectedBox> {
    let distance = |b: &DetectedBox| from_middle(surface, b).norm();
    let level = found
        .iter()
        .filter(|b| is_about_level(surface, b, settings));
    level
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .copied()
}

/// From the middle of a surface to that of a box.
fn from_middle(surface: &Surface, b: &DetectedBox) -> Vector {
    b.camera_from_box.translation.vector - surface.frame.origin.coords
}

/// Parts of a surface that rise out of a plane.
fn rising(
    surface: &Surface,
    level: &Plane,
    image: &DepthImage,
    settings: &VisionSettings,
    smallest: f64,
) -> Vec<Surface> {
    let least = least_pixels(image, settings, smallest);
    let rises = |run: Run| rises(level, run, image, settings.plane_tolerance);
    let mut count = 0;
    with_widest_vectors(
        #[inline(always)]
        || {
            for &run in &surface.component.runs {
                count += rises(run).map(u32::from).sum::<u32>() as usize;
            }
        },
    );
    // Most surfaces are flat.
    if count < least {
        return Vec::new();
    }
    let mut runs: Vec<Run> = Vec::new();
    for &run in &surface.component.runs {
        let mut last = None;
        for u in (run.first..)
            .zip(rises(run))
            .filter_map(|(u, is_nearer)| is_nearer.then_some(u))
        {
            match (last, runs.last_mut()) {
                (Some(before), Some(run)) if before + 1 == u => run.last = u,
                _ => runs.push(Run {
                    first: u,
                    last: u,
                    ..run
                }),
            }
            last = Some(u);
        }
    }
    connected(&runs, least)
        .into_iter()
        .filter_map(|part| Surface::new(part, image, settings, smallest).ok())
        .filter_map(|mut part| {
            let normal = part.frame.plane.normal();
            let lean = normal.angle(&level.normal());
            // As far as it is from where it leaves the other plane to where it meets it.
            part.reach = settings.plane_tolerance / lean.sin();
            (lean > LEAST_LEAN).then_some(part)
        })
        .collect()
}

/// Which pixels of a run lie nearer than a plane, by more than the tolerance.
#[inline(always)]
fn rises<'a>(
    plane: &Plane,
    run: Run,
    image: &'a DepthImage,
    tolerance: f64,
) -> impl Iterator<Item = bool> + 'a {
    let k = &image.intrinsics;
    // 1/z of a plane is affine along a row.
    let first = plane
        .coefficient
        .dot(&k.ray(run.first as f64, run.row as f64));
    let per_column = plane.coefficient.x / k.fx;
    let depths = &image.depth[run.row * image.width..][run.first..=run.last];
    depths.iter().enumerate().map(move |(n, &z)| {
        let inverse = first + per_column * f64::from(n as i32);
        (z > 0.0) & ((f64::from(z) + tolerance) * inverse < 1.0)
    })
}
