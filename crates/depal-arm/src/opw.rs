use depal_frames::{JointPositions, Pose, Vector};
use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use rs_opw_kinematics::{
    glam::{DQuat, DVec3},
    kinematic_traits::{Joints, Kinematics, Pose as OpwPose},
    kinematics_impl::OPWKinematics,
    parameters::opw_kinematics::Parameters,
};

use crate::chain::Chain;

/// Axes may be this far from where an ortho-parallel arm has them, metres or (for directions) unitless.
const TOLERANCE: f64 = 1e-6;

/// The closed-form solver and the constant turn from its flange to ours.
#[derive(Debug, Clone)]
pub(crate) struct Solver {
    opw: OPWKinematics,
    opw_from_flange: Pose,
    flange_from_opw: Pose,
}

impl Solver {
    /// Recognises the parameters from where the axes lie at zero joints.
    ///
    /// In the model's own zero the arm stands straight up: axis 1 = Z, axes 2, 3 and 5 = Y, axes 4 and 6 = Z;
    /// the model angle is `sign * joint - offset`.
    pub fn recognise(chain: &Chain, names: &[String]) -> Result<Self, String> {
        let not = |joint: usize, reason: String| format!("joint '{}': {reason}", names[joint]);
        let axes = chain.axes_at_zero(names.len());
        if let Some(odd) = (0..axes.len().max(6)).find(|&i| {
            axes.get(i)
                .is_none_or(|a| a.index != i || i >= 6 || a.offset != 0.0)
        }) {
            return Err(not(
                odd.min(names.len() - 1),
                "not six joints in a row without mimics".to_owned(),
            ));
        }
        let (directions, points): (Vec<Vector>, Vec<Vector>) =
            axes.into_iter().map(|a| (a.direction, a.point)).unzip();
        let y = Vector::y();
        let sign = |value: f64| if value < 0.0 { -1 } else { 1 };

        if directions[0].xy().norm() > TOLERANCE || points[0].xy().norm() > TOLERANCE {
            return Err(not(
                0,
                format!(
                    "axis {:?} at {:?} m",
                    directions[0].as_slice(),
                    points[0].as_slice()
                ),
            ));
        }
        for joint in [1, 2] {
            if directions[joint].cross(&y).norm() > TOLERANCE {
                return Err(not(
                    joint,
                    format!("axis {:?}", directions[joint].as_slice()),
                ));
            }
        }
        let (a1, c1) = (points[1].x, points[1].z);
        let upper = points[2] - points[1];
        let c2 = upper.x.hypot(upper.z);
        let q2 = upper.x.atan2(upper.z);

        // The wrist centre: where axes 4 and 6 meet axis 5.
        let wrist = closest_point(points[3], directions[3], points[4], directions[4]);
        for joint in [3, 4, 5] {
            let off = (wrist - points[joint]).cross(&directions[joint]).norm();
            if off > TOLERANCE {
                return Err(not(
                    joint,
                    format!("axis misses the wrist centre by {off:.6} m"),
                ));
            }
        }
        if directions[3].dot(&directions[4]).abs() > TOLERANCE
            || directions[4].dot(&directions[5]).abs() > TOLERANCE
        {
            return Err(not(4, "axis is not square to its neighbours".to_owned()));
        }
        if directions[3].y.abs() > TOLERANCE {
            return Err(not(3, format!("axis {:?}", directions[3].as_slice())));
        }
        let from_elbow = wrist - points[2];
        let forearm = directions[3] * f64::from(sign(from_elbow.dot(&directions[3])));
        let c3 = from_elbow.dot(&forearm);
        let across = y.cross(&forearm);
        let a2 = from_elbow.dot(&across);
        let q23 = forearm.x.atan2(forearm.z);
        // Axis 5 at zero, as a turn about the forearm away from Y, at most a quarter turn.
        let sign5 = sign(directions[4].dot(&y));
        let fifth = directions[4] * f64::from(sign5);
        let q4 = (-fifth.dot(&across)).atan2(fifth.dot(&y));
        // Axis 6 points out of the wrist towards the flange.
        let flange = chain.base_from_tip(&JointPositions::zeros(6));
        let reach = (flange.translation.vector - wrist).dot(&directions[5]);
        let sixth = directions[5] * f64::from(sign(reach));
        let q5 = forearm.cross(&sixth).dot(&fifth).atan2(forearm.dot(&sixth));

        let opw = OPWKinematics::new(Parameters {
            a1,
            a2,
            b: wrist.y,
            c1,
            c2,
            c3,
            c4: reach.abs(),
            offsets: [0.0, -q2, -(q23 - q2), -q4, -q5, 0.0],
            sign_corrections: [
                sign(directions[0].z),
                sign(directions[1].y),
                sign(directions[2].y),
                sign(directions[3].dot(&forearm)),
                sign5,
                sign(reach),
            ],
            dof: 6,
        });
        let at_zero = from_opw(&opw.forward(&[0.0; 6]));
        let opw_from_flange = at_zero.inverse() * flange;
        Ok(Self {
            opw,
            opw_from_flange,
            flange_from_opw: opw_from_flange.inverse(),
        })
    }

    pub fn base_from_flange(&self, joints: &JointPositions) -> Pose {
        from_opw(&self.opw.forward(&to_array(joints))) * self.opw_from_flange
    }

    /// One entry per branch, each angle somewhere in one turn; `near` decides at a singularity of the wrist.
    pub fn branches(&self, base_from_flange: &Pose, near: Option<&JointPositions>) -> Vec<Joints> {
        let base_from_opw = base_from_flange * self.flange_from_opw;
        let t = base_from_opw.translation.vector;
        let q = base_from_opw.rotation.coords;
        let Ok(pose) = OpwPose::try_from_parts(
            DVec3::new(t.x, t.y, t.z),
            DQuat::from_xyzw(q.x, q.y, q.z, q.w),
        ) else {
            return Vec::new();
        };
        match near {
            None => self.opw.inverse(&pose),
            Some(near) => self.opw.inverse_continuing(&pose, &to_array(near)),
        }
    }
}

fn to_array(joints: &JointPositions) -> Joints {
    std::array::from_fn(|i| joints[i])
}

fn from_opw(pose: &OpwPose) -> Pose {
    let (t, q) = (pose.translation, pose.rotation);
    Pose::from_parts(
        Translation3::new(t.x, t.y, t.z),
        UnitQuaternion::from_quaternion(Quaternion::new(q.w, q.x, q.y, q.z)),
    )
}

/// The point of line `a` nearest to line `b` (`a` itself when they are parallel); unit directions.
fn closest_point(a: Vector, along_a: Vector, b: Vector, along_b: Vector) -> Vector {
    let cosine = along_a.dot(&along_b);
    let square = 1.0 - cosine * cosine;
    if square < 1e-12 {
        return a;
    }
    let between = b - a;
    a + along_a * ((between.dot(&along_a) - cosine * between.dot(&along_b)) / square)
}
