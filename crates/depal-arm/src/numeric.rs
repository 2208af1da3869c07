//! Inverse kinematics of chains without a closed form: descents from many beginnings.

use std::f64::consts::TAU;

use depal_frames::{JointPositions, MAX_JOINTS, Pose};
use nalgebra::{SMatrix, SVector, Vector6};

use crate::{JointLimit, chain::Chain, newton::Newton};

/// A solution's flange may miss by this much, m and rad.
pub(crate) const TOLERANCE: f64 = 1e-10;
/// What may be missing when the damped descent makes no more way, m and rad.
const STUCK: f64 = 1e-8;
/// Where the damped descent hands over, m and rad.
const NEAR: f64 = 1e-2;
/// Steps of the damped descent from one beginning.
const STEPS: usize = 60;
/// Largest change of a joint in one step, rad.
const LARGEST_STEP: f64 = 0.5;
/// Most beginnings.
const BEGINNINGS: usize = 160;
/// Beginnings in a row that meet nothing new before the search ends.
const IDLE: usize = 48;
/// Solutions that are collected of an arm with more than six joints: it has endlessly many.
const MOST_OF_MANY: usize = 24;
/// Solutions nearer to each other than this are one, rad.
const SAME: f64 = 1e-4;

/// A joint that may turn all the way round has no wall to run into: its angle is brought home at the end.
fn turns_round(limit: &JointLimit) -> bool {
    limit.upper - limit.lower >= TAU
}

/// Brings angles of joints that turn round into their limits by whole turns; none when another joint is outside.
pub(crate) fn home(mut joints: JointPositions, limits: &[JointLimit]) -> Option<JointPositions> {
    for (q, limit) in joints.iter_mut().zip(limits) {
        if !q.is_finite() {
            return None;
        }
        if turns_round(limit) && !(limit.lower..=limit.upper).contains(q) {
            let beyond = if *q > limit.upper {
                ((*q - limit.upper) / TAU).ceil()
            } else {
                -((limit.lower - *q) / TAU).ceil()
            };
            *q -= beyond * TAU;
        }
        // A whole turn of rounding at most.
        if *q < limit.lower - 1e-9 || *q > limit.upper + 1e-9 {
            return None;
        }
        *q = q.clamp(limit.lower, limit.upper);
    }
    Some(joints)
}

/// Damped least squares (S. Buss, "Introduction to inverse kinematics with Jacobian transpose, pseudoinverse and
/// damped least squares methods", 2004) with the damping of Levenberg and Marquardt, from one beginning, until less than
/// `tolerance` is missing, m and rad.
/// None when it gets stuck, which says nothing about other beginnings.
fn descend(
    chain: &Chain,
    limits: &[JointLimit],
    target: &Pose,
    from: &JointPositions,
    tolerance: f64,
) -> Option<JointPositions> {
    let mut joints = *from;
    let mut miss = error(chain, target, &joints);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        if miss.norm() < tolerance {
            return Some(joints);
        }
        let jacobian = jacobian(chain, &joints);
        let mut square = jacobian.transpose() * jacobian;
        for i in 0..MAX_JOINTS {
            square[(i, i)] += damping;
        }
        let step: SVector<f64, MAX_JOINTS> =
            square.cholesky()?.solve(&(jacobian.transpose() * miss));
        let largest = step.amax();
        let scale = (LARGEST_STEP / largest.max(1e-12)).min(1.0);
        let mut next = joints;
        for (i, limit) in limits.iter().enumerate() {
            next[i] = joints[i] + step[i] * scale;
            if !turns_round(limit) {
                next[i] = next[i].clamp(limit.lower, limit.upper);
            }
        }
        let next_miss = error(chain, target, &next);
        if next_miss.norm() < miss.norm() {
            (joints, miss) = (next, next_miss);
            damping = (damping * 0.2).max(1e-12);
        } else {
            damping *= 8.0;
            if damping > 1e4 {
                return None;
            }
        }
    }
    (miss.norm() < STUCK).then_some(joints)
}

/// From one beginning: the damped descent until it is near, then the library's solver, which doubles the digits with
/// every step; where that fails (at a singularity) the damped descent to its end.
fn solve(
    chain: &Chain,
    limits: &[JointLimit],
    target: &Pose,
    from: &JointPositions,
    newton: Option<&Newton>,
) -> Option<JointPositions> {
    let Some(newton) = newton else {
        return home(descend(chain, limits, target, from, TOLERANCE)?, limits);
    };
    let near = descend(chain, limits, target, from, NEAR)?;
    if let Some(found) = newton.solve(target, &near, limits) {
        return Some(found);
    }
    home(descend(chain, limits, target, &near, TOLERANCE)?, limits)
}

/// The posture that a damped descent from `near` comes to: of the same branch, if `near` is not far away.
pub(crate) fn nearest(
    chain: &Chain,
    limits: &[JointLimit],
    target: &Pose,
    near: &JointPositions,
) -> Option<JointPositions> {
    solve(chain, limits, target, near, None)
}

/// One entry per branch (whole turns are left to the caller), of those met from beginnings that fill the joint box
/// evenly, always the same ones. It may miss some; those it gives are true.
pub(crate) fn solutions(
    chain: &Chain,
    limits: &[JointLimit],
    target: &Pose,
) -> Vec<JointPositions> {
    let newton = Newton::new(chain, limits);
    let most = if limits.len() > 6 { MOST_OF_MANY } else { 64 };
    let mut found: Vec<JointPositions> = Vec::new();
    let mut idle = 0;
    for k in 0..BEGINNINGS {
        let from = beginning(limits, k);
        let solution = solve(chain, limits, target, &from, newton.as_ref());
        match solution {
            Some(solution) if found.iter().all(|f| !same_posture(f, &solution)) => {
                found.push(solution);
                idle = 0;
            }
            _ => idle += 1,
        }
        if idle == IDLE || found.len() == most {
            break;
        }
    }
    found
}

/// Equal but for whole turns.
pub(crate) fn same_posture(a: &JointPositions, b: &JointPositions) -> bool {
    a.iter().zip(b.iter()).all(|(a, b)| {
        let apart = (a - b).rem_euclid(TAU);
        apart.min(TAU - apart) < SAME
    })
}

/// Halton's sequence in the joint box: digits of `k` mirrored at the point, another prime for every joint.
/// One turn about the middle is enough of a joint that turns round.
fn beginning(limits: &[JointLimit], k: usize) -> JointPositions {
    let mut from = JointPositions::zeros(limits.len());
    for (i, limit) in limits.iter().enumerate() {
        let base = [2, 3, 5, 7, 11, 13, 17, 19][i % 8];
        let middle = 0.5 * (limit.lower + limit.upper);
        let width = (limit.upper - limit.lower).min(TAU);
        from[i] = middle + width * (mirrored(k + 1, base) - 0.5);
    }
    from
}

fn mirrored(mut index: usize, base: usize) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0);
    while index > 0 {
        digit /= base as f64;
        value += digit * (index % base) as f64;
        index /= base;
    }
    value
}

/// What is missing to the target: metres, then radians about the base's axes.
pub(crate) fn error(chain: &Chain, target: &Pose, joints: &JointPositions) -> Vector6<f64> {
    let at = chain.base_from_tip(joints);
    let way = target.translation.vector - at.translation.vector;
    let turn = (target.rotation * at.rotation.inverse()).scaled_axis();
    Vector6::new(way.x, way.y, way.z, turn.x, turn.y, turn.z)
}

/// Columns beyond the arm's joints are zero.
fn jacobian(chain: &Chain, joints: &JointPositions) -> SMatrix<f64, 6, MAX_JOINTS> {
    let tip = chain.base_from_tip(joints).translation.vector;
    let mut matrix = SMatrix::zeros();
    for axis in chain.axes(joints) {
        let way = axis.direction.cross(&(tip - axis.point)) * axis.multiplier;
        let turn = axis.direction * axis.multiplier;
        for i in 0..3 {
            matrix[(i, axis.index)] += way[i];
            matrix[(i + 3, axis.index)] += turn[i];
        }
    }
    matrix
}
