//! Stage 7d: whether arranged cartons stand as high as they should, and end where the surface does.

use crate::{
    VisionSettings,
    class::Class,
    gate::DepthImage,
    patch::Patch,
    seams::touches,
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
                let [x, y] = if side < 2 {
                    [x + sign * (half[0] + BEYOND), y + along * half[1]]
                } else {
                    [x + along * half[0], y + sign * (half[1] + BEYOND)]
                };
                // What stands beside one that leans is lower, but no ground.
                if patch.blanks.iter().any(|blank| blank.holds(x, y)) {
                    continue;
                }
                let p = patch.frame.point(x, y);
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

/// True when the surface goes on beyond an outer side of a covering: then its cartons are larger than the known ones.
pub fn goes_on(
    patch: &Patch,
    settings: &VisionSettings,
    arranged: &[Candidate],
    fixed: &[Candidate],
) -> bool {
    /// Cells by which a placement may be off.
    const OFF: f64 = 3.0;
    /// Cells that are looked at.
    const LOOK: isize = 4;
    let off = (settings.size_tolerance / patch.pitch + OFF) as isize;
    arranged.iter().any(|b| {
        let [i0, j0] = b.first.map(|v| v as isize);
        let (i1, j1) = (i0 + b.cells[0] as isize, j0 + b.cells[1] as isize);
        (0..4).any(|side| {
            let is_inner = arranged
                .iter()
                .chain(fixed)
                .any(|o| o.first != b.first && touches(b, o, side, patch.pitch));
            let beyond = match side {
                0 => patch.surface(i0 - off - LOOK, j0 + LOOK, i0 - off, j1 - LOOK),
                1 => patch.surface(i1 + off, j0 + LOOK, i1 + off + LOOK, j1 - LOOK),
                2 => patch.surface(i0 + LOOK, j0 - off - LOOK, i1 - LOOK, j0 - off),
                _ => patch.surface(i0 + LOOK, j1 + off, i1 - LOOK, j1 + off + LOOK),
            };
            !is_inner && beyond > 0.5
        })
    })
}
