use depal_arm::Arm;
use depal_frames::{JointPositions, Pose, Vector};
use nalgebra::Translation3;

use crate::{
    contact::Check,
    refusal::Touch,
    request::PlannerSettings,
    timing::{Trapezoid, chain_time},
};

/// Spacing of the joint states that stand for a straight line of the tool, m.
/// Between them the joints move evenly; the tool then leaves the line by less than 0.1 mm.
const LINE_SPACING: f64 = 0.02;
/// A straight line may turn a joint by this much per step; more means that it runs into a singularity, rad.
const LINE_JUMP: f64 = 0.25;

/// Joint states of a straight, upright move by `rise` metres from `start`; none when the branch ends on the way.
pub(crate) fn vertical_line(
    arm: &Arm,
    start: &JointPositions,
    rise: f64,
) -> Option<Vec<JointPositions>> {
    let from = arm.base_from_flange(start);
    let steps = (rise.abs() / LINE_SPACING).ceil().max(1.0) as usize;
    let mut states = vec![*start];
    for step in 1..=steps {
        let dz = rise * step as f64 / steps as f64;
        let before = states[states.len() - 1];
        let pose = Pose::from_parts(
            Translation3::from(from.translation.vector + Vector::new(0.0, 0.0, dz)),
            from.rotation,
        );
        let next = arm.inverse_nearest(&pose, &before)?;
        if next.max_distance(&before) > LINE_JUMP {
            return None;
        }
        states.push(next);
    }
    Some(states)
}

/// The first touch on a given list of states.
pub(crate) fn touch_on_states(check: &Check, states: &[JointPositions]) -> Option<Touch> {
    states.iter().find_map(|q| check.touch(q))
}

/// States between two joint vectors, ends left out, coarse ones first.
fn between(from: &JointPositions, to: &JointPositions, step: f64) -> Vec<JointPositions> {
    let length: f64 = from
        .iter()
        .zip(to.iter())
        .map(|(a, b)| (b - a) * (b - a))
        .sum::<f64>()
        .sqrt();
    let count = (length / step).ceil().max(1.0) as usize;
    let mut order = Vec::with_capacity(count);
    let mut stride = count.next_power_of_two();
    while stride >= 1 {
        order.extend(
            (1..count)
                .filter(|k| k % stride == 0 && k % (stride * 2) != 0)
                .map(|k| from.lerp(to, k as f64 / count as f64)),
        );
        stride /= 2;
    }
    order
}

/// A joint-space way: start, vias, goal.
#[derive(Debug, Clone)]
pub(crate) struct Way {
    pub points: Vec<JointPositions>,
    /// Flown past at every via, seconds.
    pub time: f64,
}

/// Joint ways from `from` to `to` that are worth trying, fastest first.
///
/// Direct; turning while high (axis 1 and the wrist run ahead of the arm's bend, or behind it); and up to a drawn-in
/// posture, turn, down again. The drawn-in posture keeps the tool's lean, because axes 2, 3 and 5 are parallel there.
pub(crate) fn ways(arm: &Arm, from: &JointPositions, to: &JointPositions) -> Vec<Way> {
    let mut vias: Vec<Vec<JointPositions>> = vec![Vec::new()];
    // Share of the way that turning and bending have made at the via.
    for (turn, bend) in [
        (0.35, 0.0),
        (0.5, 0.2),
        (0.65, 0.0),
        (0.75, 0.35),
        (0.85, 0.1),
        (1.0, 0.0),
        (1.0, 0.4),
        (0.0, 1.0),
        (0.0, 0.6),
        (0.15, 0.9),
        (0.25, 0.65),
        (0.35, 1.0),
        (0.5, 0.8),
        (0.65, 1.0),
    ] {
        vias.push(vec![mixed(from, to, turn, bend)]);
    }
    for (second, third) in [(-0.2, -0.2), (-0.35, 0.0), (-0.5, -0.1), (0.1, -0.6)] {
        if let (Some(a), Some(b)) = (drawn_in(from, second, third), drawn_in(to, second, third)) {
            vias.push(vec![a, b]);
            vias.push(vec![from.lerp(&a, 0.5), to.lerp(&b, 0.5)]);
        }
    }
    let mut ways: Vec<Way> = vias
        .into_iter()
        .filter(|vias| vias.iter().all(|q| arm.within_limits(q)))
        .map(|vias| {
            let mut points = vec![*from];
            points.extend(vias);
            points.push(*to);
            let moves: Vec<Trapezoid> = points
                .windows(2)
                .map(|w| Trapezoid::joints(&w[0], &w[1], arm.limits()))
                .collect();
            Way {
                time: chain_time(&moves),
                points,
            }
        })
        .collect();
    // Stable: equal times keep the order above, the plainest first.
    ways.sort_by(|a, b| a.time.total_cmp(&b.time));
    ways
}

fn mixed(from: &JointPositions, to: &JointPositions, turn: f64, bend: f64) -> JointPositions {
    let mut via = from.lerp(to, turn);
    // Axes 2, 3 and 5 bend the arm; a palletizer has no axis 5.
    let bending: &[usize] = if from.len() < 6 { &[1, 2] } else { &[1, 2, 4] };
    for &joint in bending {
        via[joint] = from[joint] + (to[joint] - from[joint]) * bend;
    }
    via
}

/// The same heading with axes 2 and 3 at a drawn-in posture; none when the wrist is not in line with the arm.
pub(crate) fn drawn_in(at: &JointPositions, second: f64, third: f64) -> Option<JointPositions> {
    use std::f64::consts::PI;
    if at.len() < 6 {
        // The rods of a palletizer keep the tool level.
        let mut drawn = *at;
        drawn[1] = second;
        drawn[2] = third;
        return Some(drawn);
    }
    let turns = at[3] / PI;
    let half_turns = turns.round();
    if (turns - half_turns).abs() > 0.05 {
        return None;
    }
    let sign = if half_turns as i64 % 2 == 0 {
        1.0
    } else {
        -1.0
    };
    let mut drawn = *at;
    drawn[1] = second;
    drawn[2] = third;
    drawn[4] += sign * (at[1] + at[2] - second - third);
    Some(drawn)
}

/// What a controller flies when it cuts the corner at `corner`, as far as `zone` metres at the tool: the chord and the parabola.
pub(crate) fn corner_states(
    tool: impl Fn(&JointPositions) -> Pose,
    before: &JointPositions,
    corner: &JointPositions,
    after: &JointPositions,
    zone: f64,
) -> Vec<JointPositions> {
    let at = tool(corner).translation.vector;
    let cut = |other: &JointPositions| {
        let length = (tool(other).translation.vector - at).norm();
        let share = if length < 1e-6 {
            0.5
        } else {
            (zone / length).min(0.5)
        };
        corner.lerp(other, share)
    };
    let (a, b) = (cut(before), cut(after));
    let parabola = |u: f64| a.lerp(corner, u).lerp(&corner.lerp(&b, u), u);
    let mut states: Vec<JointPositions> =
        [0.25, 0.5, 0.75].iter().map(|&u| a.lerp(&b, u)).collect();
    states.extend([0.25, 0.5, 0.75].map(parabola));
    states
}

/// Why a way is not taken.
pub(crate) enum Blocked {
    Touches(Touch),
    /// The carton would hang too far out of the vertical.
    Leans,
}

/// Whether a joint way is free: vias, corners, then the stretches between, coarse to fine. `before` and `after` are where
/// the straight moves beside it lead. `upright` limits the lean of the tool.
pub(crate) fn touch_on_way(
    check: &Check,
    way: &[JointPositions],
    upright: Option<f64>,
    settings: &PlannerSettings,
) -> Result<(), Blocked> {
    let robot = check.robot;
    let tool = |q: &JointPositions| robot.arm.base_from_flange(q) * robot.gripper.flange_from_tcp;
    let test = |q: &JointPositions| test_state(check, q, upright);
    way.iter().skip(1).try_for_each(test)?;
    for at in way.windows(3) {
        let corner = corner_states(tool, &at[0], &at[1], &at[2], settings.corner_zone);
        corner.iter().try_for_each(test)?;
    }
    way.windows(2)
        .flat_map(|w| between(&w[0], &w[1], settings.check_step))
        .try_for_each(|q| test(&q))
}

fn test_state(check: &Check, joints: &JointPositions, upright: Option<f64>) -> Result<(), Blocked> {
    let frames = check.robot.frames(joints);
    if let Some(limit) = upright
        && (check.robot.tool(&frames).rotation * -Vector::z()).z < limit.cos()
    {
        return Err(Blocked::Leans);
    }
    match check.touch_at(&frames) {
        Some(touch) => Err(Blocked::Touches(touch)),
        None => Ok(()),
    }
}

/// Whether the straight joint move between two states is free, its far end included.
pub(crate) fn edge_is_free(
    check: &Check,
    from: &JointPositions,
    to: &JointPositions,
    upright: Option<f64>,
    settings: &PlannerSettings,
) -> bool {
    test_state(check, to, upright).is_ok()
        && between(from, to, settings.check_step)
            .iter()
            .all(|q| test_state(check, q, upright).is_ok())
}
