//! Further questions to the operator, answered like those in `operator`: a line of the answers each.

use std::task::Poll;

use depal_vm::system::{Question, System};
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::records::part;
use super::table::Entry;
use crate::errors::error;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 9] = [
    (
        "FUNC btnres UIMessageBox(\\string Header \\string Message | string MsgArray{*} \\switch Wrap \\num Buttons | string BtnArray{*} \\num DefaultBtn \\num Icon \\string Image \\num MaxTime \\signaldi DIBreak \\switch DIPassive \\signaldo DOBreak \\switch DOPassive \\INOUT errnum BreakFlag)",
        message_box,
    ),
    (
        "FUNC num UIListView(\\INOUT btnres Result \\string Header, listitem ListItems{*} \\num Buttons | string BtnArray{*} \\num Icon \\num DefaultIndex \\num MaxTime \\signaldi DIBreak \\switch DIPassive \\signaldo DOBreak \\switch DOPassive \\INOUT errnum BreakFlag)",
        list_view,
    ),
    (
        "FUNC string UIAlphaEntry(\\string Header \\string Message | string MsgArray{*} \\switch Wrap \\num Icon \\string InitString \\num MaxTime \\signaldi DIBreak \\switch DIPassive \\signaldo DOBreak \\switch DOPassive \\INOUT errnum BreakFlag)",
        text_entry,
    ),
    (
        "FUNC dnum UIDnumEntry(\\string Header \\string Message | string MsgArray{*} \\switch Wrap \\num Icon \\dnum InitValue \\dnum MinValue \\dnum MaxValue \\switch AsInteger \\num MaxTime \\signaldi DIBreak \\switch DIPassive \\signaldo DOBreak \\switch DOPassive \\INOUT errnum BreakFlag)",
        number_entry,
    ),
    (
        "FUNC num UINumTune(\\string Header \\string Message | string MsgArray{*} \\switch Wrap \\num Icon, num InitValue, num Increment \\num MinValue \\num MaxValue \\num MaxTime \\signaldi DIBreak \\switch DIPassive \\signaldo DOBreak \\switch DOPassive \\INOUT errnum BreakFlag)",
        number_tune,
    ),
    (
        "PROC TPReadDnum(INOUT dnum TPAnswer, string TPText \\num MaxTime \\signaldi DIBreak \\switch DIPassive \\signaldo DOBreak \\switch DOPassive \\INOUT errnum BreakFlag)",
        read_dnum,
    ),
    ("PROC TPShow(tpnum Window)", shown),
    (
        "PROC UIShow(string AssemblyName, string TypeName \\string InitCmd)",
        shown,
    ),
    ("FUNC bool UIClientExist()", client),
];

/// A question with its time limit and break signals.
struct Asked {
    instruction: &'static str,
    text: String,
    /// The argument that limits the time.
    max_time: usize,
}

impl Asked {
    /// A question whose arguments stand as in `\\Header \\Message | MsgArray \\Wrap .. \\MaxTime \\DIBreak ..`, the text
    /// from argument 1 on.
    fn new(
        context: &CallContext<'_>,
        instruction: &'static str,
        max_time: usize,
    ) -> Result<Self, RaisedError> {
        Ok(Self {
            instruction,
            text: text(context, 1)?,
            max_time,
        })
    }
}

/// What came of a question.
enum Reply {
    Waiting,
    /// The time is over or the signal came, and the program has a variable that tells it so.
    BrokenOff,
    Answer(String),
}

/// Asks, and makes a result of the answer; `otherwise` is that of a question that was broken off.
fn answered(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    asked: Asked,
    otherwise: Value,
    result: impl FnOnce(&mut CallContext<'_>, &str) -> Result<Value, RaisedError>,
) -> Ran {
    Ok(match ask(context, system, asked)? {
        Reply::Waiting => Outcome::Blocked,
        Reply::BrokenOff => Outcome::Done(otherwise),
        Reply::Answer(answer) => Outcome::Done(result(context, &answer)?),
    })
}

/// The answer. Without a break flag, being broken off is an error.
fn ask(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    asked: Asked,
) -> Result<Reply, RaisedError> {
    // `\\DIBreak \\DIPassive \\DOBreak \\DOPassive \\BreakFlag` stand behind the time limit everywhere.
    let (break_input, break_flag) = (asked.max_time + 1, asked.max_time + 5);
    let question = Question {
        instruction: asked.instruction,
        text: asked.text,
    };
    if let Poll::Ready(answer) = system.answer(&question) {
        return Ok(Reply::Answer(answer));
    }
    let late = match context.optional_number(asked.max_time)? {
        Some(limit) => context.elapsed(system.now()).as_secs_f64() >= limit,
        None => false,
    };
    let broken = if context.is_given(break_input) {
        let signal = context.signal(break_input)?;
        // \DIPassive breaks off on 0 instead of 1.
        let wanted = if context.is_given(break_input + 1) {
            0.0
        } else {
            1.0
        };
        let value = system.signal(&signal);
        value.map_err(|fault| context.system_fault(fault))? == wanted
    } else {
        false
    };
    if !late && !broken {
        return Ok(Reply::Waiting);
    }
    let name = if late {
        "ERR_TP_MAXTIME"
    } else {
        "ERR_TP_DIBREAK"
    };
    let raised = error(
        name,
        format!("nobody answered {} in time", asked.instruction),
    );
    if context.is_given(break_flag) {
        context.assign_number(break_flag, raised.number as f64)?;
        return Ok(Reply::BrokenOff);
    }
    Err(raised)
}

/// The text of `\Message` or `\MsgArray`.
fn text(context: &CallContext<'_>, message: usize) -> Result<String, RaisedError> {
    match (context.value(message)?, context.value(message + 1)?) {
        (Some(Value::Str(text)), _) => Ok(text.clone()),
        (_, Some(Value::Array(lines))) => {
            let lines = lines.iter().map(|line| match line {
                Value::Str(line) => line.as_str(),
                _ => "",
            });
            Ok(lines.collect::<Vec<_>>().join(" ").trim().to_owned())
        }
        _ => Ok(String::new()),
    }
}

/// The number of a button from its number or its name, or from the program's own names (counted from 1).
fn button(
    context: &CallContext<'_>,
    own: usize,
    instruction: &str,
    answer: &str,
) -> Result<f64, RaisedError> {
    const NAMES: [&str; 8] = ["", "ok", "abort", "retry", "ignore", "cancel", "yes", "no"];
    let answer = answer.trim();
    if let Ok(number) = answer.parse() {
        return Ok(number);
    }
    let found = match context.value(own)? {
        Some(Value::Array(names)) => names
            .iter()
            .position(|name| matches!(name, Value::Str(name) if name.eq_ignore_ascii_case(answer)))
            .map(|index| index + 1),
        _ => NAMES
            .iter()
            .skip(1)
            .position(|name| name.eq_ignore_ascii_case(answer))
            .map(|index| index + 1),
    };
    match found {
        Some(number) => Ok(number as f64),
        None if answer.is_empty() => Ok(0.0),
        None => Err(context.argument_error(format!(
            "the answer to {instruction} is {answer:?}, expected a button by number or name"
        ))),
    }
}

fn message_box(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let asked = Asked::new(context, "UIMessageBox", 9)?;
    let none = Value::Num(0.0);
    answered(context, system, asked, none, |context, answer| {
        let button = button(context, 5, "UIMessageBox", answer)?;
        Ok(Value::Num(button as f32))
    })
}

/// The answer is the number of an item, or its text.
fn list_view(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let items: Vec<String> = match context.required(2)? {
        Value::Array(items) => items
            .iter()
            .map(|item| match part(item, 1) {
                Value::Str(text) => text.clone(),
                _ => String::new(),
            })
            .collect(),
        _ => Vec::new(),
    };
    let header = if context.is_given(1) {
        context.string(1)?
    } else {
        String::new()
    };
    let asked = Asked {
        instruction: "UIListView",
        text: format!("{header}: {}", items.join(", ")),
        max_time: 7,
    };
    let none = Value::Num(0.0);
    answered(context, system, asked, none, |context, answer| {
        let answer = answer.trim();
        let chosen = match answer.parse::<usize>() {
            Ok(number) => number,
            Err(_) if answer.is_empty() => 0,
            Err(_) => items
                .iter()
                .position(|item| item.eq_ignore_ascii_case(answer))
                .map_or(usize::MAX, |index| index + 1),
        };
        if chosen > items.len() {
            return Err(context.argument_error(format!(
                "the answer to UIListView is {answer:?}, expected 1 to {} or the text of an item",
                items.len()
            )));
        }
        if context.is_given(0) {
            // The button OK.
            context.assign_number(0, 1.0)?;
        }
        Ok(Value::Num(chosen as f32))
    })
}

fn text_entry(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let asked = Asked::new(context, "UIAlphaEntry", 6)?;
    let empty = Value::Str(String::new());
    answered(context, system, asked, empty, |context, answer| {
        let limit = context.rules.string_limit;
        Ok(Value::Str(answer.chars().take(limit).collect()))
    })
}

/// A number within the limits of two arguments.
fn within(
    context: &CallContext<'_>,
    instruction: &str,
    answer: &str,
    [least, most]: [usize; 2],
) -> Result<f64, RaisedError> {
    let least = context.optional_number(least)?.unwrap_or(f64::NEG_INFINITY);
    let most = context.optional_number(most)?.unwrap_or(f64::INFINITY);
    match answer.trim().parse::<f64>() {
        Ok(number) if (least..=most).contains(&number) => Ok(number),
        _ => Err(context.argument_error(format!(
            "the answer to {instruction} is {answer:?}, expected a number from {least} to {most}"
        ))),
    }
}

/// Asks for a number within the limits of two arguments and makes a value of it.
fn number(
    context: &mut CallContext<'_>,
    system: &mut dyn System,
    instruction: &'static str,
    limits: [usize; 2],
    value: fn(f64) -> Value,
) -> Ran {
    let asked = Asked::new(context, instruction, 9)?;
    answered(context, system, asked, value(0.0), |context, answer| {
        Ok(value(within(context, instruction, answer, limits)?))
    })
}

fn number_entry(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    number(context, system, "UIDnumEntry", [6, 7], Value::Dnum)
}

fn number_tune(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let single = |number| Value::Num(number as f32);
    number(context, system, "UINumTune", [7, 8], single)
}

fn read_dnum(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let asked = Asked {
        instruction: "TPReadDnum",
        text: context.string(1)?,
        max_time: 2,
    };
    answered(context, system, asked, Value::Absent, |context, answer| {
        let number = within(context, "TPReadDnum", answer, [usize::MAX; 2])?;
        context.assign_number(0, number)?;
        Ok(Value::Absent)
    })
}

/// The simulation has no windows to show.
fn shown(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Done(Value::Absent))
}

fn client(_: &mut CallContext<'_>, _: &mut dyn System) -> Ran {
    Ok(Outcome::Done(Value::Bool(true)))
}
