use std::task::Poll;

use depal_frames::Pose;
use depal_vm::system::{MoveId, MoveKind, MoveRequest, MoveSpeed, MoveTarget, MoveZone, System};
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::records::*;
use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 17] = [
    (
        "PROC MoveAbsJ(\\switch Conc, jointtarget ToJointPos \\num ID \\switch NoEOffs, speeddata Speed \\num V, zonedata Zone \\num Z, tooldata Tool \\wobjdata WObj \\loaddata TLoad)",
        move_abs_j,
    ),
    (
        "PROC MoveJ(\\switch Conc, robtarget ToPoint \\num ID, speeddata Speed \\num V, zonedata Zone \\num Z, tooldata Tool \\wobjdata WObj \\loaddata TLoad)",
        move_j,
    ),
    (
        "PROC MoveL(\\switch Conc, robtarget ToPoint \\num ID, speeddata Speed \\num V, zonedata Zone \\num Z, tooldata Tool \\wobjdata WObj \\switch Corr \\loaddata TLoad)",
        move_l,
    ),
    (
        "PROC AccSet(num Acc, num Ramp \\num FinePointRamp)",
        acc_set,
    ),
    ("PROC VelSet(num Override, num Max)", vel_set),
    ("PROC ConfJ(\\switch On | switch Off)", configuration),
    ("PROC ConfL(\\switch On | switch Off)", configuration),
    (
        "PROC SingArea(\\switch Wrist | switch LockAxis4 | switch Off)",
        accepted,
    ),
    ("PROC GripLoad(loaddata Load)", accepted),
    (
        "PROC MotionSup(\\switch On | switch Off \\num TuneValue)",
        motion_sup,
    ),
    ("PROC WaitRob(\\switch InPos | switch ZeroSpeed)", wait_rob),
    ("PROC Stop(\\switch NoRegain | switch AllMoveTasks)", stop),
    ("PROC ExitCycle()", exit_cycle),
    (
        "FUNC robtarget CRobT(\\string TaskName \\tooldata Tool \\wobjdata WObj)",
        c_rob_t,
    ),
    ("FUNC jointtarget CJointT(\\string TaskName)", c_joint_t),
    (
        "FUNC robtarget CalcRobT(jointtarget Joint_target, tooldata Tool \\wobjdata WObj)",
        calc_rob_t,
    ),
    (
        "FUNC jointtarget CalcJointT(\\switch UseCurWObjPos, robtarget Rob_target, tooldata Tool \\wobjdata WObj)",
        calc_joint_t,
    ),
];

/// The arguments that all moves share, by position from `first`: speed, \V, zone, \Z, tool.
fn request(
    context: &CallContext<'_>,
    kind: MoveKind,
    target: MoveTarget,
    flange_from_tcp: Pose,
    speed: usize,
) -> Result<MoveRequest, RaisedError> {
    let speed_data = context.required(speed)?;
    let zone_data = context.required(speed + 2)?;
    let tcp_mm_s = match context.optional_number(speed + 1)? {
        Some(v) => v,
        None => number(speed_data, 0),
    };
    let orientation = number(speed_data, 1).to_radians();
    if tcp_mm_s <= 0.0 || orientation <= 0.0 {
        return Err(context.argument_error(format!(
            "the speed must be above 0: {tcp_mm_s} mm/s, {} degrees/s",
            number(speed_data, 1)
        )));
    }
    let modal =
        |name: &str, default: f64| context.memory.modal.get(name).copied().unwrap_or(default);
    let share = modal("velocity_percent", 100.0) / 100.0;
    let most_mm_s = modal("velocity_limit_mm_s", f64::INFINITY);
    let zone = if part(zone_data, 0) == &Value::Bool(true) {
        MoveZone::Fine
    } else {
        let tcp = match context.optional_number(speed + 3)? {
            Some(mm) => mm,
            None => number(zone_data, 1),
        };
        MoveZone::Fly {
            tcp: tcp.max(0.0) * 1e-3,
            orientation: number(zone_data, 4).max(0.0).to_radians(),
        }
    };
    Ok(MoveRequest {
        kind,
        target,
        speed: MoveSpeed {
            tcp: (tcp_mm_s * share).min(most_mm_s) * 1e-3,
            orientation: orientation * share,
            joint_fraction: 1.0,
            acceleration_fraction: modal("acceleration_percent", 100.0) / 100.0,
        },
        zone,
        flange_from_tcp,
        location: context.location.clone(),
    })
}

/// Queues the move; waits for the arm to stand there if it ends in a fine point.
/// The first note is the move once it is queued.
fn perform(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    make: impl Fn(&CallContext<'_>, &dyn System) -> Result<MoveRequest, RaisedError>,
) -> Ran {
    if context.notes.is_empty() {
        let request = make(context, system)?;
        let id = match system.start_move(&request) {
            Poll::Pending => return Ok(Outcome::Blocked),
            Poll::Ready(Ok(id)) => id,
            Poll::Ready(Err(fault)) => return Err(context.system_fault(fault)),
        };
        if request.zone != MoveZone::Fine {
            return Ok(Outcome::Done(Value::Absent));
        }
        context.notes.push(Value::Int(id.0 as i64));
    }
    let Some(Value::Int(id)) = context.notes.first() else {
        return Ok(Outcome::Done(Value::Absent));
    };
    match system.is_move_done(MoveId(*id as u64)) {
        Ok(true) => Ok(Outcome::Done(Value::Absent)),
        Ok(false) => Ok(Outcome::Blocked),
        Err(fault) => Err(context.system_fault(fault)),
    }
}

fn refuse_conc(context: &CallContext<'_>) -> Result<(), RaisedError> {
    if context.is_given(0) {
        return Err(context.argument_error("\\Conc is not simulated"));
    }
    Ok(())
}

fn move_abs_j(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    perform(context, system, |context, system| {
        refuse_conc(context)?;
        let target = joints(context.required(1)?, system.joints().len())?;
        let tool = tool(context.required(8)?)?;
        request(
            context,
            MoveKind::Joint,
            MoveTarget::Joints(target),
            tool,
            4,
        )
    })
}

fn cartesian(context: &CallContext<'_>, kind: MoveKind) -> Result<MoveRequest, RaisedError> {
    refuse_conc(context)?;
    let target = context.required(1)?;
    let base_from_object = work_object(context.value(8)?)?;
    let object_from_tcp = pose_of(part(target, 0), part(target, 1))?;
    let tool = tool(context.required(7)?)?;
    let target = MoveTarget::Tcp(base_from_object * object_from_tcp);
    request(context, kind, target, tool, 3)
}

fn move_j(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    perform(context, system, |context, _| {
        cartesian(context, MoveKind::Joint)
    })
}

fn move_l(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    perform(context, system, |context, _| {
        if context.is_given(9) {
            return Err(context.argument_error("\\Corr is not simulated"));
        }
        cartesian(context, MoveKind::Linear)
    })
}

fn acc_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    // Values below 20 % act as 20 %; the ramp (jerk) has no counterpart in the motion model.
    let percent = context.number(0)?.clamp(20.0, 100.0);
    context.memory.modal.insert("acceleration_percent", percent);
    done()
}

fn vel_set(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let percent = context.number(0)?;
    let limit = context.number(1)?;
    if !(0.0..=100.0).contains(&percent) || percent == 0.0 || limit <= 0.0 {
        return Err(context.argument_error(format!(
            "VelSet takes 1 to 100 % and a limit above 0 mm/s, found {percent} and {limit}"
        )));
    }
    context.memory.modal.insert("velocity_percent", percent);
    context.memory.modal.insert("velocity_limit_mm_s", limit);
    done()
}

/// ConfJ, ConfL: accepted; the nearest inverse solution is taken with On as with Off.
fn configuration(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    done()
}

/// SingArea, GripLoad: accepted, without effect on the motion model.
fn accepted(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    done()
}

fn motion_sup(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    if context.is_given(1) {
        return Err(context.argument_error(
            "MotionSup \\Off: the motion supervision of the simulated cabinet is always on",
        ));
    }
    done()
}

fn wait_rob(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if system.is_standing() {
        done()
    } else {
        Ok(Outcome::Blocked)
    }
}

/// The moves that are queued end first, as at a stop point.
fn stop(_: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if system.is_standing() {
        Ok(Outcome::Stop("Stop".into()))
    } else {
        Ok(Outcome::Blocked)
    }
}

fn exit_cycle(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Restart)
}

/// Tool and work object of a function; what stands for them on the controller are those of the last move.
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

fn calc_joint_t(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let target = context.required(1)?;
    let object_from_tcp = pose_of(part(target, 0), part(target, 1))?;
    let base_from_object = work_object(context.value(3)?)?;
    let flange_from_tcp = tool(context.required(2)?)?;
    let base_from_flange = base_from_object * object_from_tcp * flange_from_tcp.inverse();
    let near = system.planned_joints();
    match system.inverse(&base_from_flange, &near) {
        Ok(joints) => Ok(Outcome::Done(joint_target(&joints))),
        Err(fault) => match context.system_fault(fault) {
            raised if raised.name == "ERR_ROBLIMIT" => Err(raised),
            other => Err(error("ERR_ROBLIMIT", other.message)),
        },
    }
}

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}
