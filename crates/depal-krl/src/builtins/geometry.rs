use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, Value};

use super::frames::*;
use super::table::{Entry, Operator, Ran};

pub(super) const ENTRIES: [Entry; 3] = [
    ("FRAME INV_POS(FRAME Position)", inv_pos),
    ("E6POS FORWARD(E6AXIS Axes, INT Error:OUT)", forward),
    (
        "E6AXIS INVERSE(E6POS Position, E6AXIS Start, INT Error:OUT)",
        inverse,
    ),
];

pub(super) const OPERATORS: [Operator; 5] = [
    ("frame product", frame_product),
    ("axes now", axes_now),
    ("position now", position_now),
    ("axes planned", axes_planned),
    ("position planned", position_planned),
];

fn inv_pos(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let inverse = pose(context, context.required(0)?)?.inverse();
    Ok(Outcome::Done(frame(&inverse)))
}

/// Has the components that the right side has; its status, turn and external axes stay.
fn frame_product(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let right = context.required(1)?.clone();
    let product = pose(context, context.required(0)?)? * pose(context, &right)?;
    let Value::Record(mut parts) = right else {
        return Err(context.argument_error("a position is needed"));
    };
    for (part, value) in parts.iter_mut().zip(parts_of_pose(&product)) {
        *part = Value::Num(value as f32);
    }
    Ok(Outcome::Done(Value::Record(parts)))
}

fn axes_now(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    Ok(Outcome::Done(e6axis(&system.joints())))
}

fn axes_planned(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    Ok(Outcome::Done(e6axis(&system.planned_joints())))
}

fn at(
    context: &CallContext<'_>,
    system: &dyn System,
    joints: &depal_frames::JointPositions,
) -> Ran {
    let base_from_tcp = system.forward(joints) * tool(context)?;
    let object_from_tcp = base(context)?.inverse() * base_from_tcp;
    Ok(Outcome::Done(e6pos(&object_from_tcp, joints)))
}

/// The tool in `$BASE`.
fn position_now(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    at(context, system, &system.joints())
}

fn position_planned(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    at(context, system, &system.planned_joints())
}

fn axes(context: &CallContext<'_>, argument: usize) -> Result<[f64; 6], depal_vm::RaisedError> {
    let parts = axis_parts(context.required(argument)?);
    if parts.iter().any(Option::is_none) {
        return Err(context.argument_error("an axis angle has no value yet"));
    }
    Ok(parts.map(|p| p.unwrap_or(0.0)))
}

fn forward(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let joints = joints_of_axes(&axes(context, 0)?, system.joints().len());
    context.assign(1, Value::Int(0))?;
    at(context, system, &joints)
}

/// Error 1: out of reach; the answer is where it started from.
fn inverse(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let near = joints_of_axes(&axes(context, 1)?, system.joints().len());
    let object_from_tcp = pose(context, context.required(0)?)?;
    let base_from_flange = base(context)? * object_from_tcp * tool(context)?.inverse();
    let (joints, error) = match system.inverse(&base_from_flange, &near) {
        Ok(joints) => (joints, 0),
        Err(_) => (near, 1),
    };
    context.assign(2, Value::Int(error))?;
    Ok(Outcome::Done(e6axis(&joints)))
}
