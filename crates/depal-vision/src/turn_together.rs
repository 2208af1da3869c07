//! Stage 8: cartons that stand close cannot turn much against each other.
//!
//! A side that runs along the pixel rows tells its direction badly: all of it rounds to the same row. Between two
//! cartons with a gap of a millimetre there is no room for more than the gap over the length of the common side, so
//! the neighbours' sides tell it, too.
//!
//! Cartons of a layer were also put down along the same axes. How much they scatter about their common direction is
//! measured with them: it is what their turns differ by beyond what one turn is known to. A single one is believed
//! against the common one accordingly.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use depal_frames::{Intrinsics, Point, Rotation, Vector};

use crate::DetectedBox;

/// How well a side's direction is known: as if its ends were, to so many pixels, where it follows the pixel rows.
const ENDS_PIXELS: f64 = 0.35;
/// A side that crosses so many rows over its length tells its direction better by as much; more are no help.
const MOST_ROWS: f64 = 2.0;
/// Fewer cartons have no common direction worth the name.
const LEAST_COMPANY: usize = 4;
/// What a measured gap may be wrong by, metres.
const GAP_ERROR: f64 = 0.000_3;
/// Gaps that are looked at, metres: cartons that seem to overlap by noise, up to where a gap binds nothing.
const GAPS: std::ops::Range<f64> = -0.003..0.004;
/// A common side is at least this long, metres.
const LEAST_COMMON: f64 = 0.04;
/// Tops of neighbours are at most this far apart in height, metres.
const LEVEL: f64 = 0.01;
/// No carton is turned farther than this, radians; cartons that differ by more stand at an angle.
const FARTHEST: f64 = 0.009;

/// Two cartons side by side.
struct Pair {
    first: usize,
    second: usize,
    /// How far the second is turned against the first, up to quarter turns, radians.
    turned: f64,
    /// 1 over the variance of how far they can be turned.
    weight: f64,
}

/// Turns each carton about the middle of its top to what its own sides and its neighbours say.
pub fn turn_together(boxes: &mut [DetectedBox], lens: &Intrinsics) {
    /// Far more than the answer needs: each carton has few neighbours.
    const ROUNDS: usize = 60;
    let mut pairs = Vec::new();
    for first in 0..boxes.len() {
        for second in first + 1..boxes.len() {
            pairs.extend(pair(boxes, first, second));
        }
    }
    let own: Vec<f64> = boxes.iter().map(|b| own_weight(b, lens)).collect();
    let layers: Vec<Option<[f64; 2]>> = (0..boxes.len()).map(|n| layer(boxes, n, &own)).collect();
    if pairs.is_empty() && layers.iter().all(Option::is_none) {
        return;
    }
    let mut turns = vec![0.0; boxes.len()];
    for _ in 0..ROUNDS {
        let mut sums: Vec<[f64; 2]> = own
            .iter()
            .zip(&layers)
            .map(|(weight, layer)| {
                let [common, towards] = layer.unwrap_or_default();
                [weight + common, common * towards]
            })
            .collect();
        for p in &pairs {
            sums[p.first][0] += p.weight;
            sums[p.first][1] += p.weight * (turns[p.second] + p.turned);
            sums[p.second][0] += p.weight;
            sums[p.second][1] += p.weight * (turns[p.first] - p.turned);
        }
        for (turn, [weight, sum]) in turns.iter_mut().zip(sums) {
            // Not all the way: all turn at once.
            *turn += 0.7 * (sum / weight - *turn);
        }
    }
    for (found, turn) in boxes.iter_mut().zip(turns) {
        let turn = turn.clamp(-FARTHEST, FARTHEST);
        found.camera_from_box.rotation *= Rotation::from_axis_angle(&Vector::z_axis(), turn);
    }
}

/// Up to quarter turns, radians.
fn up_to_quarters(angle: f64) -> f64 {
    (angle + FRAC_PI_4).rem_euclid(FRAC_PI_2) - FRAC_PI_4
}

/// 1 over the variance of its turn by itself.
fn own_weight(found: &DetectedBox, lens: &Intrinsics) -> f64 {
    let pitch = found.camera_from_box.translation.z / lens.fx;
    let x = found.camera_from_box.rotation * Vector::x();
    let rows = up_to_quarters(x.y.atan2(x.x)).abs() * found.size.length / pitch;
    let ends = ENDS_PIXELS * pitch / rows.clamp(1.0, MOST_ROWS);
    (found.size.length / ends).powi(2)
}

/// Where the second lies, seen from the first, and by what angle it is turned, if both are level and along the same
/// axes.
fn level_with(a: &DetectedBox, b: &DetectedBox) -> Option<(Vector, f64)> {
    let to = a
        .camera_from_box
        .inverse_transform_point(&Point::from(b.camera_from_box.translation.vector));
    let x = a
        .camera_from_box
        .rotation
        .inverse_transform_vector(&(b.camera_from_box.rotation * Vector::x()));
    let angle = x.y.atan2(x.x);
    (to.z.abs() <= LEVEL && up_to_quarters(angle).abs() <= 2.0 * FARTHEST)
        .then_some((to.coords, angle))
}

/// What a carton's layer says of its turn: the weight, and how far it is turned from the common direction, radians.
/// The scatter is that of `DerSimonian` and Laird for measurements of unequal variance, one standard deviation of it
/// more, since it is known from few.
fn layer(boxes: &[DetectedBox], carton: usize, own: &[f64]) -> Option<[f64; 2]> {
    let others: Vec<(f64, f64)> = boxes
        .iter()
        .zip(own)
        .filter_map(|(b, weight)| {
            let (_, angle) = level_with(&boxes[carton], b)?;
            Some((up_to_quarters(angle), *weight))
        })
        .collect();
    if others.len() < LEAST_COMPANY {
        return None;
    }
    let total: f64 = others.iter().map(|o| o.1).sum();
    let mean = others.iter().map(|o| o.0 * o.1).sum::<f64>() / total;
    let scattered: f64 = others.iter().map(|o| o.1 * (o.0 - mean).powi(2)).sum();
    let squares: f64 = others.iter().map(|o| o.1 * o.1).sum();
    let freedom = (others.len() - 1) as f64;
    let beyond = (scattered - freedom + (2.0 * freedom).sqrt()).max(0.0);
    let variance = beyond / (total - squares / total) + 1.0 / total;
    Some([1.0 / variance, mean])
}

/// The two as neighbours, if they are.
fn pair(boxes: &[DetectedBox], first: usize, second: usize) -> Option<Pair> {
    let (a, b) = (&boxes[first], &boxes[second]);
    let (to, angle) = level_with(a, b)?;
    let turned = up_to_quarters(angle);
    let is_across = ((angle - turned) / FRAC_PI_2).round().rem_euclid(2.0) > 0.5;
    let half = |d: &DetectedBox| [d.size.length / 2.0, d.size.width / 2.0];
    let (mine, mut other) = (half(a), half(b));
    if is_across {
        other.swap(0, 1);
    }
    let (to, reach) = ([to.x, to.y], [mine[0] + other[0], mine[1] + other[1]]);
    let beside = |axis: usize| {
        let along = 1 - axis;
        let gap = to[axis].abs() - reach[axis];
        let common = (reach[along] - to[along].abs()).min(2.0 * mine[along].min(other[along]));
        (GAPS.contains(&gap) && common >= LEAST_COMMON).then(|| (gap.max(0.0), common))
    };
    let (gap, common) = beside(0).or_else(|| beside(1))?;
    Some(Pair {
        first,
        second,
        turned,
        weight: (common / (gap + GAP_ERROR)).powi(2),
    })
}

#[cfg(test)]
mod tests {
    use depal_frames::{BoxSize, Pose};

    use super::*;

    const LENS: Intrinsics = Intrinsics {
        width: 1280,
        height: 1024,
        fx: 1216.0,
        fy: 1216.0,
        cx: 639.5,
        cy: 511.5,
    };

    /// A top of 300 x 200 mm, 2 m away and facing the camera.
    fn top(x: f64, y: f64, turn: f64) -> DetectedBox {
        let facing = Rotation::from_axis_angle(&Vector::x_axis(), std::f64::consts::PI);
        let turned = Rotation::from_axis_angle(&Vector::z_axis(), turn);
        DetectedBox {
            camera_from_box: Pose::from_parts(Vector::new(x, y, 2.0).into(), facing * turned),
            size: BoxSize::from_mm([300.0, 200.0, 200.0]),
            label: 0,
            confidence: 1.0,
            visible_fraction: 1.0,
            proven_sides: 4,
        }
    }

    fn turn_of(found: &DetectedBox) -> f64 {
        let x = found.camera_from_box.rotation * Vector::x();
        -x.y.atan2(x.x)
    }

    #[test]
    fn a_narrow_gap_draws_two_turns_together_and_keeps_their_mean() {
        let mut boxes = vec![top(0.0, 0.0, 0.003), top(0.0, 0.201, -0.001)];
        turn_together(&mut boxes, &LENS);
        let [a, b] = [turn_of(&boxes[0]), turn_of(&boxes[1])];
        assert!(a > b && a - b < 0.0035, "{a} and {b}");
        assert!((a + b - 0.002).abs() < 1e-9, "{a} and {b}");
    }

    #[test]
    fn a_wide_gap_or_another_height_or_angle_binds_nothing() {
        for other in [
            top(0.0, 0.206, -0.001),
            top(0.0, 0.201, 0.1),
            top(0.31, 0.25, -0.001),
        ] {
            let mut boxes = vec![top(0.0, 0.0, 0.003), other];
            let before: Vec<f64> = boxes.iter().map(turn_of).collect();
            turn_together(&mut boxes, &LENS);
            let after: Vec<f64> = boxes.iter().map(turn_of).collect();
            assert_eq!(before, after);
        }
    }

    /// Six cartons too far apart to bind each other.
    fn apart(turns: [f64; 6]) -> Vec<DetectedBox> {
        let places = turns.iter().enumerate();
        places
            .map(|(n, turn)| top(-0.4 + 0.4 * (n % 3) as f64, 0.3 * (n / 3) as f64, *turn))
            .collect()
    }

    #[test]
    fn what_differs_by_no_more_than_its_noise_has_the_common_direction() {
        let noise = [0.001, -0.001, 0.0005, -0.0005, 0.001, -0.001];
        let mut boxes = apart(noise);
        turn_together(&mut boxes, &LENS);
        for (found, before) in boxes.iter().zip(noise) {
            let after = turn_of(found);
            assert!(after.abs() < 0.4 * before.abs(), "{before} became {after}");
        }
    }

    /// Cartons that really stand at different angles keep them.
    #[test]
    fn what_scatters_much_more_is_believed() {
        let turns = [0.008, -0.008, 0.006, -0.006, 0.008, -0.008];
        let mut boxes = apart(turns);
        turn_together(&mut boxes, &LENS);
        for (found, before) in boxes.iter().zip(turns) {
            let after = turn_of(found);
            assert!((after - before).abs() < 0.0006, "{before} became {after}");
        }
    }

    /// A quarter turn between the two is none.
    #[test]
    fn long_side_against_short_side() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let mut boxes = vec![top(0.0, 0.0, 0.0), top(0.251, 0.0, quarter + 0.004)];
        turn_together(&mut boxes, &LENS);
        let [a, b] = [turn_of(&boxes[0]), turn_of(&boxes[1]) - quarter];
        assert!(a > 0.0002 && b < 0.0038 && b > a, "{a} and {b}");
    }
}
