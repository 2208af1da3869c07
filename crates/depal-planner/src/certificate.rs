use depal_frames::JointPositions;

use crate::{
    contact::{Check, Measured},
    refusal::{Stage, Touch},
};

/// Distances beyond this are not measured, m.
const CAP: f32 = 0.15;
/// Intervals in which no body point moves farther than this are not split any more, m.
const FINEST: f32 = 0.002;
/// Two neighbouring states differ by at most this, rad, so that a body's way is close to its displacement.
const WIDEST: f64 = 0.06;

/// The least distance may be smaller than the measured one by this share (and 1 mm): finer costs many more measurements.
const SLACK_SHARE: f64 = 0.2;

/// Proves that nothing touches along a chain of joint states between which the joints move on straight lines.
///
/// Between two states with distances `d0` and `d1`, nothing can touch when no body point moves farther than `d0 + d1`;
/// otherwise the interval is halved. `least` becomes the least measured distance, m, at most 0.15.
/// Intervals that could hold one smaller by more than a fifth and 1 mm are halved too.
pub(crate) fn certify(
    check: &Check,
    states: &[JointPositions],
    least: &mut f64,
) -> Result<(), Touch> {
    let check = &Check {
        stage: Stage::Certificate,
        ..*check
    };
    let Some(first) = states.first() else {
        return Ok(());
    };
    let mut before = (*first, measured(check, first, least)?);
    for next in &states[1..] {
        let after = (*next, measured(check, next, least)?);
        between(check, &before, &after, least)?;
        before = after;
    }
    Ok(())
}

fn measured(check: &Check, joints: &JointPositions, least: &mut f64) -> Result<Measured, Touch> {
    let found = check.measure(joints, CAP);
    match found.nearest {
        Some(touch) if found.distance <= 0.0 => Err(touch),
        _ => {
            *least = least.min(f64::from(found.distance));
            Ok(found)
        }
    }
}

fn between(
    check: &Check,
    from: &(JointPositions, Measured),
    to: &(JointPositions, Measured),
    least: &mut f64,
) -> Result<(), Touch> {
    let near = from.0.max_distance(&to.0) <= WIDEST;
    let way = check.displacement(&from.1.poses, &to.1.poses);
    let sum = from.1.distance + to.1.distance;
    let bound = f64::from(sum - way) * 0.5;
    if near && (way <= FINEST || (way < sum * 0.9 && bound >= *least * (1.0 - SLACK_SHARE) - 0.001))
    {
        return Ok(());
    }
    let middle = from.0.lerp(&to.0, 0.5);
    let middle = (middle, measured(check, &middle, least)?);
    between(check, from, &middle, least)?;
    between(check, &middle, to, least)
}
