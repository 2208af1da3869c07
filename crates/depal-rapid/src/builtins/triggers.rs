//! Outputs that are set and interrupts that come at a place or a time on the way of a move.

use depal_time::SimDuration;
use depal_vm::system::{MoveKind, PathAction, PathEvent, PathPlace, Relation, SignalCheck, System};
use depal_vm::{CallContext, Outcome, RaisedError, Trigger, Value};

use super::interrupts::order;
use super::motion::{Places, cartesian, perform};
use super::records::{number, part};
use super::table::Entry;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 8] = [
    (
        "PROC TriggIO(INOUT triggdata TriggData, num Distance \\switch Start | switch Time \\signaldo DOp | signalgo GOp | signalao AOp, numeric SetValue \\num DODelay)",
        trigg_io,
    ),
    (
        "PROC TriggEquip(INOUT triggdata TriggData, num Distance \\switch Start, num EquipLag \\signaldo DOp | signalgo GOp | signalao AOp, numeric SetValue \\bool Inhib)",
        trigg_equip,
    ),
    (
        "PROC TriggInt(INOUT triggdata TriggData, num Distance \\switch Start | switch Time, INOUT intnum Interrupt)",
        trigg_int,
    ),
    (
        "PROC TriggCheckIO(INOUT triggdata TriggData, num Distance \\switch Start | switch Time, anysignal Signal, opnum Relation, numeric CheckValue \\switch StopMove, INOUT intnum Interrupt)",
        trigg_check_io,
    ),
    (
        "PROC TriggLIOs(\\switch Conc, robtarget ToPoint \\num ID, speeddata Speed \\num T \\INOUT triggios TriggData1{*} \\INOUT triggstrgo TriggData2{*} \\INOUT triggiosdnum TriggData3{*}, zonedata Zone \\stoppointdata Inpos, tooldata Tool \\wobjdata WObj \\switch Corr \\loaddata TLoad)",
        trigg_l_ios,
    ),
    (
        "PROC TriggL(\\switch Conc, robtarget ToPoint \\num ID, speeddata Speed \\num T, triggdata Trigg_1 \\triggdata T2 \\triggdata T3 \\triggdata T4 \\triggdata T5 \\triggdata T6 \\triggdata T7 \\triggdata T8, zonedata Zone \\stoppointdata Inpos, tooldata Tool \\wobjdata WObj \\switch Corr \\loaddata TLoad)",
        trigg_l,
    ),
    (
        "PROC TriggJ(\\switch Conc, robtarget ToPoint \\num ID, speeddata Speed \\num T, triggdata Trigg_1 \\triggdata T2 \\triggdata T3 \\triggdata T4 \\triggdata T5 \\triggdata T6 \\triggdata T7 \\triggdata T8, zonedata Zone \\stoppointdata Inpos, tooldata Tool \\wobjdata WObj \\loaddata TLoad)",
        trigg_j,
    ),
    (
        "PROC TriggC(\\switch Conc, robtarget CirPoint, robtarget ToPoint \\num ID, speeddata Speed \\num T, triggdata Trigg_1 \\triggdata T2 \\triggdata T3 \\triggdata T4 \\triggdata T5 \\triggdata T6 \\triggdata T7 \\triggdata T8, zonedata Zone \\stoppointdata Inpos, tooldata Tool \\wobjdata WObj \\switch Corr \\loaddata TLoad)",
        trigg_c,
    ),
];

/// What `triggdata` counts from.
const NOT_DEFINED: f64 = 0.0;
const BEFORE_END: f64 = 1.0;
const AFTER_START: f64 = 2.0;

/// The signal and the value of arguments `first` (three alternatives) and `first + 3`.
fn output(
    context: &CallContext<'_>,
    system: &dyn System,
    first: usize,
) -> Result<(String, f64), RaisedError> {
    let given = (first..first + 3).find(|index| context.is_given(*index));
    let Some(index) = given else {
        return Err(context.argument_error("one of \\DOp, \\GOp and \\AOp must be given"));
    };
    let signal = context.signal(index)?;
    // An unknown signal is told here, at the instruction that names it.
    system
        .signal(&signal)
        .map_err(|fault| context.system_fault(fault))?;
    let value = context.number(first + 3)?;
    let value = if index == first {
        f64::from(u8::from(value != 0.0))
    } else {
        value
    };
    Ok((signal, value))
}

/// The name of the notice that a move gives for an interrupt of a task.
fn notice(task: &str, interrupt: u32) -> String {
    format!("{task} {interrupt}")
}

fn store(
    context: &mut CallContext<'_>,
    (kind, distance_mm, lead_s, delay_s): (f64, f64, f64, f64),
    interrupt: u32,
    (signal, value): (String, f64),
) -> Ran {
    let mut fields: Vec<_> = [kind, distance_mm, lead_s, delay_s]
        .map(|v| Value::Num(v as f32))
        .into();
    fields.push(Value::Str(signal));
    fields.push(Value::Dnum(value));
    fields.push(Value::Num(interrupt as f32));
    fields.push(Value::Num(0.0));
    fields.push(Value::Bool(false));
    context.assign(0, Value::Record(fields))?;
    Ok(Outcome::Done(Value::Absent))
}

/// A distance before the end (or after the start), or a time before the end.
fn trigg_io(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let amount = context.number(1)?;
    let (start, time) = (context.is_given(2), context.is_given(3));
    let delay = context.optional_number(8)?.unwrap_or(0.0);
    if amount < 0.0 || delay < 0.0 {
        return Err(context.argument_error(format!(
            "TriggIO: distance or time {amount} and delay {delay} must not be below 0"
        )));
    }
    if time && amount > 0.5 {
        return Err(context.argument_error(format!(
            "TriggIO \\Time: {amount} s before the end, at most 0.5 s; take a distance"
        )));
    }
    let place = match (start, time) {
        (true, _) => (AFTER_START, amount, 0.0, delay),
        (_, true) => (BEFORE_END, 0.0, amount, delay),
        _ => (BEFORE_END, amount, 0.0, delay),
    };
    let output = output(context, system, 4)?;
    store(context, place, 0, output)
}

/// A distance, less the time that the equipment takes; a negative lag sets it later.
fn trigg_equip(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let distance = context.number(1)?;
    let lag = context.number(3)?;
    if distance < 0.0 || lag > 0.5 {
        return Err(context.argument_error(format!(
            "TriggEquip: distance {distance} mm must not be below 0, lag {lag} s not above 0.5"
        )));
    }
    let kind = if context.is_given(2) {
        AFTER_START
    } else {
        BEFORE_END
    };
    let output = output(context, system, 4)?;
    // With \\Inhib TRUE the output is set to 0 instead.
    let inhibited = context.value(8)? == Some(&Value::Bool(true));
    let output = (output.0, if inhibited { 0.0 } else { output.1 });
    store(
        context,
        (kind, distance, lag.max(0.0), (-lag).max(0.0)),
        0,
        output,
    )
}

/// Kind, distance, lead and delay of arguments 1 to 3.
fn interrupt_place(context: &CallContext<'_>) -> Result<(f64, f64, f64, f64), RaisedError> {
    let amount = context.number(1)?;
    let (start, time) = (context.is_given(2), context.is_given(3));
    if amount < 0.0 || (time && amount > 0.5) {
        return Err(context.argument_error(format!(
            "{amount}, expected a distance or a time not below 0, a time of at most 0.5 s"
        )));
    }
    Ok(match (start, time) {
        (true, _) => (AFTER_START, amount, 0.0, 0.0),
        (_, true) => (BEFORE_END, 0.0, amount, 0.0),
        _ => (BEFORE_END, amount, 0.0, 0.0),
    })
}

/// Orders the interrupt of an argument by a notice of its own; its number and the name of the notice.
fn order_notice(
    context: &mut CallContext<'_>,
    system: &dyn System,
    argument: usize,
) -> Result<(u32, String), RaisedError> {
    let number = context.number(argument)? as u32;
    let name = notice(&context.location.task, number);
    let last = system.notices(&name);
    let trigger = Trigger::Notice {
        name: name.clone(),
        last,
    };
    // The same interrupt may be tied to several places.
    let again = matches!(
        context.memory.interrupts.find(number).map(|i| &i.trigger),
        Some(Trigger::Notice { .. })
    );
    if !again {
        order(context, argument, false, trigger)?;
    }
    Ok((number, name))
}

/// As [`trigg_io`], but the place orders an interrupt.
fn trigg_int(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let place = interrupt_place(context)?;
    let (number, name) = order_notice(context, system, 4)?;
    store(context, place, number, (name, 0.0))
}

/// LT to GT.
const RELATIONS: [Relation; 6] = [
    Relation::Less,
    Relation::LessOrEqual,
    Relation::Equal,
    Relation::NotEqual,
    Relation::GreaterOrEqual,
    Relation::Greater,
];

/// As [`trigg_int`], but the interrupt comes only if a signal is not as it must be at the place.
fn trigg_check_io(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let place = interrupt_place(context)?;
    let signal = context.signal(4)?;
    system
        .signal(&signal)
        .map_err(|fault| context.system_fault(fault))?;
    let relation = context.number(5)?;
    if relation.fract() != 0.0 || !(1.0..=6.0).contains(&relation) {
        return Err(context.argument_error(format!(
            "the relation is {relation}, expected 1 (LT) to 6 (GT)"
        )));
    }
    let value = context.number(6)?;
    let stops = context.is_given(7);
    let (number, _) = order_notice(context, system, 8)?;
    store(context, place, number, (signal, value))?;
    let Value::Record(mut fields) = context.required(0)?.clone() else {
        return Err(context.argument_error("this is no triggdata"));
    };
    fields[7] = Value::Num(relation as f32);
    fields[8] = Value::Bool(stops);
    context.assign(0, Value::Record(fields))?;
    Ok(Outcome::Done(Value::Absent))
}

fn event(context: &CallContext<'_>, index: usize) -> Result<Option<PathEvent>, RaisedError> {
    let Some(data) = context.value(index)? else {
        return Ok(None);
    };
    let metres = number(data, 1) * 1e-3;
    let kind = number(data, 0);
    let Value::Str(signal) = part(data, 4) else {
        return Err(context.argument_error("this is no triggdata"));
    };
    if kind == NOT_DEFINED {
        return Err(context.argument_error(
            "the triggdata is not defined; call TriggIO, TriggEquip or TriggInt with it first",
        ));
    }
    Ok(Some(PathEvent {
        place: if kind == AFTER_START {
            PathPlace::AfterStart(metres)
        } else {
            PathPlace::BeforeEnd(metres)
        },
        lead: SimDuration::from_secs_f64(number(data, 2)),
        delay: SimDuration::from_secs_f64(number(data, 3)),
        action: if let Some(relation) = RELATIONS.get((number(data, 7) as usize).wrapping_sub(1)) {
            PathAction::Check(SignalCheck {
                signal: signal.clone(),
                relation: *relation,
                value: number(data, 5),
                notice: notice(&context.location.task, number(data, 6) as u32),
                stops: part(data, 8) == &Value::Bool(true),
            })
        } else if number(data, 6) > 0.0 {
            PathAction::Notify(signal.clone())
        } else {
            PathAction::Set {
                signal: signal.clone(),
                value: number(data, 5),
            }
        },
    }))
}

/// `target \ID, Speed \T, Trigg_1 \T2 .. \T8, Zone \Inpos, Tool \WObj \Corr` with the target at an index.
const fn places(via: Option<usize>, target: usize, correction: bool) -> Places {
    Places {
        conc: Some(0),
        via,
        target,
        speed: target + 2,
        v: None,
        t: Some(target + 3),
        zone: Some(target + 12),
        z: None,
        in_position: Some(target + 13),
        tool: target + 14,
        work_object: target + 15,
        correction: if correction { Some(target + 16) } else { None },
        total_load: target + 16 + correction as usize,
    }
}

fn trigg(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    kind: MoveKind,
    places: &Places,
) -> Ran {
    perform(context, system, |context, system| {
        let mut asked = cartesian(context, system, kind, places)?;
        for index in places.target + 4..places.target + 12 {
            asked.along.extend(event(context, index)?);
        }
        Ok(asked)
    })
}

fn trigg_l(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const PLACES: Places = places(None, 1, true);
    trigg(context, system, MoveKind::Linear, &PLACES)
}

fn trigg_j(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const PLACES: Places = places(None, 1, false);
    trigg(context, system, MoveKind::Joint, &PLACES)
}

fn trigg_c(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const PLACES: Places = places(Some(1), 2, true);
    trigg(context, system, MoveKind::Linear, &PLACES)
}

/// The outputs of an array of `triggios`, `triggiosdnum` or `triggstrgo` that are used.
fn outputs(
    context: &CallContext<'_>,
    system: &dyn System,
    index: usize,
) -> Result<Vec<PathEvent>, RaisedError> {
    let Some(Value::Array(items)) = context.value(index)? else {
        return Ok(Vec::new());
    };
    let mut events = Vec::new();
    for item in items {
        if part(item, 0) != &Value::Bool(true) {
            continue;
        }
        let Value::Str(signal) = part(item, 4) else {
            return Err(context.argument_error("a signal name is missing"));
        };
        system
            .signal(signal)
            .map_err(|fault| context.system_fault(fault))?;
        let (distance, lag) = (number(item, 1), number(item, 3));
        let value = match part(item, 5) {
            Value::Str(digits) => digits.trim().parse().ok(),
            value => value.as_number(),
        };
        let Some(value) = value.filter(|_| distance >= 0.0 && lag <= 0.5) else {
            return Err(context.argument_error(format!(
                "TriggLIOs, signal {signal}: the distance {distance} mm must not be below 0, the lag {lag} s not above 0.5, and the value a number"
            )));
        };
        events.push(PathEvent {
            place: if part(item, 2) == &Value::Bool(true) {
                PathPlace::AfterStart(distance * 1e-3)
            } else {
                PathPlace::BeforeEnd(distance * 1e-3)
            },
            lead: SimDuration::from_secs_f64(lag.max(0.0)),
            delay: SimDuration::from_secs_f64((-lag).max(0.0)),
            action: PathAction::Set {
                signal: signal.clone(),
                value,
            },
        });
    }
    Ok(events)
}

/// A line with outputs from arrays, named by their signals' names.
fn trigg_l_ios(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const PLACES: Places = Places {
        conc: Some(0),
        via: None,
        target: 1,
        speed: 3,
        v: None,
        t: Some(4),
        zone: Some(8),
        z: None,
        in_position: Some(9),
        tool: 10,
        work_object: 11,
        correction: Some(12),
        total_load: 13,
    };
    perform(context, system, |context, system| {
        let mut asked = cartesian(context, system, MoveKind::Linear, &PLACES)?;
        for index in 5..8 {
            asked.along.extend(outputs(context, system, index)?);
        }
        Ok(asked)
    })
}
