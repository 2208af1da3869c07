//! Stage 5b: surfaces that belong together although something divides them.

use depal_frames::Intrinsics;

use crate::{VisionSettings, patch::pixel_pitch, surface::Surface};

/// A stripe without measurement this wide may run through a carton (black tape), metres.
const WIDEST_TAPE: f64 = 0.060;

/// Groups (indices, ascending) of surfaces that lie side by side on one plane.
pub fn neighbours(
    surfaces: &[Surface],
    intrinsics: &Intrinsics,
    settings: &VisionSettings,
) -> Vec<Vec<usize>> {
    let bounds: Vec<[usize; 4]> = surfaces
        .iter()
        .map(|s| {
            s.component
                .runs
                .iter()
                .fold([usize::MAX, 0, usize::MAX, 0], |b, r| {
                    [
                        b[0].min(r.first),
                        b[1].max(r.last),
                        b[2].min(r.row),
                        b[3].max(r.row),
                    ]
                })
        })
        .collect();
    let beside = |a: usize, b: usize| {
        let (p, q) = (bounds[a], bounds[b]);
        // The mask ends two pixels inside both borders, where up to two more are lost.
        let reach = (WIDEST_TAPE / pixel_pitch(&surfaces[a].frame, intrinsics)) as usize + 8;
        let close = p[0] <= q[1] + reach
            && q[0] <= p[1] + reach
            && p[2] <= q[3] + reach
            && q[2] <= p[3] + reach;
        let level = |a: &Surface, b: &Surface| {
            let ray = b.frame.origin.coords / b.frame.origin.z;
            (a.frame.plane.depth(&ray) - b.frame.origin.z).abs() < settings.plane_tolerance
        };
        close && level(&surfaces[a], &surfaces[b]) && level(&surfaces[b], &surfaces[a])
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut taken = vec![false; surfaces.len()];
    for seed in 0..surfaces.len() {
        if taken[seed] {
            continue;
        }
        taken[seed] = true;
        let mut group = vec![seed];
        let mut next = 0;
        while next < group.len() {
            for (other, taken) in taken.iter_mut().enumerate() {
                if !*taken && beside(group[next], other) {
                    *taken = true;
                    group.push(other);
                }
            }
            next += 1;
        }
        group.sort_unstable();
        groups.push(group);
    }
    groups
}
