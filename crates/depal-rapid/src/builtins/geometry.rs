use depal_frames::nalgebra::Quaternion;
use depal_frames::{Point, Pose, Rotation, Vector};
use depal_vm::system::System;
use depal_vm::{BuiltinFn, CallContext, Outcome, RaisedError, Value};

use super::records::*;
use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 12] = [
    (
        "FUNC robtarget Offs(robtarget Point, num XOffset, num YOffset, num ZOffset)",
        offs,
    ),
    (
        "FUNC robtarget RelTool(robtarget Point, num Dx, num Dy, num Dz \\num Rx \\num Ry \\num Rz)",
        rel_tool,
    ),
    (
        "FUNC orient OrientZYX(num ZAngle, num YAngle, num XAngle)",
        orient_zyx,
    ),
    (
        "FUNC num EulerZYX(\\switch X | switch Y | switch Z, orient Rotation)",
        euler_zyx,
    ),
    ("FUNC orient NOrient(orient Rotation)", n_orient),
    ("FUNC pose PoseMult(pose Pose1, pose Pose2)", pose_mult),
    ("FUNC pose PoseInv(pose Pose)", pose_inv),
    ("FUNC pos PoseVect(pose Pose, pos Pos)", pose_vect),
    ("FUNC num Distance(pos Point1, pos Point2)", distance),
    ("FUNC num DotProd(pos Vector1, pos Vector2)", dot_prod),
    ("FUNC num VectMagn(pos Vector)", vect_magn),
    (
        "FUNC pose DefFrame(robtarget NewP1, robtarget NewP2, robtarget NewP3 \\num Origin)",
        def_frame,
    ),
];

/// Operators on records. The names cannot be written in a program.
pub(super) const OPERATORS: [(&str, BuiltinFn); 7] = [
    ("pos + pos", pos_add),
    ("pos - pos", pos_subtract),
    ("pos * num", pos_scale),
    ("num * pos", num_scale),
    ("pos / num", pos_divide),
    ("pos * pos", pos_cross),
    ("orient * orient", orient_multiply),
];

fn with_frame(target: &Value, trans: Value, rot: Value) -> Value {
    Value::Record(vec![
        trans,
        rot,
        part(target, 2).clone(),
        part(target, 3).clone(),
    ])
}

fn offs(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let offset = Vector::new(context.number(1)?, context.number(2)?, context.number(3)?);
    let target = context.required(0)?;
    let trans = pos(vector(part(target, 0)) + offset);
    finish(with_frame(target, trans, part(target, 1).clone()))
}

/// Moves in the tool frame, then turns about the tool's x, then y, then z as they stand after each turn.
fn rel_tool(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let offset = Vector::new(context.number(1)?, context.number(2)?, context.number(3)?);
    let turn = |axis: Vector, index: usize| -> Result<Rotation, RaisedError> {
        Ok(Rotation::new(axis * context.number(index)?.to_radians()))
    };
    let turned = turn(Vector::x(), 4)? * turn(Vector::y(), 5)? * turn(Vector::z(), 6)?;
    let target = context.required(0)?;
    let object_from_tcp = pose_of(part(target, 0), part(target, 1))?;
    let tcp_from_new = Pose::from_parts((offset * 1e-3).into(), turned);
    let new = object_from_tcp * tcp_from_new;
    let trans = pos(new.translation.vector * 1e3);
    finish(with_frame(target, trans, orient(&new.rotation)))
}

fn orient_zyx(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (z, y, x) = (context.number(0)?, context.number(1)?, context.number(2)?);
    let rotation = Rotation::from_euler_angles(x.to_radians(), y.to_radians(), z.to_radians());
    finish(orient(&rotation))
}

fn euler_zyx(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let rotation = rotation(context.required(3)?)?;
    let (x, y, z) = rotation.euler_angles();
    let angle = if context.is_given(0) {
        x
    } else if context.is_given(1) {
        y
    } else if context.is_given(2) {
        z
    } else {
        return Err(context.argument_error("EulerZYX needs one of \\X, \\Y, \\Z"));
    };
    finish(num(angle.to_degrees()))
}

fn n_orient(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let value = context.required(0)?;
    let q = Quaternion::new(
        number(value, 0),
        number(value, 1),
        number(value, 2),
        number(value, 3),
    );
    let norm = q.norm();
    if norm < 0.1 {
        return Err(error(
            "ERR_ORIENT_VALUE",
            format!("a quaternion of length {norm:.4} has no direction"),
        ));
    }
    let q = q / norm;
    finish(Value::Record([q.w, q.i, q.j, q.k].map(num).to_vec()))
}

fn pose_mult(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let product = pose(context.required(0)?)? * pose(context.required(1)?)?;
    finish(pose_value(&product))
}

fn pose_inv(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    finish(pose_value(&pose(context.required(0)?)?.inverse()))
}

fn pose_vect(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let pose = pose(context.required(0)?)?;
    let point = Point::from(vector(context.required(1)?) * 1e-3);
    finish(pos((pose * point).coords * 1e3))
}

fn distance(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (a, b) = two_vectors(context)?;
    finish(num((a - b).norm()))
}

fn dot_prod(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (a, b) = two_vectors(context)?;
    finish(num(a.dot(&b)))
}

fn vect_magn(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    finish(num(vector(context.required(0)?).norm()))
}

/// Origin in p1, x towards p2, y on the side of p3 (the default of \Origin, 1).
fn def_frame(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    if context.optional_number(3)?.is_some_and(|o| o != 1.0) {
        return Err(context.argument_error("DefFrame \\Origin: only 1 is simulated"));
    }
    let point = |index: usize| -> Result<Vector, RaisedError> {
        Ok(vector(part(context.required(index)?, 0)))
    };
    let (p1, p2, p3) = (point(0)?, point(1)?, point(2)?);
    let x = p2 - p1;
    let z = x.cross(&(p3 - p1));
    if x.norm() < 1e-3 || z.norm() < 1e-3 * x.norm() {
        return Err(context.argument_error("the three points of DefFrame lie on a line"));
    }
    let x = x.normalize();
    let z = z.normalize();
    let matrix = depal_frames::nalgebra::Matrix3::from_columns(&[x, z.cross(&x), z]);
    let rotation = Rotation::from_matrix(&matrix);
    finish(Value::Record(vec![pos(p1), orient(&rotation)]))
}

fn two_vectors(context: &CallContext<'_>) -> Result<(Vector, Vector), RaisedError> {
    Ok((vector(context.required(0)?), vector(context.required(1)?)))
}

fn pos_add(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (a, b) = two_vectors(context)?;
    finish(pos(a + b))
}

fn pos_subtract(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (a, b) = two_vectors(context)?;
    finish(pos(a - b))
}

fn pos_scale(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    finish(pos(vector(context.required(0)?) * context.number(1)?))
}

fn num_scale(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    finish(pos(vector(context.required(1)?) * context.number(0)?))
}

fn pos_divide(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let divisor = context.number(1)?;
    if divisor == 0.0 {
        return Err(context.raise(&depal_vm::MachineFault::DivisionByZero));
    }
    finish(pos(vector(context.required(0)?) / divisor))
}

fn pos_cross(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let (a, b) = two_vectors(context)?;
    finish(pos(a.cross(&b)))
}

fn orient_multiply(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let product = rotation(context.required(0)?)? * rotation(context.required(1)?)?;
    finish(orient(&product))
}

fn finish(value: Value) -> Ran {
    Ok(Outcome::Done(value))
}
