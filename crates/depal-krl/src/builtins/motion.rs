//! Moves: their targets and settings, and how far the program runs ahead of the arm.

use std::task::Poll;

use depal_frames::{JointPositions, Point, Pose};
use depal_vm::system::{
    MoveId, MoveKind, MoveRequest, MoveSpeed, MoveTarget, MoveZone, System, path_length,
};
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::frames::*;
use super::move_form::{MoveForm, PathShape};
use super::path::{arc_end, path_events};
use super::state::*;
use super::table::{Operator, Ran};

pub(super) const OPERATORS: [Operator; 2] = [("move", movement), ("advance stop", advance_stop)];

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}

/// Waits until the arm stands at the end of the moves of this level.
fn advance_stop(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if is_submit(context) {
        return done();
    }
    let level = level(context);
    if level == 0 && system.is_standing() {
        // A move that failed is told here too.
        moves_under_way(context, system)?;
        forget_moves(context, 0);
    } else if moves_under_way(context, system)? > 0 || level == 0 {
        return Ok(Outcome::Blocked);
    }
    super::path::events_without_a_move(context, system)?;
    done()
}

/// The program may be `$ADVANCE` moves ahead of the one under way. With 0 it waits for the end of each.
fn movement(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    if is_submit(context) {
        return Err(context.argument_error("a submit program cannot move the arm"));
    }
    let advance = setting(context, "$advance", &[])?.clamp(0.0, 5.0) as usize;
    if let Some(Value::Int(id)) = context.notes.first() {
        let id = MoveId(*id as u64);
        return match system.is_move_done(id) {
            Ok(true) => done(),
            Ok(false) => Ok(Outcome::Blocked),
            Err(fault) => Err(context.system_fault(fault)),
        };
    }
    if path_state(context) == PathState::Held && level(context) > 0 {
        // Other moves while the path is held: it is put aside.
        match system.store_path() {
            Poll::Pending => return Ok(Outcome::Blocked),
            Poll::Ready(Ok(())) => set_path_state(context, PathState::Aside),
            Poll::Ready(Err(fault)) => return Err(context.system_fault(fault)),
        }
    }
    if moves_under_way(context, system)? > advance {
        return Ok(Outcome::Blocked);
    }
    let form = MoveForm::decode(context.number(3)? as i64);
    let mut request = request(context, system, form)?;
    if advance == 0 {
        request.zone = MoveZone::Fine;
    }
    let events = path_events(context)?;
    system.set_tool_load(load_at_flange(context));
    let id = match system.start_move_with_events(&request, &events) {
        Poll::Pending => return Ok(Outcome::Blocked),
        Poll::Ready(Ok(id)) => id,
        Poll::Ready(Err(fault)) => return Err(context.system_fault(fault)),
    };
    super::path::calls_along(context, id);
    note_move(context, id);
    if advance == 0 {
        context.notes.push(Value::Int(id.0 as i64));
        return Ok(Outcome::Blocked);
    }
    done()
}

/// Where the next move starts, in `$BASE`.
fn planned(context: &CallContext<'_>, system: &dyn System) -> Result<Pose, RaisedError> {
    let base_from_tcp = system.forward(&system.planned_joints()) * tool(context)?;
    Ok(base(context)?.inverse() * base_from_tcp)
}

/// `base_from_tcp` of a point; components that are not given stay as they are.
fn cartesian(
    context: &CallContext<'_>,
    system: &dyn System,
    point: &Value,
    form: MoveForm,
) -> Result<Pose, RaisedError> {
    refuse_external(context, point, false)?;
    let given = pose_parts(point);
    if given.iter().flatten().any(|v| !v.is_finite()) {
        return Err(context.argument_error("a component of the position is no number"));
    }
    let object_from_tcp = if !form.relative && given.iter().all(Option::is_some) {
        pose_from_parts(given.map(|v| v.unwrap_or(0.0)))
    } else {
        let start = planned(context, system)?;
        let before = parts_of_pose(&start);
        if form.relative && form.in_tool {
            start * pose_from_parts(given.map(|v| v.unwrap_or(0.0)))
        } else {
            pose_from_parts(std::array::from_fn(|i| match given[i] {
                Some(value) if form.relative => before[i] + value,
                Some(value) => value,
                None => before[i],
            }))
        }
    };
    Ok(base(context)? * object_from_tcp)
}

/// Joints of an E6AXIS; angles that are not given stay as they are.
fn joints(
    context: &CallContext<'_>,
    system: &dyn System,
    point: &Value,
    form: MoveForm,
) -> Result<JointPositions, RaisedError> {
    refuse_external(context, point, true)?;
    let start = system.planned_joints();
    let before = axes_of_joints(&start);
    let given = axis_parts(point);
    let axes = std::array::from_fn(|i| match given[i] {
        Some(value) if form.relative => before[i] + value,
        Some(value) => value,
        None => before[i],
    });
    if axes.iter().any(|v: &f64| !v.is_finite()) {
        return Err(context.argument_error("an axis angle is no number"));
    }
    Ok(joints_of_axes(&axes, start.len()))
}

/// Among the solutions the one with the status and turn of a point, as far as asking near it finds one;
/// `None` if the nearest will do.
///
/// Bit 2 of the status (sign of A5) and the bits of the turn for A4 to A6 are looked at; the others choose the
/// shoulder and the elbow, which stay as they are.
fn chosen_branch(
    system: &dyn System,
    point: &Value,
    base_from_tcp: &Pose,
    flange_from_tcp: &Pose,
) -> Option<JointPositions> {
    let Value::Record(parts) = point else {
        return None;
    };
    let bits = |i: usize| match parts.get(i) {
        Some(Value::Int(bits)) => Some(*bits),
        _ => None,
    };
    let (wanted_status, wanted_turn) = (bits(6), bits(7));
    if wanted_status.is_none() && wanted_turn.is_none() {
        return None;
    }
    let start = system.planned_joints();
    if start.len() < 6 {
        return None;
    }
    let base_from_flange = base_from_tcp * flange_from_tcp.inverse();
    let fits = |joints: &JointPositions| {
        let axes = axes_of_joints(joints);
        wanted_status.is_none_or(|wanted| wanted & 4 == status(&axes) & 4)
            && wanted_turn.is_none_or(|wanted| wanted & 0x38 == turn(&axes) & 0x38)
    };
    let nearest = system.inverse(&base_from_flange, &start).ok()?;
    if fits(&nearest) {
        return None;
    }
    let half = std::f64::consts::PI;
    for flip in [false, true] {
        for turn_4 in [0.0, half, -half] {
            for turn_6 in [0.0, half, -half, 2.0 * half, -2.0 * half] {
                let mut near = start;
                if flip {
                    near[4] = -near[4];
                }
                near[3] += turn_4;
                near[5] += turn_6;
                if let Ok(found) = system.inverse(&base_from_flange, &near)
                    && fits(&found)
                {
                    return Some(found);
                }
            }
        }
    }
    None
}

fn request(
    context: &CallContext<'_>,
    system: &dyn System,
    form: MoveForm,
) -> Result<MoveRequest, RaisedError> {
    let flange_from_tcp = tool(context)?;
    let point = context.required(0)?;
    let target = match form.shape {
        PathShape::Joint if form.axes => MoveTarget::Joints(joints(context, system, point, form)?),
        PathShape::Joint => {
            let to = cartesian(context, system, point, form)?;
            match chosen_branch(system, point, &to, &flange_from_tcp) {
                Some(joints) => MoveTarget::Joints(joints),
                None => MoveTarget::Tcp(to),
            }
        }
        PathShape::Line => MoveTarget::Tcp(cartesian(context, system, point, form)?),
        PathShape::Arc => {
            let via = cartesian(context, system, point, form)?;
            let end = cartesian(context, system, context.required(1)?, form)?;
            let start = system.forward(&system.planned_joints()) * flange_from_tcp;
            let angle = context.optional_number(2)?;
            arc(context, &start, &via, &end, angle)?
        }
    };
    let way = path_length(system, &target, &flange_from_tcp);
    Ok(MoveRequest {
        kind: match form.shape {
            PathShape::Joint => MoveKind::Joint,
            _ => MoveKind::Linear,
        },
        target,
        speed: speed(context, form)?,
        zone: zone(context, form, way)?,
        flange_from_tcp,
        configuration: None,
        location: context.location.clone(),
    })
}

fn arc(
    context: &CallContext<'_>,
    start: &Pose,
    via: &Pose,
    end: &Pose,
    angle: Option<f64>,
) -> Result<MoveTarget, RaisedError> {
    let Some(degrees) = angle else {
        return Ok(MoveTarget::Arc {
            through: Point::from(via.translation.vector),
            to: *end,
        });
    };
    if degrees == 0.0 || degrees.abs() >= 360.0 {
        return Err(context.argument_error(format!(
            "the angle of the arc is {degrees} degrees; less than a full circle is simulated"
        )));
    }
    let points = [start, via, end].map(|p| p.translation.vector);
    match arc_end(points, degrees.to_radians()) {
        Some([through, to]) => {
            let to = Pose::from_parts(to.into(), end.rotation);
            let through = Point::from(through);
            Ok(MoveTarget::Arc { through, to })
        }
        None => Err(context.argument_error("the three points of the arc lie on a line")),
    }
}

/// The least of the first six elements, as a share of 1.
fn least_percent(context: &CallContext<'_>, name: &str) -> Result<f64, RaisedError> {
    let mut least = 100.0f64;
    for axis in 0..6 {
        least = least.min(setting(context, name, &[axis])?);
    }
    if least <= 0.0 {
        return Err(context.argument_error(format!(
            "{} is {least} %, expected more than 0",
            name.to_uppercase()
        )));
    }
    Ok(least / 100.0)
}

/// High enough that only the joints limit a joint move.
const UNLIMITED: f64 = 100.0;

fn speed(context: &CallContext<'_>, form: MoveForm) -> Result<MoveSpeed, RaisedError> {
    let share = setting(context, "$ov_pro", &[])?.clamp(0.0, 100.0) / 100.0;
    if share == 0.0 {
        return Err(context.argument_error("$OV_PRO is 0: the arm would never arrive"));
    }
    if form.shape == PathShape::Joint {
        return Ok(MoveSpeed {
            tcp: UNLIMITED,
            orientation: UNLIMITED,
            joint_fraction: least_percent(context, "$vel_axis")? * share,
            acceleration_fraction: least_percent(context, "$acc_axis")?,
        });
    }
    let velocity = setting(context, "$vel", &[0])?;
    let turn = setting(context, "$vel", &[1])?.min(setting(context, "$vel", &[2])?);
    let acceleration = setting(context, "$acc", &[0])? / setting(context, "$acc_ma", &[0])?;
    for (value, name) in [
        (velocity, "$VEL.CP"),
        (turn, "$VEL.ORI1 or ORI2"),
        (acceleration, "$ACC.CP"),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(context.argument_error(format!("{name} must be above 0")));
        }
    }
    Ok(MoveSpeed {
        tcp: velocity.min(setting(context, "$vel_ma", &[0])?) * share,
        orientation: turn.to_radians() * share,
        joint_fraction: share,
        acceleration_fraction: acceleration.min(1.0),
    })
}

/// How far before its end the path may leave, from the settings of `$APO`: CVEL, CPTP, CDIS, CORI.
fn zone(context: &CallContext<'_>, form: MoveForm, way: f64) -> Result<MoveZone, RaisedError> {
    if !form.is_approximated() {
        return Ok(MoveZone::Fine);
    }
    let apo = |part: usize| setting(context, "$apo", &[part]);
    let half = way / 2.0;
    let mut tcp = f64::INFINITY;
    let mut orientation = f64::INFINITY;
    if form.c_ptp {
        tcp = tcp.min(half * apo(1)?.clamp(0.0, 100.0) / 100.0);
    }
    if form.c_dis {
        tcp = tcp.min(apo(2)?.max(0.0) * 1e-3);
    }
    if form.c_ori {
        orientation = apo(3)?.max(0.0).to_radians();
        tcp = tcp.min(half);
    }
    if form.c_vel {
        // Where braking for the end brings the speed down to that share.
        let speed = setting(context, "$vel", &[0])? * apo(0)?.clamp(0.0, 100.0) / 100.0;
        let braking = setting(context, "$acc", &[0])?.max(1e-6);
        tcp = tcp.min(speed * speed / (2.0 * braking));
    }
    let tcp = tcp.min(half);
    if tcp <= 0.0 || orientation <= 0.0 {
        return Ok(MoveZone::Fine);
    }
    Ok(MoveZone::Fly {
        tcp,
        orientation: orientation.min(std::f64::consts::PI),
    })
}
