//! Calls that get data: they are kept, and stored to registers by other calls.

use std::task::Poll;

use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, Value};
use depal_wire::{
    GetCustomData, GetDoList, GetNotify, GetPlanData, GetState, GetVisionDoList, GetVisionPath,
    GetVisionPlanData, GetVisionPoints, GetVizPath, PlanPoint, ReadParameter, Reply, Request,
};

use super::link::{code, exchange, failure, report, whole};
use super::stored_point::{StoredPoint, clear, count, push};
use crate::builtins::{Ran, done, number};
use crate::state;

/// Most points that are kept.
const MOST_POINTS: usize = 100;

/// Where the results of a list go: arguments that hold numbers of registers.
struct Places {
    count: usize,
    vision_move: Option<usize>,
    status: usize,
}

impl Places {
    /// `count, status, code`.
    fn of_points(count: usize) -> Self {
        Self {
            count,
            vision_move: None,
            status: count + 1,
        }
    }

    /// `count, vision move, status, code`.
    fn of_path(count: usize) -> Self {
        Self {
            count,
            vision_move: Some(count + 1),
            status: count + 2,
        }
    }
}

/// Asks until all parts are there. The first note is the place of the Vision Move, 0 while none came.
fn fetch(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    places: &Places,
    is_joint: bool,
    request: &Request,
) -> Ran {
    if context.notes.is_empty() {
        clear(context.memory);
        context.notes.push(Value::Int(0));
    }
    let code = loop {
        let reply = match exchange(context, system, request) {
            Poll::Pending => return Ok(Outcome::Blocked),
            Poll::Ready(Err(code)) => break code,
            Poll::Ready(Ok(reply)) => reply,
        };
        let before = count(context.memory);
        let (is_last, vision_move) = keep(context, &reply, is_joint);
        if vision_move > 0 && context.notes.first() == Some(&Value::Int(0)) {
            context.notes[0] = Value::Int(before as i64 + i64::from(vision_move));
        }
        if is_last || count(context.memory) >= MOST_POINTS {
            break code(&reply);
        }
    };
    let succeeded = matches!(code, 1100 | 1103 | 2100);
    if !succeeded {
        clear(context.memory);
        context.notes[0] = Value::Int(0);
    }
    let register = number(context, places.count)?;
    let points = count(context.memory) as f64;
    state::set_register(context.memory, register, points)?;
    if let Some(at) = places.vision_move {
        let register = number(context, at)?;
        let place = context
            .notes
            .first()
            .and_then(Value::as_number)
            .unwrap_or(0.0);
        state::set_register(context.memory, register, place)?;
    }
    report(context, places.status, code)?;
    report(context, places.status + 1, code)?;
    done()
}

/// Keeps the points of a part. Whether it is the last, and the place of the Vision Move in it.
fn keep(context: &mut CallContext<'_>, reply: &Reply, is_joint: bool) -> (bool, i32) {
    match reply {
        Reply::Points { list, .. } => {
            for record in &list.points {
                push(
                    context.memory,
                    &StoredPoint {
                        is_joint,
                        values: record.values,
                        label: f64::from(record.label),
                        speed: f64::from(record.cell8),
                        ..StoredPoint::default()
                    },
                );
            }
            // A part without points would be asked for again for ever.
            (list.is_last || list.points.is_empty(), list.vision_move)
        }
        Reply::CustomPoint { point, .. } => {
            push(
                context.memory,
                &StoredPoint {
                    values: point.values,
                    label: f64::from(point.label),
                    custom: point.custom.clone(),
                    ..StoredPoint::default()
                },
            );
            (point.is_last, 0)
        }
        Reply::PlanPoint(point) | Reply::VisionPlanPoint(point) => {
            keep_plan(context, point, is_joint)
        }
        _ => (true, 0),
    }
}

fn keep_plan(context: &mut CallContext<'_>, point: &PlanPoint, is_joint: bool) -> (bool, i32) {
    let cells = point.vision_move.as_ref();
    let plan = cells.and_then(|c| c.plan).map(|p| p.to_vec());
    push(
        context.memory,
        &StoredPoint {
            is_joint,
            values: point.values,
            label: 0.0,
            speed: f64::from(point.velocity_percent),
            move_type: f64::from(point.move_type),
            tool: f64::from(point.tool),
            plan: plan.unwrap_or_default(),
            custom: cells.map(|c| c.custom.clone()).unwrap_or_default(),
        },
    );
    (point.is_last, i32::from(cells.is_some()))
}

pub(super) fn vision_points(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let job = whole(context, 0, "Job")?;
    let request = Request::GetVisionPoints(GetVisionPoints { job });
    fetch(context, system, &Places::of_points(1), false, &request)
}

pub(super) fn custom_data(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let job = whole(context, 0, "Job")?;
    let request = Request::GetCustomData(GetCustomData { job });
    fetch(context, system, &Places::of_points(1), false, &request)
}

pub(super) fn vision_path(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let pose_type = whole(context, 1, "Jps_Pos")?;
    let job = whole(context, 0, "Job")?;
    let request = Request::GetVisionPath(GetVisionPath { job, pose_type });
    fetch(
        context,
        system,
        &Places::of_path(2),
        pose_type == 1,
        &request,
    )
}

pub(super) fn viz_path(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let pose_type = whole(context, 0, "Jps_Pos")?;
    let request = Request::GetVizPath(GetVizPath { pose_type });
    fetch(
        context,
        system,
        &Places::of_path(1),
        pose_type == 1,
        &request,
    )
}

pub(super) fn plan_data(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let resource = whole(context, 0, "Resource")?;
    let format = whole(context, 1, "Jps_Pos")?;
    let request = match resource {
        0 => Request::GetPlanData(GetPlanData { format }),
        job => Request::GetVisionPlanData(GetVisionPlanData {
            job,
            pose_type: format,
        }),
    };
    let is_joint = matches!(format, 1 | 3);
    fetch(context, system, &Places::of_path(2), is_joint, &request)
}

/// Asks once.
fn ask(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    request: &Request,
) -> Poll<Result<Reply, i32>> {
    if context.notes.is_empty() {
        context.notes.push(Value::Bool(true));
    }
    exchange(context, system, request)
}

/// The status of a reply, or of what came instead of one.
fn code_of(reply: &Result<Reply, i32>) -> i32 {
    reply.as_ref().map_or_else(|code| *code, code)
}

/// The DO list of the gripper; it has no status register of its own.
pub(super) fn outputs(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let sections = None;
    let request = match whole(context, 0, "Resource")? {
        0 => Request::GetDoList(GetDoList { sections }),
        job => Request::GetVisionDoList(GetVisionDoList { job, sections }),
    };
    let Poll::Ready(reply) = ask(context, system, &request) else {
        return Ok(Outcome::Blocked);
    };
    let list = match &reply {
        Ok(Reply::DoList(list) | Reply::VisionDoList(list)) => Some(list.0.to_vec()),
        _ => None,
    };
    let succeeded = list.is_some();
    if let Some(items) = state::items_mut(context.memory, state::DO_LIST) {
        *items = list
            .unwrap_or_default()
            .into_iter()
            .map(|d| Value::Int(i64::from(d)))
            .collect();
    }
    let code = code_of(&reply);
    if report(context, 1, code)? || succeeded {
        done()
    } else {
        Err(failure("MM_GET_DL", code))
    }
}

pub(super) fn parameter(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let id = whole(context, 0, "Read_id")?;
    let request = Request::ReadParameter(ReadParameter { id });
    let Poll::Ready(reply) = ask(context, system, &request) else {
        return Ok(Outcome::Blocked);
    };
    let code = match reply {
        Ok(Reply::Parameter(value)) => {
            let register = number(context, 2)?;
            state::set_register(context.memory, register, value)?;
            2109
        }
        reply => code_of(&reply),
    };
    report(context, 1, code)?;
    report(context, 3, code)?;
    done()
}

/// The message of a Notify step; it carries no status, so only trouble of the connection is one.
pub(super) fn message(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let Poll::Ready(reply) = ask(context, system, &Request::GetNotify(GetNotify)) else {
        return Ok(Outcome::Blocked);
    };
    match reply {
        Ok(reply) => {
            let message = match reply {
                Reply::Message(message) => message,
                other => code(&other),
            };
            let register = number(context, 0)?;
            state::set_register(context.memory, register, f64::from(message))?;
            report(context, 1, 0)?;
            done()
        }
        Err(code) if report(context, 1, code)? => done(),
        Err(code) => Err(failure("MM_GET_NTFY", code)),
    }
}

pub(super) fn state(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let Poll::Ready(reply) = ask(context, system, &Request::GetState(GetState)) else {
        return Ok(Outcome::Blocked);
    };
    let code = code_of(&reply);
    report(context, 0, code)?;
    report(context, 1, code)?;
    done()
}
