//! Between our poses and the wire's six numbers.

use depal_frames::{EulerConvention, JointPositions, Pose, Rotation, Vector};

/// An exact all-zero record means "empty" to robot programs; this goes out instead, mm or degrees.
const NOT_QUITE_ZERO: f64 = 1e-4;

/// Object poses look up, tools look down: `tcp = object * Rx(180 degrees)`, about the object's own X.
pub(crate) fn tcp_of_object(base_from_object: &Pose) -> Pose {
    let half_turn = Rotation::from_axis_angle(&Vector::x_axis(), std::f64::consts::PI);
    base_from_object * half_turn
}

/// A pose in mm and degrees; angles in -180 < a <= 180.
pub(crate) fn pose_values(euler: EulerConvention, pose: &Pose) -> [f64; 6] {
    let mut values = euler.mm_deg_from_pose(pose);
    for angle in &mut values[3..] {
        // Half a unit of the fourth decimal: -180 and 180 are the same, and only one is printed.
        if *angle <= -180.0 + 0.5 * NOT_QUITE_ZERO {
            *angle += 360.0;
        }
    }
    tidied(values)
}

/// Joints in degrees, filled up with zeros to six.
pub(crate) fn joint_values(joints: &JointPositions) -> [f64; 6] {
    let mut values = [0.0; 6];
    for (value, joint) in values.iter_mut().zip(joints.iter()) {
        *value = joint.to_degrees();
    }
    tidied(values)
}

/// Rounded, and never exactly all zero.
fn tidied(mut values: [f64; 6]) -> [f64; 6] {
    for value in &mut values {
        // A nanometre or a millionth of a degree: below it is arithmetic noise, and so is the sign of zero.
        *value = (*value * 1e6).round() / 1e6 + 0.0;
    }
    never_all_zero(values)
}

/// The values, unless all six would be printed as zero.
pub(crate) fn never_all_zero(values: [f64; 6]) -> [f64; 6] {
    if values.iter().all(|v| v.abs() < 0.5 * NOT_QUITE_ZERO) {
        return [NOT_QUITE_ZERO; 6];
    }
    values
}
