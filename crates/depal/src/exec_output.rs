//! What `depal exec` shows: the operator's lines, the trace, the document at the end.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Duration;

use depal_controller::ControllerEvent;
use depal_time::SimTime;
use depal_vm::execution::RuntimeError;
use depal_vm::system::{LogKind, ProgramLocation};
use serde_json::{Value as Json, json};

use crate::failure::Failure;

/// How a program came to its end.
pub enum End {
    /// The entry procedure returned.
    Ended,
    /// EXIT, Stop or ExitCycle.
    Stopped,
    /// It waits for what can never happen.
    Idle,
    /// The simulated time given was used up.
    TimeLimit,
    /// A run-time error that no handler took.
    Failed(Place),
}

/// A run-time error with its innermost place.
pub struct Place {
    module: String,
    routine: String,
    line: u32,
    message: String,
    error: RuntimeError,
}

impl Place {
    /// Of an unhandled error.
    pub fn of(error: &RuntimeError) -> Self {
        let inner = error.call_stack.first().cloned().unwrap_or_default();
        let message = if error.name.is_empty() {
            error.message.clone()
        } else {
            format!("{}: {}", error.name, error.message)
        };
        Self {
            module: inner.module,
            routine: inner.routine,
            line: inner.line,
            message: message.replace(['\n', '\r'], " "),
            error: error.clone(),
        }
    }
}

/// Where everything goes.
pub struct Output {
    json: bool,
    trace: Option<BufWriter<File>>,
    lines: Vec<String>,
    moves: u64,
    /// Whether the language has lines for the operator that belong on stdout: RAPID alone.
    pub has_operator_lines: bool,
    /// Numeric registers to be shown at the end.
    pub registers: Option<Vec<(u32, f64)>>,
}

impl Output {
    /// Opens the trace, if one is asked for.
    pub fn open(json: bool, trace: Option<&Path>) -> Result<Self, Failure> {
        let trace = match trace {
            None => None,
            Some(path) => Some(BufWriter::new(File::create(path).map_err(|error| {
                Failure::Environment(format!("cannot write {}: {error}", path.display()))
            })?)),
        };
        Ok(Self {
            json,
            trace,
            lines: Vec::new(),
            moves: 0,
            has_operator_lines: true,
            registers: None,
        })
    }

    /// Shows and traces what happened.
    pub fn event(&mut self, event: &ControllerEvent) -> Result<(), Failure> {
        match event {
            ControllerEvent::Log {
                kind: LogKind::Operator,
                text,
                ..
            } if self.has_operator_lines => {
                let line = text.replace(['\n', '\r'], " ");
                if self.json {
                    self.lines.push(line);
                } else {
                    let mut stdout = std::io::stdout().lock();
                    // A reader that has gone away does not stop the robot.
                    let _ = writeln!(stdout, "{line}").and_then(|()| stdout.flush());
                }
            }
            ControllerEvent::Log { at, text, .. } => tell!("{:.3} s {text}", at.as_secs_f64()),
            ControllerEvent::MoveStarted { .. } => self.moves += 1,
            _ => {}
        }
        if let Some(trace) = &mut self.trace {
            writeln!(trace, "{}", document(event)).map_err(|error| {
                Failure::Environment(format!("cannot write the trace: {error}"))
            })?;
        }
        Ok(())
    }

    /// The document of a program that was not started.
    pub fn invalid(&self, message: &str, wall: Duration) {
        if self.json {
            let error = json!({"module": null, "routine": null, "line": null, "message": message});
            say!("{}", self.summary("invalid", SimTime::ZERO, wall, &error));
        }
    }

    /// The end of a program that ran.
    pub fn finish(mut self, end: &End, now: SimTime, wall: Duration) -> Result<(), Failure> {
        if let Some(trace) = &mut self.trace {
            trace.flush().map_err(|error| {
                Failure::Environment(format!("cannot write the trace: {error}"))
            })?;
        }
        let (word, error) = match end {
            End::Ended => ("ended", Json::Null),
            End::Stopped => ("stopped", Json::Null),
            End::Idle => ("idle", Json::Null),
            End::TimeLimit => ("time_limit", Json::Null),
            End::Failed(place) => {
                tell!("{}", place.error.report(now));
                let error = json!({
                    "module": place.module,
                    "routine": place.routine,
                    "line": place.line,
                    "message": place.message,
                });
                ("error", error)
            }
        };
        if self.json {
            say!("{}", self.summary(word, now, wall, &error));
        } else {
            for (number, value) in self.registers.iter().flatten() {
                say!("R[{number}]={}", depal_tp::decimal(*value));
            }
        }
        Ok(())
    }

    fn summary(&self, end: &str, now: SimTime, wall: Duration, error: &Json) -> Json {
        let mut summary = json!({
            "end": end,
            "sim_time_s": now.as_secs_f64(),
            "wall_time_s": wall.as_secs_f64(),
            "moves": self.moves,
            "tpwrite": self.lines,
            "error": error,
        });
        if let Some(registers) = &self.registers {
            let named = |(number, value): &(u32, f64)| (format!("R[{number}]"), json!(value));
            summary["registers"] = registers.iter().map(named).collect();
        }
        summary
    }
}

fn place(location: &ProgramLocation) -> String {
    format!("{}/{}:{}", location.module, location.routine, location.line)
}

/// One line of the trace: `t_s`, `event`, and what belongs to it.
fn document(event: &ControllerEvent) -> Json {
    let t = event.at().as_secs_f64();
    match event {
        ControllerEvent::Statement { location, .. } => {
            json!({"t_s": t, "event": "statement", "place": place(location)})
        }
        ControllerEvent::SignalEdge { name, value, .. } => {
            json!({"t_s": t, "event": "signal", "name": name, "value": value})
        }
        ControllerEvent::MoveStarted { id, location, .. } => {
            json!({"t_s": t, "event": "move_started", "move": id.0, "place": place(location)})
        }
        ControllerEvent::MoveReached { id, location, .. } => {
            json!({"t_s": t, "event": "move_reached", "move": id.0, "place": place(location)})
        }
        ControllerEvent::CornerFailure { id, location, .. } => {
            json!({"t_s": t, "event": "corner_failure", "move": id.0, "place": place(location)})
        }
        ControllerEvent::MotionStopped {
            dropped, reason, ..
        } => {
            let dropped: Vec<u64> = dropped.iter().map(|id| id.0).collect();
            json!({"t_s": t, "event": "motion_stopped", "dropped": dropped, "reason": reason})
        }
        ControllerEvent::MotionHeld { .. } => json!({"t_s": t, "event": "motion_held"}),
        ControllerEvent::MotionResumed { .. } => json!({"t_s": t, "event": "motion_resumed"}),
        ControllerEvent::Log {
            kind,
            location,
            text,
            ..
        } => {
            let kind = match kind {
                LogKind::Operator => "tpwrite",
                LogKind::EventLog => "log",
            };
            json!({"t_s": t, "event": kind, "place": place(location), "text": text})
        }
        ControllerEvent::Answered {
            instruction,
            text,
            answer,
            ..
        } => {
            json!({"t_s": t, "event": "answered", "instruction": instruction, "text": text, "answer": answer})
        }
        ControllerEvent::TaskEnded { task, state, .. } => {
            json!({"t_s": t, "event": "task_ended", "task": task, "state": format!("{state:?}")})
        }
    }
}
