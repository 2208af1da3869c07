//! From the command half of the block to a request.

use depal_wire::s7::{DataBlock, Field};
use depal_wire::{
    GetCustomData, GetDoList, GetNotify, GetPlanData, GetState, GetVisionDoList, GetVisionPath,
    GetVisionPlanData, GetVisionPoints, GetVizPath, Request, RobotPosePayload, SetBoxSize,
    SetBranch, SetIndex, SetOuterPose, StartVision, StartViz, Status, StopViz, SwitchRecipe,
    VizStartPayload,
};

/// What the registers ask for; or the status of a command that exists on other ports only.
pub(super) fn request_of(block: &DataBlock) -> Result<Request, Status> {
    let int = |field| i32::from(block.int(field, 0));
    let reals = |field| block.reals::<6>(field).map(f64::from);
    let job = int(Field::Project);
    let pose_type = int(Field::PoseType);
    let sections = Some(int(Field::Sections)).filter(|sections| *sections != 0);
    Ok(match int(Field::Command) {
        101 => Request::StartVision(StartVision {
            job,
            count: int(Field::PoseNumber),
            pose: match pose_type {
                0 => RobotPosePayload::NotSent,
                1 => RobotPosePayload::JointsAndFlange {
                    joints_deg: reals(Field::Joints),
                    flange: Some(reals(Field::Flange)),
                },
                2 => RobotPosePayload::Flange(reals(Field::Flange)),
                3 => RobotPosePayload::StartJoints(reals(Field::Joints)),
                other => RobotPosePayload::UnknownType(other),
            },
        }),
        102 => Request::GetVisionPoints(GetVisionPoints { job }),
        103 => Request::SwitchRecipe(SwitchRecipe {
            job,
            recipe: int(Field::Recipe),
        }),
        105 => Request::GetVisionPath(GetVisionPath { job, pose_type }),
        110 => Request::GetCustomData(GetCustomData { job }),
        201 => Request::StartViz(StartViz {
            start: match pose_type {
                0 => VizStartPayload::NotSent,
                1 => VizStartPayload::JointsAndFlange {
                    joints_deg: reals(Field::Joints),
                    flange: Some(reals(Field::Flange)),
                },
                2 => VizStartPayload::StartJoints(reals(Field::Joints)),
                other => VizStartPayload::UnknownType(other),
            },
        }),
        202 => Request::StopViz(StopViz),
        203 => Request::SetBranch(SetBranch {
            step: int(Field::BranchStep),
            port: int(Field::BranchExit),
        }),
        204 => Request::SetIndex(SetIndex {
            step: int(Field::IndexStep),
            index: int(Field::IndexCounter),
        }),
        205 => Request::GetVizPath(GetVizPath { pose_type }),
        206 if job == 0 => Request::GetDoList(GetDoList { sections }),
        206 => Request::GetVisionDoList(GetVisionDoList { job, sections }),
        // Plan data are asked for in any case: the label of a waypoint is the first of them.
        210 if job == 0 => Request::GetPlanData(GetPlanData {
            format: match pose_type {
                1 | 2 => pose_type + 2,
                other => other,
            },
        }),
        210 => Request::GetVisionPlanData(GetVisionPlanData { job, pose_type }),
        501 => Request::SetBoxSize(SetBoxSize {
            job,
            size_mm: block.reals::<3>(Field::BoxSize).map(f64::from),
        }),
        502 => Request::SetOuterPose(SetOuterPose {
            pose: reals(Field::OuterPose),
        }),
        601 => Request::GetNotify(GetNotify),
        901 => Request::GetState(GetState),
        code if Request::is_known(code) => return Err(Status::InvalidCommand),
        code => Request::Unknown { code },
    })
}
