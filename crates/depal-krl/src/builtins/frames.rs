//! Positions and axis angles of programs, and what the cabinet calls them.

use depal_frames::{EulerConvention, JointPositions, Pose};
use depal_vm::{CallContext, RaisedError, Value};

use super::state::variable;

/// Components of E6POS before the external axes: X, Y, Z, A, B, C, S, T.
const POSE_PARTS: usize = 8;

/// The components X to C, millimetres and degrees; `None` where there is none.
pub(super) fn pose_parts(value: &Value) -> [Option<f64>; 6] {
    std::array::from_fn(|i| match value {
        Value::Record(parts) => parts.get(i).and_then(Value::as_number),
        _ => None,
    })
}

pub(super) fn pose_from_parts(parts: [f64; 6]) -> Pose {
    EulerConvention::KukaAbc.pose_from_mm_deg(parts)
}

/// A pose of which every component must be there.
pub(super) fn pose(context: &CallContext<'_>, value: &Value) -> Result<Pose, RaisedError> {
    let parts = pose_parts(value);
    for (part, name) in parts.iter().zip(["X", "Y", "Z", "A", "B", "C"]) {
        if part.is_none_or(|v| !v.is_finite()) {
            return Err(context.argument_error(format!("the component {name} has no value yet")));
        }
    }
    Ok(pose_from_parts(parts.map(|p| p.unwrap_or(0.0))))
}

pub(super) fn parts_of_pose(pose: &Pose) -> [f64; 6] {
    EulerConvention::KukaAbc.mm_deg_from_pose(pose)
}

/// A FRAME.
pub(super) fn frame(pose: &Pose) -> Value {
    let parts = parts_of_pose(pose).map(|v| Value::Num(v as f32));
    Value::Record(parts.to_vec())
}

/// An E6POS at these joints, with its status and turn.
pub(super) fn e6pos(pose: &Pose, joints: &JointPositions) -> Value {
    let axes = axes_of_joints(joints);
    let mut parts: Vec<_> = parts_of_pose(pose).map(|v| Value::Num(v as f32)).to_vec();
    parts.push(Value::Int(status(&axes)));
    parts.push(Value::Int(turn(&axes)));
    parts.extend([0.0; 6].map(Value::Num));
    Value::Record(parts)
}

/// Status bits that the axis angles alone decide: bit 2 is the sign of axis 5.
pub(super) fn status(axes: &[f64; 6]) -> i64 {
    let negative = (-180.0..0.0).contains(&axes[4]) || axes[4] >= 180.0;
    if negative { 4 } else { 0 }
}

/// Turn: one bit for each axis at a negative angle.
pub(super) fn turn(axes: &[f64; 6]) -> i64 {
    let bits = axes.iter().enumerate();
    bits.map(|(i, angle)| i64::from(*angle < 0.0) << i).sum()
}

/// Which of A1 to A6 the joints of an arm are; a palletizer has no A4 and A5.
fn places(joints: usize) -> &'static [usize] {
    match joints {
        4 => &[0, 1, 2, 5],
        5 => &[0, 1, 2, 4, 5],
        count => [0, 1, 2, 3, 4, 5].split_at(count.min(6)).0,
    }
}

/// A1 to A6 in degrees.
pub(super) fn axes_of_joints(joints: &JointPositions) -> [f64; 6] {
    let mut axes = [0.0; 6];
    for (place, angle) in places(joints.len()).iter().zip(joints.iter()) {
        axes[*place] = angle.to_degrees();
    }
    axes
}

/// Joints of an arm with so many, from A1 to A6 in degrees.
pub(super) fn joints_of_axes(axes: &[f64; 6], count: usize) -> JointPositions {
    let mut joints = JointPositions::zeros(count);
    for (place, joint) in places(count).iter().zip(joints.iter_mut()) {
        *joint = axes[*place].to_radians();
    }
    joints
}

/// An E6AXIS.
pub(super) fn e6axis(joints: &JointPositions) -> Value {
    let mut parts: Vec<_> = axes_of_joints(joints)
        .map(|v| Value::Num(v as f32))
        .to_vec();
    parts.extend([0.0; 6].map(Value::Num));
    Value::Record(parts)
}

/// The six angles of an E6AXIS, `None` where there is none.
pub(super) fn axis_parts(value: &Value) -> [Option<f64>; 6] {
    pose_parts(value)
}

/// The arm has no external axes: they must not be asked to move.
pub(super) fn refuse_external(
    context: &CallContext<'_>,
    value: &Value,
    axes: bool,
) -> Result<(), RaisedError> {
    let first = if axes { 6 } else { POSE_PARTS };
    let Value::Record(parts) = value else {
        return Ok(());
    };
    for (i, part) in parts.iter().skip(first).enumerate() {
        if part.as_number().is_some_and(|v| v.abs() > 1e-6) {
            return Err(context.argument_error(format!(
                "the external axis E{} is asked to move; this arm has none",
                i + 1
            )));
        }
    }
    Ok(())
}

/// `base_from_object` of `$BASE`.
pub(super) fn base(context: &CallContext<'_>) -> Result<Pose, RaisedError> {
    pose(context, variable(context, "$base")).map_err(|error| named(error, "$BASE"))
}

/// `flange_from_tcp` of `$TOOL`.
pub(super) fn tool(context: &CallContext<'_>) -> Result<Pose, RaisedError> {
    pose(context, variable(context, "$tool")).map_err(|error| named(error, "$TOOL"))
}

fn named(mut error: RaisedError, variable: &str) -> RaisedError {
    error.message = format!("{variable}: {}", error.message);
    error
}
