//! RAPID records of the predefined types to and from poses and joints in SI.

use depal_frames::nalgebra::{Quaternion, Translation3};
use depal_frames::{JointPositions, Point, Pose, Rotation, Vector};
use depal_vm::{CallContext, RaisedError, Value};

use crate::errors::error;

/// What stands for an axis that is not there.
pub(super) const NOT_ACTIVE: f32 = 9e9;

/// How far the length of a quaternion may be from 1.
const QUATERNION_TOLERANCE: f64 = 0.01;

pub(super) fn num(value: f64) -> Value {
    Value::Num(value as f32)
}

/// Component `index` of a record.
pub(super) fn part(value: &Value, index: usize) -> &Value {
    match value {
        Value::Record(fields) => fields.get(index).unwrap_or(&Value::Absent),
        _ => &Value::Absent,
    }
}

pub(super) fn number(value: &Value, index: usize) -> f64 {
    part(value, index).as_number().unwrap_or(0.0)
}

/// `pos` in millimetres as it stands.
pub(super) fn vector(value: &Value) -> Vector {
    Vector::new(number(value, 0), number(value, 1), number(value, 2))
}

pub(super) fn pos(v: Vector) -> Value {
    Value::Record(vec![num(v.x), num(v.y), num(v.z)])
}

pub(super) fn orient(rotation: &Rotation) -> Value {
    // One of the two quaternions of a rotation: the one with a scalar that is not negative.
    let sign = if rotation.w < 0.0 { -1.0 } else { 1.0 };
    Value::Record(
        [rotation.w, rotation.i, rotation.j, rotation.k]
            .map(|q| num(q * sign))
            .to_vec(),
    )
}

/// `orient` to a rotation; it must have length 1.
pub(super) fn rotation(value: &Value) -> Result<Rotation, RaisedError> {
    let q = Quaternion::new(
        number(value, 0),
        number(value, 1),
        number(value, 2),
        number(value, 3),
    );
    let norm = q.norm();
    if (norm - 1.0).abs() > QUATERNION_TOLERANCE {
        return Err(error(
            "ERR_ORIENT_VALUE",
            format!("the quaternion has length {norm:.4}, expected 1; normalise it with NOrient"),
        ));
    }
    Ok(Rotation::from_quaternion(q))
}

/// `pose` (millimetres) to a pose in metres.
pub(super) fn pose(value: &Value) -> Result<Pose, RaisedError> {
    pose_of(part(value, 0), part(value, 1))
}

pub(super) fn pose_of(trans: &Value, rot: &Value) -> Result<Pose, RaisedError> {
    Ok(Pose::from_parts(
        Translation3::from(vector(trans) * 1e-3),
        rotation(rot)?,
    ))
}

/// A pose in metres as `pose`.
pub(super) fn pose_value(pose: &Pose) -> Value {
    Value::Record(vec![
        pos(pose.translation.vector * 1e3),
        orient(&pose.rotation),
    ])
}

/// `flange_from_tcp` of `tooldata`.
pub(super) fn tool(value: &Value) -> Result<Pose, RaisedError> {
    if part(value, 0) == &Value::Bool(false) {
        return Err(error(
            "ERR_ARGVALERR",
            "stationary tools (robhold FALSE) are not simulated",
        ));
    }
    pose(part(value, 1))
}

/// Mass (kg) and centre of mass (m, in the flange frame) of the tool itself: the `tload` of `tooldata`.
/// Its axes and moments of inertia do not count.
pub(super) fn tool_load(value: &Value) -> (f64, Point) {
    load(part(value, 2))
}

/// Mass (kg) and centre of mass (m) of `loaddata`.
fn load(value: &Value) -> (f64, Point) {
    let centre_mm = vector(part(value, 1));
    (number(value, 0).max(0.0), Point::from(centre_mm * 1e-3))
}

/// What `\TLoad` asks for; none for `load0`, which leaves tool and payload as they are.
pub(super) fn total_load(value: &Value) -> Option<(f64, Point)> {
    /// Mass of `load0`, kg, in single precision.
    const NONE: f64 = 0.001_01;
    Some(load(value)).filter(|(mass, _)| *mass > NONE)
}

/// `base_from_object` of `wobjdata`; the identity if none is given. World and base are the same.
pub(super) fn work_object(value: Option<&Value>) -> Result<Pose, RaisedError> {
    let Some(value) = value else {
        return Ok(Pose::identity());
    };
    if part(value, 0) == &Value::Bool(true) || part(value, 1) == &Value::Bool(false) {
        return Err(error(
            "ERR_ARGVALERR",
            "work objects held by a robot or moved by a mechanical unit are not simulated",
        ));
    }
    Ok(pose(part(value, 3))? * pose(part(value, 4))?)
}

/// `jointtarget` in degrees to the first `count` joints in radians.
pub(super) fn joints(value: &Value, count: usize) -> Result<JointPositions, RaisedError> {
    let robax = part(value, 0);
    let degrees: Vec<f64> = (0..count.min(6)).map(|i| number(robax, i)).collect();
    if let Some(axis) = degrees.iter().position(|d| d.abs() > 1e6) {
        return Err(error(
            "ERR_ROBLIMIT",
            format!(
                "axis {} of the target is {} degrees",
                axis + 1,
                degrees[axis]
            ),
        ));
    }
    Ok(JointPositions::from_degrees(&degrees))
}

pub(super) fn joint_target(joints: &JointPositions) -> Value {
    let degrees = joints.to_degrees();
    let robax = (0..6)
        .map(|i| num(degrees.get(i).copied().unwrap_or(0.0)))
        .collect();
    Value::Record(vec![Value::Record(robax), external_axes()])
}

/// A robtarget at `object_from_tcp`, with the quarter turns of the joints as its configuration (cfx is 0).
pub(super) fn robtarget(object_from_tcp: &Pose, joints: &JointPositions) -> Value {
    let quarter = |axis: usize| {
        let degrees = joints.get(axis).copied().unwrap_or(0.0).to_degrees();
        num((degrees / 90.0).floor())
    };
    Value::Record(vec![
        pos(object_from_tcp.translation.vector * 1e3),
        orient(&object_from_tcp.rotation),
        Value::Record(vec![quarter(0), quarter(3), quarter(5), num(0.0)]),
        external_axes(),
    ])
}

fn external_axes() -> Value {
    Value::Record(vec![Value::Num(NOT_ACTIVE); 6])
}

/// An argument that may be left out.
pub(super) fn optional(
    context: &CallContext<'_>,
    index: usize,
) -> Result<Option<Value>, RaisedError> {
    Ok(context.value(index)?.cloned())
}
