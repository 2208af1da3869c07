//! Stage 7d: whether arranged cartons stand as high as they should.

use crate::{
    VisionSettings,
    class::Class,
    gate::DepthImage,
    patch::Patch,
    search::{Candidate, extents},
};

/// Whether what lies beyond the outer sides of arranged boxes is as deep as they are high: a slip
/// sheet of the size of a whole layer is covered by cartons as well, but stands on no height. A `plain` surface, that
/// nothing else tells from a floor, must be seen to stand.
pub fn stands(
    patch: &Patch,
    image: &DepthImage,
    settings: &VisionSettings,
    boxes: &[Candidate],
    plain: bool,
) -> bool {
    const BEYOND: f64 = 0.020;
    const SAMPLES: usize = 40;
    const ENOUGH: usize = 40;
    let k = &image.intrinsics;
    let mut drops = Vec::new();
    let mut height = f64::MAX;
    for b in boxes {
        let size = &settings.sizes[b.label as usize];
        height = height.min(size.height);
        let half = extents(size, b.turned).map(|e| e / 2.0);
        let (x, y) = b.centre(patch);
        for side in 0..4 {
            let sign = if side % 2 == 0 { -1.0 } else { 1.0 };
            for n in 0..SAMPLES {
                let along = (n as f64 + 0.5) / SAMPLES as f64 * 2.0 - 1.0;
                let p = if side < 2 {
                    patch
                        .frame
                        .point(x + sign * (half[0] + BEYOND), y + along * half[1])
                } else {
                    patch
                        .frame
                        .point(x + along * half[0], y + sign * (half[1] + BEYOND))
                };
                let (u, v) = k.project(&p);
                if image.class(u, v, p.z, settings.plane_tolerance) == Class::Deep {
                    let i = (v + 0.5) as usize * image.width + (u + 0.5) as usize;
                    drops.push(f64::from(image.depth[i]) - p.z);
                }
            }
        }
    }
    if drops.len() < ENOUGH || !height.is_finite() {
        return !plain;
    }
    let high = drops.len() * 9 / 10;
    let drop = *drops.select_nth_unstable_by(high, f64::total_cmp).1;
    drop > 0.9 * height - 0.005
}
