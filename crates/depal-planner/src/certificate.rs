use depal_frames::JointPositions;
use rayon::prelude::*;

use crate::{
    contact::{Check, Measured},
    refusal::Touch,
};

/// Distances beyond this are not measured, m.
const CAP: f32 = 0.15;
/// Intervals in which no body point moves farther than this are not split any more, m.
const FINEST: f32 = 0.002;
/// Two neighbouring states differ by at most this, rad, so that a body's way is close to its displacement.
const WIDEST: f64 = 0.06;

/// The least distance may be smaller than the measured one by this share (and 1 mm): finer costs many more measurements.
const SLACK_SHARE: f64 = 0.2;

/// A chain of joint states between which the joints move on straight lines.
pub(crate) struct Stretch<'a> {
    check: &'a Check<'a>,
    states: &'a [JointPositions],
}

impl<'a> Stretch<'a> {
    pub fn new(check: &'a Check<'a>, states: &'a [JointPositions]) -> Self {
        Self { check, states }
    }
}

/// Proves that nothing touches along some stretches, and gives the least measured distance, m, at most 0.15;
/// else the first touch.
///
/// Between two states with distances `d0` and `d1`, nothing can touch when no body point moves farther than `d0 + d1`;
/// otherwise the interval is halved. Intervals that could hold a distance smaller than the least by more than a fifth
/// and 1 mm are halved too.
///
/// All given states are measured first: what they leave of the least distance is what every interval begins with,
/// whichever thread looks at it and when.
pub(crate) fn certify(stretches: &[Stretch]) -> Result<f64, Touch> {
    let given: Vec<(usize, &Check, &JointPositions)> = stretches
        .iter()
        .enumerate()
        .flat_map(|(i, s)| s.states.iter().map(move |state| (i, s.check, state)))
        .collect();
    let measured: Vec<Measured> = given
        .par_iter()
        .map(|(_, check, state)| check.measure(state, CAP))
        .collect();
    let mut least = f64::from(CAP);
    for found in &measured {
        least = least.min(free(found)?);
    }
    let states: Vec<_> = given.into_iter().zip(measured).collect();
    let intervals: Vec<Result<f64, Touch>> = states
        .par_windows(2)
        .filter(|ends| ends[0].0.0 == ends[1].0.0)
        .map(|ends| {
            let [((_, check, from), a), ((_, _, to), b)] = ends else {
                unreachable!("windows of two")
            };
            let mut least = least;
            between(check, (from, a), (to, b), &mut least)?;
            Ok(least)
        })
        .collect();
    for interval in intervals {
        least = least.min(interval?);
    }
    Ok(least)
}

/// The distance at a state, if it is free.
fn free(measured: &Measured) -> Result<f64, Touch> {
    match &measured.nearest {
        Some(touch) if measured.distance <= 0.0 => Err(touch.clone()),
        _ => Ok(f64::from(measured.distance)),
    }
}

fn between(
    check: &Check,
    from: (&JointPositions, &Measured),
    to: (&JointPositions, &Measured),
    least: &mut f64,
) -> Result<(), Touch> {
    let near = from.0.max_distance(to.0) <= WIDEST;
    let way = check.displacement(&from.1.poses, &to.1.poses);
    let sum = from.1.distance + to.1.distance;
    let bound = f64::from(sum - way) * 0.5;
    if near && (way <= FINEST || (way < sum * 0.9 && bound >= *least * (1.0 - SLACK_SHARE) - 0.001))
    {
        return Ok(());
    }
    let middle = from.0.lerp(to.0, 0.5);
    let measured = check.measure(&middle, CAP);
    *least = least.min(free(&measured)?);
    between(check, from, (&middle, &measured), least)?;
    between(check, (&middle, &measured), to, least)
}
