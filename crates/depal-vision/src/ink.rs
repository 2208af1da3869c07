//! Stage 7b: seams in the intensity image. Where two cartons meet, a thin dark line runs along the
//! whole side; a print or a label has no such line just there.

use crate::{gate::DepthImage, patch::Patch, search::Candidate};

/// Samples along a side.
const SAMPLES: usize = 40;
/// Cells by which a line may lie beside the expected side.
const BESIDE: usize = 3;
/// A line is compared with what lies so many cells to both sides.
const AWAY: usize = 4;
/// Grey values by which a line must be darker than both.
const DARKER: i32 = 8;

/// Share of dark line along each side (-X, +X, -Y, +Y) of a candidate; 0 without an intensity image.
pub fn dark_sides(patch: &Patch, image: &DepthImage, candidate: &Candidate) -> [f64; 4] {
    if image.intensity.len() != image.depth.len() {
        return [0.0; 4];
    }
    let first = candidate.first.map(|c| c as f64);
    let cells = candidate.cells.map(|c| c as f64);
    let grey = |x: f64, y: f64| {
        let p = patch
            .frame
            .point(patch.left + x * patch.pitch, patch.bottom + y * patch.pitch);
        let (u, v) = image.intrinsics.project(&p);
        let (u, v) = (u + 0.5, v + 0.5);
        let inside = u >= 0.0 && v >= 0.0 && u < image.width as f64 && v < image.height as f64;
        inside.then(|| i32::from(image.intensity[v as usize * image.width + u as usize]))
    };
    [0, 1, 2, 3].map(|side| {
        let (axis, across) = (side / 2, 1 - side / 2);
        let at = first[axis] + if side % 2 == 0 { 0.0 } else { cells[axis] };
        let place = |off: f64, n: usize| {
            let along =
                first[across] + cells[across] * (0.05 + 0.9 * (n as f64 + 0.5) / SAMPLES as f64);
            if axis == 0 {
                (at + off, along)
            } else {
                (along, at + off)
            }
        };
        let mut dark = [0; BESIDE * 2 + 1];
        for n in 0..SAMPLES {
            let across: [Option<i32>; 2 * (BESIDE + AWAY) + 1] = std::array::from_fn(|k| {
                let (x, y) = place(k as f64 - (BESIDE + AWAY) as f64, n);
                grey(x, y)
            });
            for (k, dark) in dark.iter_mut().enumerate() {
                let [before, line, after] = [k, k + AWAY, k + 2 * AWAY].map(|k| across[k]);
                if let (Some(line), Some(before), Some(after)) = (line, before, after) {
                    *dark += usize::from(line + DARKER <= before.min(after));
                }
            }
        }
        let most = dark.into_iter().fold(0, usize::max);
        most as f64 / SAMPLES as f64
    })
}
