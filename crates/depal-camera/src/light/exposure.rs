//! The distance for which a picture is exposed.

use crate::{CameraSpec, Rendering};

/// One pixel of this many is metered, in rows and in columns.
const EVERY: usize = 16;

/// Distance for which the picture is exposed, metres: there brown board facing the projector gives the
/// reference signal. None where the signal does not depend on distance.
///
/// A meter sees light, which goes with 1/z^2, so it takes the mean of that over what can be measured.
/// The sum runs in one order, whatever the number of threads.
pub(super) fn exposure(spec: &CameraSpec, rendering: &Rendering) -> Option<f64> {
    let farthest = spec.sensor.signal_distance;
    if farthest <= 0.0 {
        return None;
    }
    let i = &rendering.intrinsics;
    let in_range = 1.0 / spec.far..=1.0 / spec.near;
    let first = |length: usize| (EVERY / 2).min(length / 2);
    let (mut light, mut count) = (0.0, 0.0);
    for v in (first(i.height)..i.height).step_by(EVERY) {
        let row = &rendering.inverse_depth[v * i.width..(v + 1) * i.width];
        for w in row.iter().skip(first(i.width)).step_by(EVERY) {
            let w = f64::from(*w);
            if in_range.contains(&w) {
                light += w * w;
                count += 1.0;
            }
        }
    }
    if count == 0.0 {
        return Some(farthest);
    }
    let metered = (count / light).sqrt();
    Some(metered.min(farthest))
}
