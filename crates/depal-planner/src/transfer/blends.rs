//! Corners of a chain of joint moves.

use depal_frames::JointPositions;

use crate::tree::distance;

/// The largest blends that fit: `shares[j]` of segment `j` goes to the corner at its begin, the rest to that at its end;
/// outer segments belong wholly to their one corner.
pub(crate) fn fitting_blends(points: &[JointPositions], shares: &[f64]) -> Vec<f64> {
    let last = points.len() - 1;
    let mut blends = vec![0.0; points.len()];
    for i in 1..last {
        let before = distance(&points[i - 1], &points[i]);
        let after = distance(&points[i], &points[i + 1]);
        let before = if i == 1 {
            before
        } else {
            before * (1.0 - shares[i - 1])
        };
        let after = if i + 1 == last {
            after
        } else {
            after * shares[i]
        };
        // A hair less than what fits, so that the sum holds after rounding.
        blends[i] = before.min(after) * (1.0 - 1e-9);
    }
    blends
}
