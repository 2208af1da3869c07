//! Where the arm is, and where it would be.

use depal_frames::Pose;
use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError};

use super::records::*;
use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 5] = [
    (
        "FUNC robtarget CRobT(\\string TaskName \\tooldata Tool \\wobjdata WObj)",
        c_rob_t,
    ),
    ("FUNC pos CPos(\\tooldata Tool \\wobjdata WObj)", c_pos),
    ("FUNC jointtarget CJointT(\\string TaskName)", c_joint_t),
    (
        "FUNC robtarget CalcRobT(jointtarget Joint_target, tooldata Tool \\wobjdata WObj)",
        calc_rob_t,
    ),
    (
        "FUNC jointtarget CalcJointT(\\switch UseCurWObjPos, robtarget Rob_target, tooldata Tool \\wobjdata WObj \\INOUT errnum ErrorNumber)",
        calc_joint_t,
    ),
];

/// Tool of a function; the flange if none is given.
fn tool_or_flange(context: &CallContext<'_>, index: usize) -> Result<Pose, RaisedError> {
    match optional(context, index)? {
        Some(value) => tool(&value),
        None => Ok(Pose::identity()),
    }
}

fn c_rob_t(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let joints = system.joints();
    let base_from_tcp = system.forward(&joints) * tool_or_flange(context, 1)?;
    let base_from_object = work_object(context.value(2)?)?;
    let object_from_tcp = base_from_object.inverse() * base_from_tcp;
    Ok(Outcome::Done(robtarget(&object_from_tcp, &joints)))
}

fn c_pos(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let base_from_tcp = system.forward(&system.joints()) * tool_or_flange(context, 0)?;
    let base_from_object = work_object(context.value(1)?)?;
    let object_from_tcp = base_from_object.inverse() * base_from_tcp;
    Ok(Outcome::Done(pos(object_from_tcp.translation.vector * 1e3)))
}

fn c_joint_t(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    Ok(Outcome::Done(joint_target(&system.joints())))
}

fn calc_rob_t(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let joints = joints(context.required(0)?, system.joints().len())?;
    let base_from_tcp = system.forward(&joints) * tool(context.required(1)?)?;
    let base_from_object = work_object(context.value(2)?)?;
    let object_from_tcp = base_from_object.inverse() * base_from_tcp;
    Ok(Outcome::Done(robtarget(&object_from_tcp, &joints)))
}

/// Of several solutions the one nearest to the end of the queued moves.
fn calc_joint_t(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let target = context.required(1)?;
    let object_from_tcp = pose_of(part(target, 0), part(target, 1))?;
    let base_from_object = work_object(context.value(3)?)?;
    let flange_from_tcp = tool(context.required(2)?)?;
    let base_from_flange = base_from_object * object_from_tcp * flange_from_tcp.inverse();
    let near = system.planned_joints();
    match system.inverse(&base_from_flange, &near) {
        Ok(joints) => Ok(Outcome::Done(joint_target(&joints))),
        Err(fault) => {
            let raised = context.system_fault(fault);
            let raised = error("ERR_ROBLIMIT", raised.message);
            if context.is_given(4) {
                // With \ErrorNumber the answer is where the arm is.
                context.assign_number(4, raised.number as f64)?;
                return Ok(Outcome::Done(joint_target(&near)));
            }
            Err(raised)
        }
    }
}
