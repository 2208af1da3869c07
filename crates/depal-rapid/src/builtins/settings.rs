//! What holds for the moves that follow: accelerations, speeds, arm configuration.

use depal_frames::Point;
use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::table::Entry;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 13] = [
    (
        "PROC AccSet(num Acc, num Ramp \\num FinePointRamp)",
        acc_set,
    ),
    ("PROC VelSet(num Override, num Max)", vel_set),
    ("PROC SpeedRefresh(num Override)", speed_refresh),
    ("FUNC num CSpeedOverride(\\switch CTask)", speed_override),
    ("FUNC num MaxRobSpeed()", highest_speed),
    ("PROC ConfJ(\\switch On | switch Off)", conf_j),
    ("PROC ConfL(\\switch On | switch Off)", conf_l),
    (
        "PROC SingArea(\\switch Wrist | switch LockAxis4 | switch Off)",
        sing_area,
    ),
    ("PROC GripLoad(loaddata Load)", grip_load),
    (
        "PROC PathAccLim(bool AccLim \\num AccMax, bool DecelLim \\num DecelMax)",
        path_acc_lim,
    ),
    ("PROC PathResol(num Value)", accepted),
    (
        "PROC CirPathMode(\\switch PathFrame | switch ObjectFrame | switch CirPointOri | switch Wrist45 | switch Wrist46 | switch Wrist56)",
        circular_mode,
    ),
    (
        "PROC MotionSup(\\switch On | switch Off \\num TuneValue)",
        motion_sup,
    ),
];

/// A modal setting, or its value at the start of the program.
pub(super) fn modal(context: &CallContext<'_>, name: &'static str, initial: f64) -> f64 {
    context.memory.modal.get(name).copied().unwrap_or(initial)
}

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
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

/// The override of the operator's speed: for the moves from here on; those in the queue keep theirs.
fn speed_refresh(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let percent = context.number(0)?;
    if !(0.0..=100.0).contains(&percent) {
        return Err(crate::errors::error(
            "ERR_SPEED_REFRESH_LIM",
            format!("SpeedRefresh takes 0 to 100 %, found {percent}"),
        ));
    }
    // At 0 % a cabinet creeps at 1 %.
    context
        .memory
        .modal
        .insert("override_percent", percent.max(1.0));
    done()
}

fn speed_override(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    let percent = modal(context, "override_percent", 100.0);
    Ok(Outcome::Done(Value::Num(percent as f32)))
}

/// Of the predefined vmax, mm/s.
fn highest_speed(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Done(Value::Num(7000.0)))
}

/// On, also without a switch and before either was called: the configuration data of the target must be reached, or the move is an error.
/// Off: the solution nearest to where the arm is.
fn configuration(context: &mut CallContext<'_>, name: &'static str) -> Ran {
    let on = f64::from(u8::from(!context.is_given(1)));
    context.memory.modal.insert(name, on);
    done()
}

fn conf_j(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    configuration(context, "configuration_joint")
}

fn conf_l(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    configuration(context, "configuration_linear")
}

/// Off and \Wrist are accepted: near a singularity a line is an error that names the joint that would jump.
fn sing_area(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    if context.is_given(1) {
        return Err(context.argument_error("SingArea \\LockAxis4 is not simulated"));
    }
    done()
}

/// The load on top of that of the tool. Mass and centre of mass count; axes and moments of inertia do not.
fn grip_load(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let load = context.required(0)?;
    let mass = super::records::number(load, 0);
    let centre_mm = super::records::vector(super::records::part(load, 1));
    if mass < 0.0 {
        return Err(context.argument_error(format!("the load weighs {mass} kg")));
    }
    let centre = Point::from(centre_mm * 1e-3);
    let modal = &mut context.memory.modal;
    modal.insert("load_kg", mass);
    modal.insert("load_x_m", centre.x);
    modal.insert("load_y_m", centre.y);
    modal.insert("load_z_m", centre.z);
    system.set_payload(mass, centre);
    done()
}

/// The load that `GripLoad` told last: mass, kg, and its centre, m in the tool frame.
pub(super) fn payload(context: &CallContext<'_>) -> (f64, Point) {
    let of = |name| modal(context, name, 0.0);
    (
        of("load_kg"),
        Point::new(of("load_x_m"), of("load_y_m"), of("load_z_m")),
    )
}

/// A limit of the acceleration along the path acts as the same share of the joint limits, with 10 m/s2 for 100 %:
/// the motion model limits joints, not the path.
fn path_acc_lim(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    const FULL_M_S2: f64 = 10.0;
    let mut percent = 100.0_f64;
    for index in [0, 2] {
        if context.required(index)? == &Value::Bool(true) {
            let most = context.optional_number(index + 1)?.unwrap_or(0.0);
            if most < 0.1 {
                return Err(context.argument_error(format!(
                    "PathAccLim: the limit is {most} m/s2, expected at least 0.1"
                )));
            }
            percent = percent.min(100.0 * most / FULL_M_S2);
        }
    }
    context
        .memory
        .modal
        .insert("path_acceleration_percent", percent);
    done()
}

/// Accepted, without effect on the motion model.
fn accepted(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    done()
}

/// The orientation turns evenly from start to end, as with \\ObjectFrame.
fn circular_mode(context: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    if (2..=5).any(|index| context.is_given(index)) {
        return Err(context.argument_error(
            "CirPathMode: only \\PathFrame and \\ObjectFrame are simulated, both as \\ObjectFrame",
        ));
    }
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
