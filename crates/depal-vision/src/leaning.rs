//! Stage 5c: cartons that stand tilted hang together with those that they touch.

use crate::{
    VisionSettings,
    components::{Run, connected},
    gate::DepthImage,
    surface::{Surface, least_pixels},
    widest::with_widest_vectors,
};

/// Parts of a surface that rise out of its plane on planes of their own.
pub fn leaning(
    surface: &Surface,
    image: &DepthImage,
    settings: &VisionSettings,
    smallest: f64,
) -> Vec<Surface> {
    /// Lower angles are those of uneven ground and of noise, radians.
    const LEAST_LEAN: f64 = 0.02;
    let least = least_pixels(image, settings, smallest);
    let rising = |run: Run| rising(surface, run, image, settings.plane_tolerance);
    let mut count = 0;
    with_widest_vectors(
        #[inline(always)]
        || {
            for &run in &surface.component.runs {
                count += rising(run).map(u32::from).sum::<u32>() as usize;
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
            .zip(rising(run))
            .filter_map(|(u, rises)| rises.then_some(u))
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
            let lean = normal.angle(&surface.frame.plane.normal());
            // As far as it is from where it leaves the other plane to where it meets it.
            part.reach = settings.plane_tolerance / lean.sin();
            (lean > LEAST_LEAN).then_some(part)
        })
        .collect()
}

/// Which pixels of a run lie nearer than a surface's plane, by more than the tolerance.
#[inline(always)]
fn rising<'a>(
    surface: &Surface,
    run: Run,
    image: &'a DepthImage,
    tolerance: f64,
) -> impl Iterator<Item = bool> + 'a {
    let (k, plane) = (&image.intrinsics, &surface.frame.plane);
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
