//! Moves: their arguments, and how a program waits for them.

use std::task::Poll;

use depal_frames::{Point, Pose};
use depal_vm::system::{
    MoveId, MoveKind, MoveRequest, MoveSpeed, MoveTarget, MoveZone, PathAction, PathEvent,
    PathPlace, System, path_length,
};
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::records::*;
use super::settings::{modal, payload};
use super::table::Entry;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 7] = [
    (
        "PROC MoveAbsJ(\\switch Conc, jointtarget ToJointPos \\num ID \\switch NoEOffs, speeddata Speed \\num V | num T, zonedata Zone \\num Z \\stoppointdata Inpos, tooldata Tool \\wobjdata WObj \\loaddata TLoad)",
        move_abs_j,
    ),
    (
        "PROC MoveJ(\\switch Conc, robtarget ToPoint \\num ID, speeddata Speed \\num V | num T, zonedata Zone \\num Z \\stoppointdata Inpos, tooldata Tool \\wobjdata WObj \\loaddata TLoad)",
        move_j,
    ),
    (
        "PROC MoveL(\\switch Conc, robtarget ToPoint \\num ID, speeddata Speed \\num V | num T, zonedata Zone \\num Z \\stoppointdata Inpos, tooldata Tool \\wobjdata WObj \\switch Corr \\loaddata TLoad)",
        move_l,
    ),
    (
        "PROC MoveC(\\switch Conc, robtarget CirPoint, robtarget ToPoint \\num ID, speeddata Speed \\num V | num T, zonedata Zone \\num Z \\stoppointdata Inpos, tooldata Tool \\wobjdata WObj \\switch Corr \\loaddata TLoad)",
        move_c,
    ),
    (
        "PROC MoveJDO(robtarget ToPoint \\num ID, speeddata Speed \\num T, zonedata Zone, tooldata Tool \\wobjdata WObj, signaldo Signal, num Value \\loaddata TLoad)",
        move_j_do,
    ),
    (
        "PROC MoveLDO(robtarget ToPoint \\num ID, speeddata Speed \\num T, zonedata Zone, tooldata Tool \\wobjdata WObj, signaldo Signal, num Value \\switch Corr \\loaddata TLoad)",
        move_l_do,
    ),
    (
        "PROC MoveCDO(robtarget CirPoint, robtarget ToPoint \\num ID, speeddata Speed \\num T, zonedata Zone, tooldata Tool \\wobjdata WObj, signaldo Signal, num Value \\switch Corr \\loaddata TLoad)",
        move_c_do,
    ),
];

/// Where the arguments of a move stand in its heading.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    pub conc: Option<usize>,
    pub via: Option<usize>,
    pub target: usize,
    pub speed: usize,
    pub v: Option<usize>,
    pub t: Option<usize>,
    /// None: the move ends in a stop point.
    pub zone: Option<usize>,
    pub z: Option<usize>,
    pub in_position: Option<usize>,
    pub tool: usize,
    pub work_object: usize,
    pub correction: Option<usize>,
    /// `\TLoad`: tool and payload together.
    pub total_load: usize,
}

impl Places {
    /// `target \ID, Speed \V | T, Zone \Z \Inpos, Tool \WObj \Corr` with the target at an index.
    const fn full(via: Option<usize>, target: usize) -> Self {
        Self {
            conc: Some(0),
            via,
            target,
            speed: target + 2,
            v: Some(target + 3),
            t: Some(target + 4),
            zone: Some(target + 5),
            z: Some(target + 6),
            in_position: Some(target + 7),
            tool: target + 8,
            work_object: target + 9,
            correction: Some(target + 10),
            total_load: target + 11,
        }
    }

    /// `target \ID, Speed \T, Zone, Tool \WObj, Signal, Value \Corr` with the target at an index.
    const fn with_output(via: Option<usize>, target: usize, correction: bool) -> Self {
        Self {
            conc: None,
            via,
            target,
            speed: target + 2,
            v: None,
            t: Some(target + 3),
            zone: Some(target + 4),
            z: None,
            in_position: None,
            tool: target + 5,
            work_object: target + 6,
            correction: if correction { Some(target + 9) } else { None },
            total_load: target + 9 + correction as usize,
        }
    }
}

/// A move as its instruction asks for it.
pub(super) struct Asked {
    pub request: MoveRequest,
    pub along: Vec<PathEvent>,
    /// Seconds to stand at the stop point (`\Inpos` with a stop time).
    pub stand: f64,
    /// Go on without waiting for the stop point.
    pub concurrent: bool,
    /// Mass of the tool in use, kg, and its centre, m in the flange frame.
    pub tool_load: (f64, Point),
    /// The same of tool and payload together, for this move alone; none: tool and `GripLoad` count.
    pub total_load: Option<(f64, Point)>,
}

/// `base_from_tcp` of a robtarget.
pub(super) fn base_from_tcp(
    context: &CallContext<'_>,
    target: usize,
    work_object_at: usize,
) -> Result<Pose, RaisedError> {
    let base_from_object = work_object(context.value(work_object_at)?)?;
    let target = context.required(target)?;
    Ok(base_from_object * pose_of(part(target, 0), part(target, 1))?)
}

/// The move to a robtarget.
pub(super) fn cartesian(
    context: &CallContext<'_>,
    system: &dyn System,
    kind: MoveKind,
    places: &Places,
) -> Result<Asked, RaisedError> {
    if places.correction.is_some_and(|i| context.is_given(i)) {
        return Err(context.argument_error("\\Corr (path corrections) is not simulated"));
    }
    let to = base_from_tcp(context, places.target, places.work_object)?;
    let target = match places.via {
        None => MoveTarget::Tcp(to),
        Some(via) => {
            let via = base_from_tcp(context, via, places.work_object)?;
            MoveTarget::Arc {
                through: Point::from(via.translation.vector),
                to,
            }
        }
    };
    let supervised = match kind {
        MoveKind::Joint => modal(context, "configuration_joint", 1.0),
        MoveKind::Linear => modal(context, "configuration_linear", 1.0),
    };
    let configuration = (supervised != 0.0).then(|| {
        let data = context.required(places.target).map(|t| part(t, 2).clone());
        let data = data.unwrap_or_default();
        [0, 1, 2].map(|i| number(&data, i) as i32)
    });
    asked(context, system, kind, target, configuration, places)
}

fn asked(
    context: &CallContext<'_>,
    system: &dyn System,
    kind: MoveKind,
    target: MoveTarget,
    configuration: Option<[i32; 3]>,
    places: &Places,
) -> Result<Asked, RaisedError> {
    let flange_from_tcp = tool(context.required(places.tool)?)?;
    let optional = |place: Option<usize>| match place {
        Some(index) => context.optional_number(index),
        None => Ok(None),
    };
    let speed_data = context.required(places.speed)?;
    let mut tcp_mm_s = optional(places.v)?.unwrap_or_else(|| number(speed_data, 0));
    let mut orientation = number(speed_data, 1).to_radians();
    if let Some(seconds) = optional(places.t)? {
        if seconds <= 0.0 {
            return Err(context.argument_error(format!("\\T is {seconds} s, expected more")));
        }
        // A time instead of a speed: the way in that time, the turn as fast as it has to be.
        tcp_mm_s = (path_length(system, &target, &flange_from_tcp) * 1e3 / seconds).max(0.1);
        orientation = std::f64::consts::TAU;
    }
    if tcp_mm_s <= 0.0 || orientation <= 0.0 {
        return Err(context.argument_error(format!(
            "the speed must be above 0: {tcp_mm_s} mm/s, {} degrees/s",
            number(speed_data, 1)
        )));
    }
    let share = modal(context, "velocity_percent", 100.0) / 100.0;
    let refreshed = modal(context, "override_percent", 100.0) / 100.0;
    let most_mm_s = modal(context, "velocity_limit_mm_s", f64::INFINITY);
    let acceleration = modal(context, "acceleration_percent", 100.0).min(modal(
        context,
        "path_acceleration_percent",
        100.0,
    ));
    let in_position = match places.in_position {
        Some(index) => super::records::optional(context, index)?,
        None => None,
    };
    let zone_data = match places.zone {
        Some(index) => context.required(index)?.clone(),
        None => Value::Absent,
    };
    let stops =
        places.zone.is_none() || in_position.is_some() || part(&zone_data, 0) == &Value::Bool(true);
    let zone = if stops {
        MoveZone::Fine
    } else {
        let tcp = optional(places.z)?.unwrap_or_else(|| number(&zone_data, 1));
        MoveZone::Fly {
            tcp: tcp.max(0.0) * 1e-3,
            orientation: number(&zone_data, 4).max(0.0).to_radians(),
        }
    };
    Ok(Asked {
        request: MoveRequest {
            kind,
            target,
            speed: MoveSpeed {
                tcp: (tcp_mm_s * share).min(most_mm_s) * refreshed * 1e-3,
                orientation: orientation * share * refreshed,
                joint_fraction: refreshed,
                acceleration_fraction: acceleration / 100.0,
            },
            zone,
            flange_from_tcp,
            configuration,
            location: context.location.clone(),
        },
        along: Vec::new(),
        // Kind 2 of stop point data is a time to stand.
        stand: in_position
            .filter(|data| number(data, 0) == 2.0)
            .map_or(0.0, |data| number(&data, 3)),
        concurrent: places.conc.is_some_and(|index| context.is_given(index)),
        tool_load: tool_load(context.required(places.tool)?),
        total_load: context.value(places.total_load)?.and_then(total_load),
    })
}

/// Queues the move; waits for the arm to stand there if it ends in a fine point.
/// The first note is the move once it is queued, the second the end of the time to stand.
pub(super) fn perform(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    make: impl Fn(&CallContext<'_>, &dyn System) -> Result<Asked, RaisedError>,
) -> Ran {
    let done = Ok(Outcome::Done(Value::Absent));
    if context.notes.is_empty() {
        let asked = make(context, system)?;
        system.set_tool_load(Some(asked.total_load.unwrap_or(asked.tool_load)));
        if asked.total_load.is_some() {
            system.set_payload(0.0, Point::origin());
        }
        let started = system.start_move_with_events(&asked.request, &asked.along);
        if asked.total_load.is_some() {
            let (mass, centre) = payload(context);
            system.set_payload(mass, centre);
        }
        let id = match started {
            Poll::Pending => return Ok(Outcome::Blocked),
            Poll::Ready(Ok(id)) => id,
            Poll::Ready(Err(fault)) => return Err(context.system_fault(fault)),
        };
        if asked.request.zone != MoveZone::Fine || asked.concurrent {
            return done;
        }
        context.notes.push(Value::Int(id.0 as i64));
        context.notes.push(Value::Dnum(asked.stand));
    }
    let (Some(Value::Int(id)), Some(Value::Dnum(stand))) =
        (context.notes.first(), context.notes.get(1))
    else {
        return done;
    };
    let (id, stand) = (MoveId(*id as u64), *stand);
    match system.is_move_done(id) {
        Ok(false) => Ok(Outcome::Blocked),
        Ok(true) if stand <= 0.0 => done,
        Ok(true) => {
            let now = system.now();
            match context.notes.get(2) {
                Some(Value::Int(since)) => {
                    let since = depal_time::SimTime::from_nanos(*since as u64);
                    if now.saturating_since(since).as_secs_f64() >= stand {
                        return done;
                    }
                }
                _ => context.notes.push(Value::Int(now.as_nanos() as i64)),
            }
            Ok(Outcome::Blocked)
        }
        Err(fault) => Err(context.system_fault(fault)),
    }
}

fn move_abs_j(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    // \NoEOffs stands between the target and the speed.
    const PLACES: Places = Places {
        target: 1,
        correction: None,
        total_load: 12,
        ..Places::full(None, 2)
    };
    perform(context, system, |context, system| {
        let target = joints(context.required(1)?, system.joints().len())?;
        let target = MoveTarget::Joints(target);
        asked(context, system, MoveKind::Joint, target, None, &PLACES)
    })
}

fn move_j(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const PLACES: Places = Places {
        correction: None,
        total_load: 11,
        ..Places::full(None, 1)
    };
    perform(context, system, |context, system| {
        cartesian(context, system, MoveKind::Joint, &PLACES)
    })
}

fn move_l(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const PLACES: Places = Places::full(None, 1);
    perform(context, system, |context, system| {
        cartesian(context, system, MoveKind::Linear, &PLACES)
    })
}

fn move_c(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const PLACES: Places = Places::full(Some(1), 2);
    perform(context, system, |context, system| {
        cartesian(context, system, MoveKind::Linear, &PLACES)
    })
}

/// A move that sets an output at its end: in the middle of the corner, or when the arm stands.
fn with_output(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    kind: MoveKind,
    places: &Places,
) -> Ran {
    perform(context, system, |context, system| {
        let mut asked = cartesian(context, system, kind, places)?;
        let signal = context.signal(places.work_object + 1)?;
        let value = context.number(places.work_object + 2)?;
        asked.along.push(PathEvent {
            place: PathPlace::BeforeEnd(0.0),
            lead: depal_time::SimDuration::ZERO,
            delay: depal_time::SimDuration::ZERO,
            action: PathAction::Set {
                signal,
                value: f64::from(u8::from(value != 0.0)),
            },
        });
        Ok(asked)
    })
}

fn move_j_do(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const PLACES: Places = Places::with_output(None, 0, false);
    with_output(context, system, MoveKind::Joint, &PLACES)
}

fn move_l_do(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const PLACES: Places = Places::with_output(None, 0, true);
    with_output(context, system, MoveKind::Linear, &PLACES)
}

fn move_c_do(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const PLACES: Places = Places::with_output(Some(0), 1, true);
    with_output(context, system, MoveKind::Linear, &PLACES)
}
