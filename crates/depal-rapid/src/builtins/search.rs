//! Moves that look for a signal on their way.

use depal_vm::system::{MoveId, MoveKind, System};
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::motion::{Places, cartesian, perform};
use super::records::{robtarget, tool, work_object};
use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 2] = [
    (
        "PROC SearchL(\\switch Stop | switch PStop | switch SStop | switch Sup, signaldi Signal \\switch Flanks | switch PosFlank | switch NegFlank | switch HighLevel | switch LowLevel, INOUT robtarget SearchPoint, robtarget ToPoint \\num ID, speeddata Speed \\num V | num T, tooldata Tool \\wobjdata WObj \\switch Corr \\loaddata TLoad)",
        search_l,
    ),
    (
        "PROC SearchC(\\switch Stop | switch PStop | switch SStop | switch Sup, signaldi Signal \\switch Flanks | switch PosFlank | switch NegFlank | switch HighLevel | switch LowLevel, INOUT robtarget SearchPoint, robtarget CirPoint, robtarget ToPoint \\num ID, speeddata Speed \\num V | num T, tooldata Tool \\wobjdata WObj \\switch Corr \\loaddata TLoad)",
        search_c,
    ),
];

const SUPERVISED: usize = 3;
const SIGNAL: usize = 4;
const SEARCH_POINT: usize = 10;

/// The target stands at an index; no zone: a search ends in a stop point.
const fn places(via: Option<usize>, target: usize) -> Places {
    Places {
        conc: None,
        via,
        target,
        speed: target + 2,
        v: Some(target + 3),
        t: Some(target + 4),
        zone: None,
        z: None,
        in_position: None,
        tool: target + 5,
        work_object: target + 6,
        correction: Some(target + 7),
        total_load: target + 8,
    }
}

/// What counts as found: the values before and now.
fn is_found(context: &CallContext<'_>, before: f64, now: f64, begun: bool) -> bool {
    let given = |offset: usize| context.is_given(SIGNAL + offset);
    if given(1) {
        before != now
    } else if given(3) {
        before != 0.0 && now == 0.0
    } else if given(4) {
        now != 0.0 && (begun || before == 0.0)
    } else if given(5) {
        now == 0.0 && (begun || before != 0.0)
    } else {
        before == 0.0 && now != 0.0
    }
}

/// The notes of [`perform`] come first; then the value of the signal when last looked at (`Num`) and how often it
/// was found (`Int`), and whether the arm was stopped for it (`Bool`).
fn search(context: &mut CallContext<'_>, system: &mut dyn System, places: &Places) -> Ran {
    const LAST: usize = 2;
    let signal = context.signal(SIGNAL)?;
    let value = system
        .signal(&signal)
        .map_err(|fault| context.system_fault(fault))?;
    if context.notes.is_empty() {
        let plain = (1..=5).all(|offset| !context.is_given(SIGNAL + offset));
        if plain && value != 0.0 {
            return Err(error(
                "ERR_SIGSUPSEARCH",
                format!(
                    "signal {signal} is 1 already when the search begins; the arm was not moved"
                ),
            ));
        }
        let begun = perform(context, system, |context, system| {
            cartesian(context, system, MoveKind::Linear, places)
        })?;
        if begun == Outcome::Blocked && context.notes.is_empty() {
            return Ok(begun);
        }
        context.notes.truncate(LAST);
        context.notes.push(Value::Num(value as f32));
        context.notes.push(Value::Int(0));
        context.notes.push(Value::Bool(false));
        // A level that holds from the beginning counts when the move begins.
        context.notes.push(Value::Bool(true));
    }
    let [
        Value::Int(id),
        _,
        Value::Num(before),
        Value::Int(found),
        Value::Bool(stopping),
        Value::Bool(first),
    ] = context.notes.as_slice()
    else {
        return Ok(Outcome::Done(Value::Absent));
    };
    let (id, before, mut found, mut stopping) =
        (MoveId(*id as u64), f64::from(*before), *found, *stopping);
    let first = *first;
    let is_over = match system.is_move_done(id) {
        Ok(is_over) => is_over,
        Err(fault) => return Err(context.system_fault(fault)),
    };
    let begun = system.is_move_begun(id);
    if begun && !stopping && is_found(context, before, value, first) {
        found += 1;
        if found == 1 {
            let joints = system.joints();
            let base_from_tcp = system.forward(&joints) * tool(context.required(places.tool)?)?;
            let base_from_object = work_object(context.value(places.work_object)?)?;
            let point = robtarget(&(base_from_object.inverse() * base_from_tcp), &joints);
            context.assign(SEARCH_POINT, point)?;
            if (0..SUPERVISED).any(|index| context.is_given(index)) {
                system.stop_motion();
                stopping = true;
            }
        }
    }
    context.notes[LAST] = Value::Num(value as f32);
    context.notes[LAST + 1] = Value::Int(found);
    context.notes[LAST + 2] = Value::Bool(stopping);
    context.notes[LAST + 3] = Value::Bool(first && !begun);
    if stopping {
        return Ok(if system.is_standing() {
            Outcome::Done(Value::Absent)
        } else {
            Outcome::Blocked
        });
    }
    if !is_over {
        return Ok(Outcome::Blocked);
    }
    match found {
        0 => Err(error(
            "ERR_WHLSEARCH",
            format!("signal {signal} was not found; the arm stands at the end of the search"),
        )),
        1 => Ok(Outcome::Done(Value::Absent)),
        _ if !context.is_given(SUPERVISED) => Ok(Outcome::Done(Value::Absent)),
        more => Err(error(
            "ERR_WHLSEARCH",
            format!("signal {signal} was found {more} times on the way, expected once (\\Sup)"),
        )),
    }
}

fn search_l(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const PLACES: Places = places(None, 11);
    search(context, system, &PLACES)
}

fn search_c(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const PLACES: Places = places(Some(11), 12);
    search(context, system, &PLACES)
}
