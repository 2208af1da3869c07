//! Stage 5c: cartons that stand tilted hang together with those that they touch.

use crate::{
    VisionSettings,
    components::components,
    gate::DepthImage,
    surface::{Surface, least_pixels},
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
    let k = &image.intrinsics;
    let mut mask = vec![0u8; image.width * image.height];
    for run in &surface.component.runs {
        for u in run.first..=run.last {
            let at = run.row * image.width + u;
            let expected = surface.frame.plane.depth(&k.ray(u as f64, run.row as f64));
            let z = f64::from(image.depth[at]);
            mask[at] = u8::from(z > 0.0 && z < expected - settings.plane_tolerance);
        }
    }
    components(&mask, image.width, least_pixels(image, settings, smallest))
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
