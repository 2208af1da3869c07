//! Calls that tell the vision system something and get a status alone.

use std::task::Poll;

use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};
use depal_wire::{
    Request, RobotPosePayload, SetBoxSize, SetBranch, SetIndex, StartVision, StartViz, StopViz,
    SwitchRecipe, VizStartPayload, WriteParameter,
};

use super::link::{argument, code, exchange, failure, report, whole};
use crate::builtins::{Ran, done, number};
use crate::position::{Position, arm_from_shown, shown_pose};
use crate::state;

/// Joints of the arm's description in degrees, and the flange pose in the robot base.
pub(super) fn here(system: &dyn System) -> ([f64; 6], [f64; 6]) {
    let joints = system.joints();
    let mut degrees = [0.0; 6];
    for (to, from) in degrees.iter_mut().zip(joints.to_degrees()) {
        *to = from;
    }
    let flange = shown_pose(&system.forward(&joints));
    (degrees, flange)
}

/// Joint angles of a position register that must hold such.
fn taught_joints(
    context: &CallContext<'_>,
    system: &dyn System,
    at: usize,
) -> Result<[f64; 6], RaisedError> {
    let index = number(context, at)?;
    let Position {
        is_joint, values, ..
    } = state::position(context.memory, index)?;
    if !is_joint {
        return Err(argument(format!(
            "PR[{index}] must hold joint angles, it holds a Cartesian position"
        )));
    }
    let joints = arm_from_shown(
        &values,
        system.joints().len(),
        state::is_coupled(context.memory),
    );
    let mut degrees = [0.0; 6];
    for (to, from) in degrees.iter_mut().zip(joints.to_degrees()) {
        *to = from;
    }
    Ok(degrees)
}

/// Sends a request whose reply is a status. `status` is the argument for the register of the status, if any.
fn tell(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    name: &str,
    success: i32,
    status: usize,
    make: impl Fn(&CallContext<'_>, &dyn System) -> Result<Request, RaisedError>,
) -> Ran {
    if context.notes.is_empty() {
        context.notes.push(Value::Bool(true));
    }
    let request = make(context, system)?;
    let code = match exchange(context, system, &request) {
        Poll::Pending => return Ok(Outcome::Blocked),
        Poll::Ready(Ok(reply)) => code(&reply),
        Poll::Ready(Err(code)) => code,
    };
    // A register of the call itself, or one behind its arguments.
    let told = report(context, status, code)?;
    let told = report(context, status + 1, code)? || told;
    if code == success || told {
        done()
    } else {
        Err(failure(name, code))
    }
}

pub(super) fn start_vision(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    tell(
        context,
        system,
        "MM_START_VIS",
        1102,
        4,
        |context, system| {
            let (joints_deg, flange) = here(system);
            let pose = match whole(context, 2, "SendPos_Type")? {
                0 => RobotPosePayload::NotSent,
                1 => RobotPosePayload::JointsAndFlange {
                    joints_deg,
                    flange: Some(flange),
                },
                2 => RobotPosePayload::Flange(flange),
                3 => RobotPosePayload::StartJoints(taught_joints(context, system, 3)?),
                other => {
                    return Err(argument(format!(
                        "SendPos_Type is {other}; 0 to 3 are possible"
                    )));
                }
            };
            Ok(Request::StartVision(StartVision {
                job: whole(context, 0, "Job")?,
                count: whole(context, 1, "Pos_Num_Need")?,
                pose,
            }))
        },
    )
}

pub(super) fn switch_recipe(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    tell(context, system, "MM_SET_MOD", 1107, 2, |context, _| {
        Ok(Request::SwitchRecipe(SwitchRecipe {
            job: whole(context, 0, "Job")?,
            recipe: whole(context, 1, "Model_Num")?,
        }))
    })
}

pub(super) fn start_viz(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    tell(
        context,
        system,
        "MM_START_VIZ",
        2103,
        2,
        |context, system| {
            let (joints_deg, flange) = here(system);
            let start = match whole(context, 0, "SendPos_Type")? {
                0 => VizStartPayload::NotSent,
                1 => VizStartPayload::JointsAndFlange {
                    joints_deg,
                    flange: Some(flange),
                },
                2 => VizStartPayload::StartJoints(taught_joints(context, system, 1)?),
                other => {
                    return Err(argument(format!(
                        "SendPos_Type is {other}; 0 to 2 are possible"
                    )));
                }
            };
            Ok(Request::StartViz(StartViz { start }))
        },
    )
}

pub(super) fn set_branch(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    tell(context, system, "MM_SET_BCH", 2105, 2, |context, _| {
        Ok(Request::SetBranch(SetBranch {
            step: whole(context, 0, "Branch_Num")?,
            port: whole(context, 1, "Export_Num")?,
        }))
    })
}

pub(super) fn set_index(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    tell(context, system, "MM_SET_IDX", 2106, 2, |context, _| {
        Ok(Request::SetIndex(SetIndex {
            step: whole(context, 0, "Skill_Num")?,
            index: whole(context, 1, "Index_Num")?,
        }))
    })
}

pub(super) fn write_parameter(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    tell(context, system, "MM_SET_PROP", 2108, 1, |context, _| {
        Ok(Request::WriteParameter(WriteParameter {
            id: whole(context, 0, "Write_id")?,
        }))
    })
}

pub(super) fn set_box_size(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    tell(context, system, "MM_SET_BS", 1108, 4, |context, _| {
        Ok(Request::SetBoxSize(SetBoxSize {
            job: whole(context, 0, "Job")?,
            size_mm: [
                number(context, 1)?,
                number(context, 2)?,
                number(context, 3)?,
            ],
        }))
    })
}

pub(super) fn stop_viz(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    tell(context, system, "MM_STOP_VIZ", 2104, 0, |_, _| {
        Ok(Request::StopViz(StopViz))
    })
}
