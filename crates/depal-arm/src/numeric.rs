use depal_frames::{JointPositions, Pose};
use nalgebra::{DMatrix, Vector6};

use crate::{JointLimit, chain::Chain};

/// A solution's flange may miss by this much, m and rad.
const TOLERANCE: f64 = 1e-10;
/// Steps from one beginning.
const STEPS: usize = 60;
/// Largest change of a joint in one step, rad.
const LARGEST_STEP: f64 = 0.5;
/// Beginnings spread over the joint box.
const BEGINNINGS: usize = 120;

/// Damped least squares (S. Buss, "Introduction to inverse kinematics with Jacobian transpose, pseudoinverse and
/// damped least squares methods", 2004) with the damping of Levenberg and Marquardt, from one beginning.
/// None when it gets stuck, which says nothing about other beginnings.
pub(crate) fn descend(
    chain: &Chain,
    limits: &[JointLimit],
    target: &Pose,
    from: &JointPositions,
) -> Option<JointPositions> {
    let mut joints = *from;
    let mut miss = error(chain, target, &joints);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        if miss.norm() < TOLERANCE {
            return Some(joints);
        }
        let jacobian = jacobian(chain, &joints);
        let mut square = jacobian.transpose() * &jacobian;
        for i in 0..joints.len() {
            square[(i, i)] += damping;
        }
        let right = jacobian.transpose() * DMatrix::from_column_slice(6, 1, miss.as_slice());
        let step = square.cholesky()?.solve(&right);
        let largest = step.iter().fold(0.0_f64, |a, s| a.max(s.abs()));
        let scale = (LARGEST_STEP / largest.max(1e-12)).min(1.0);
        let mut next = joints;
        for (i, limit) in limits.iter().enumerate() {
            next[i] = (joints[i] + step[i] * scale).clamp(limit.lower, limit.upper);
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
    (miss.norm() < 1e-8).then_some(joints)
}

/// Every solution met from beginnings that fill the joint box evenly, always the same ones.
/// It may miss some; those it gives are true.
pub(crate) fn solutions(
    chain: &Chain,
    limits: &[JointLimit],
    target: &Pose,
) -> Vec<JointPositions> {
    let mut found: Vec<JointPositions> = Vec::new();
    for k in 0..BEGINNINGS {
        let mut from = JointPositions::zeros(limits.len());
        for (i, limit) in limits.iter().enumerate() {
            // Halton's sequence: digits of k mirrored at the point, another prime for every joint.
            let base = [2, 3, 5, 7, 11, 13, 17, 19][i % 8];
            from[i] = limit.lower + (limit.upper - limit.lower) * mirrored(k + 1, base);
        }
        if let Some(solution) = descend(chain, limits, target, &from)
            && found.iter().all(|f| f.max_distance(&solution) > 1e-4)
        {
            found.push(solution);
        }
    }
    found
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
fn error(chain: &Chain, target: &Pose, joints: &JointPositions) -> Vector6<f64> {
    let at = chain.base_from_tip(joints);
    let way = target.translation.vector - at.translation.vector;
    let turn = (target.rotation * at.rotation.inverse()).scaled_axis();
    Vector6::new(way.x, way.y, way.z, turn.x, turn.y, turn.z)
}

fn jacobian(chain: &Chain, joints: &JointPositions) -> DMatrix<f64> {
    let tip = chain.base_from_tip(joints).translation.vector;
    let mut matrix = DMatrix::zeros(6, joints.len());
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
