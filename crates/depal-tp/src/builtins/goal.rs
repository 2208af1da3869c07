//! Where a move goes: frames, tools and offsets.

use depal_frames::Pose;
use depal_vm::system::{MoveTarget, System};
use depal_vm::{Memory, RaisedError};

use crate::errors::{error, interpreter, mismatch, uninitialized};
use crate::position::{Position, arm_from_shown, shown_from_arm};
use crate::state;

/// Where a move shall go.
pub(super) struct Goal<'a> {
    pub(super) position: &'a Position,
    /// How the listing names it.
    pub(super) name: &'a str,
    pub(super) offset: Option<(Position, Option<f64>)>,
    pub(super) tool_offset: Option<Position>,
    pub(super) is_incremental: bool,
}

fn check_frames(memory: &Memory, goal: &Goal<'_>) -> Result<(), RaisedError> {
    if goal.position.is_joint {
        return Ok(());
    }
    let name = goal.name;
    let in_use = state::number(memory, state::UFRAME_NUM);
    if let Some(frame) = goal.position.frame
        && f64::from(frame) != in_use
    {
        return Err(error(
            "INTP-252",
            format!(
                "User frame number mismatch: {name} was taught in UF {frame}, UFRAME_NUM is {in_use}"
            ),
        ));
    }
    let in_use = state::number(memory, state::UTOOL_NUM);
    if let Some(tool) = goal.position.tool
        && f64::from(tool) != in_use
    {
        return Err(interpreter(format!(
            "Tool frame number mismatch: {name} was taught with UT {tool}, UTOOL_NUM is {in_use}"
        )));
    }
    Ok(())
}

/// The frames in use: `base_from_frame` and `flange_from_tcp`.
pub(super) fn frames(memory: &Memory) -> (Pose, Pose) {
    (
        state::frame(
            memory,
            state::FRAMES,
            state::number(memory, state::UFRAME_NUM),
        ),
        state::frame(
            memory,
            state::TOOLS,
            state::number(memory, state::UTOOL_NUM),
        ),
    )
}

/// The target of a goal.
///
/// An offset moves the target in the user frame (`offset * target`), a tool offset in the tool frame
/// (`target * offset`); offsets of joint angles are added to joint angles.
pub(super) fn resolve(
    memory: &Memory,
    system: &dyn System,
    goal: &Goal<'_>,
) -> Result<MoveTarget, RaisedError> {
    check_frames(memory, goal)?;
    if !goal.position.is_complete() {
        return Err(uninitialized(goal.name));
    }
    let coupled = state::is_coupled(memory);
    let count = system.joints().len();
    let (base_from_frame, flange_from_tcp) = frames(memory);
    let mut position = goal.position.clone();
    if goal.is_incremental {
        let planned = system.planned_joints();
        if position.is_joint {
            for (value, now) in position
                .values
                .iter_mut()
                .zip(shown_from_arm(&planned, coupled))
            {
                *value += now;
            }
        } else {
            let now = base_from_frame.inverse() * system.forward(&planned) * flange_from_tcp;
            let step = position.pose();
            let mut sum = Pose::from_parts(now.translation, step.rotation * now.rotation);
            sum.translation.vector += step.translation.vector;
            position = Position::from_pose(&sum);
        }
    }
    if position.is_joint {
        if let Some((offset, _)) = goal.offset.as_ref().filter(|(offset, _)| offset.is_joint) {
            for (value, more) in position.values.iter_mut().zip(offset.values) {
                *value += more;
            }
        }
        let joints = arm_from_shown(&position.values, count, coupled);
        let is_moved = goal
            .offset
            .as_ref()
            .is_some_and(|(offset, _)| !offset.is_joint)
            || goal.tool_offset.is_some();
        if !is_moved {
            return Ok(MoveTarget::Joints(joints));
        }
        let base_from_tcp = system.forward(&joints) * flange_from_tcp;
        position = Position::from_pose(&(base_from_frame.inverse() * base_from_tcp));
    } else if goal
        .offset
        .as_ref()
        .is_some_and(|(offset, _)| offset.is_joint)
    {
        return Err(mismatch(format!(
            "{} is Cartesian, its offset holds joint angles",
            goal.name
        )));
    }
    let mut base_from_tcp = base_from_frame * position.pose();
    if let Some((offset, frame)) = goal.offset.as_ref().filter(|(offset, _)| !offset.is_joint) {
        let base_from_offset = match frame {
            Some(number) => state::frame(memory, state::FRAMES, *number),
            None => base_from_frame,
        };
        base_from_tcp =
            base_from_offset * offset.pose() * base_from_offset.inverse() * base_from_tcp;
    }
    if let Some(offset) = &goal.tool_offset {
        if offset.is_joint {
            return Err(mismatch(
                "a tool offset is Cartesian, the register holds joint angles",
            ));
        }
        base_from_tcp *= offset.pose();
    }
    Ok(MoveTarget::Tcp(base_from_tcp))
}
