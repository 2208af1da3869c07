//! A tree as a listing in English, in one normal form.

use std::fmt::Write;

use super::tree::*;

/// The text of a listing. It reads as the same program.
pub(crate) fn print(listing: &Listing) -> String {
    let mut out = format!("/PROG  {}\n/ATTR\n", listing.name.text);
    if !listing.comment.is_empty() {
        let _ = writeln!(out, "COMMENT\t\t= \"{}\";", listing.comment);
    }
    out.push_str("/MN\n");
    for line in &listing.lines {
        let text = statement(&line.statement);
        let _ = writeln!(out, "{:4}:  {text} ;", line.number);
    }
    out.push_str("/POS\n");
    for taught in &listing.positions {
        let _ = writeln!(out, "P[{}]{{\n   GP1:", taught.number);
        let position = &taught.position;
        let number = |n: Option<u32>| n.map_or("F".to_owned(), |n| n.to_string());
        let _ = write!(
            out,
            "\tUF : {}, UT : {},",
            number(position.frame),
            number(position.tool)
        );
        if !position.is_joint {
            let _ = write!(out, "\tCONFIG : '{}',", position.config);
        }
        let (names, first_unit) = if position.is_joint {
            (["J1", "J2", "J3", "J4", "J5", "J6"], "deg")
        } else {
            (["X", "Y", "Z", "W", "P", "R"], "mm")
        };
        for (index, (name, value)) in names.iter().zip(position.values).enumerate() {
            let unit = if index < 3 { first_unit } else { "deg" };
            let value = if value.is_finite() {
                real(value, true)
            } else {
                "********".to_owned()
            };
            let comma = if index < 5 { "," } else { "" };
            let _ = write!(out, "\n\t{name} = {value} {unit}{comma}");
        }
        out.push_str("\n};\n");
    }
    out.push_str("/END\n");
    out
}

fn real(value: f64, is_real: bool) -> String {
    let text = format!("{value}");
    if is_real && !text.contains('.') {
        format!("{text}.0")
    } else {
        text
    }
}

fn list(values: &[Expr]) -> String {
    let values: Vec<_> = values.iter().map(|v| expression(v, 1)).collect();
    values.join(",")
}

fn item(item: &Item) -> String {
    match item.kind {
        ItemKind::System => item.path.clone(),
        kind if item.indexes.is_empty() => kind.name().to_owned(),
        kind => format!("{}[{}]", kind.name(), list(&item.indexes)),
    }
}

fn quoted(text: &str) -> String {
    let quote = if text.contains('\'') { '"' } else { '\'' };
    format!("{quote}{text}{quote}")
}

/// An expression where operators of at least this binding may stand.
pub(super) fn expression(expr: &Expr, least: u8) -> String {
    match &expr.kind {
        ExprKind::Number { value, is_real } if value.is_sign_negative() => {
            format!("(-{})", real(value.abs(), *is_real))
        }
        ExprKind::Number { value, is_real } => real(*value, *is_real),
        ExprKind::Text(text) => quoted(text),
        ExprKind::Switch(true) => "ON".into(),
        ExprKind::Switch(false) => "OFF".into(),
        ExprKind::Item(found) => item(found),
        ExprKind::Negate(inner) => format!("(-{})", expression(inner, 6)),
        ExprKind::Not(inner) => format!("(!{})", expression(inner, 6)),
        ExprKind::Binary(operator, left, right) => {
            let binding = operator.binding();
            let left = expression(left, binding);
            let right = expression(right, binding + 1);
            let text = match operator {
                Operator::And | Operator::Or | Operator::Div | Operator::Mod => {
                    format!("{left} {} {right}", operator.text())
                }
                _ => format!("{left}{}{right}", operator.text()),
            };
            if binding < least {
                format!("({text})")
            } else {
                text
            }
        }
        ExprKind::Function(function, arguments) => {
            let name = function.row().0;
            if function.is_on_strings() {
                let arguments: Vec<_> = arguments.iter().map(|a| expression(a, 6)).collect();
                let text = format!("{name} {}", arguments.join(","));
                if least > 1 { format!("({text})") } else { text }
            } else {
                format!("{name}[{}]", list(arguments))
            }
        }
    }
}

/// A value where no operator may stand.
fn simple(expr: &Expr) -> String {
    match &expr.kind {
        ExprKind::Number { value, is_real } => real(*value, *is_real),
        ExprKind::Text(_) | ExprKind::Item(_) => expression(expr, 1),
        _ => {
            let text = expression(expr, 1);
            format!("({text})")
        }
    }
}

fn call(call: &Call) -> String {
    let name = match &call.callee {
        Callee::Name(name) => name.text.clone(),
        Callee::Register(index) => format!("SR[{}]", expression(index, 1)),
    };
    if call.arguments.is_empty() {
        name
    } else {
        format!("{name}({})", list(&call.arguments))
    }
}

fn change(target: &Item, change: &Change) -> String {
    match change {
        Change::Value(value) if target.kind == ItemKind::Override => {
            format!("{}%", expression(value, 1))
        }
        Change::Value(value) => match &value.kind {
            ExprKind::Number { value, is_real } => real(*value, *is_real),
            _ => expression(value, 1),
        },
        Change::Pulse(None) => "PULSE".into(),
        Change::Pulse(Some(width)) => format!("PULSE,{}sec", simple(width)),
        Change::TimerStart => "START".into(),
        Change::TimerStop => "STOP".into(),
        Change::TimerReset => "RESET".into(),
    }
}

fn action(found: &Action) -> String {
    match found {
        Action::Jump(label) => format!("JMP LBL[{}]", expression(label, 1)),
        Action::Call(called) => format!("CALL {}", call(called)),
        Action::Assign(target, value) => format!("{}={}", item(target), change(target, value)),
        Action::Pause => "PAUSE".into(),
        Action::Abort => "ABORT".into(),
        Action::End => "END".into(),
        Action::Unsupported(word) => word.clone(),
    }
}

fn motion(motion: &Motion) -> String {
    let letter = match motion.kind {
        MotionKind::Joint => "J",
        MotionKind::Linear => "L",
        MotionKind::Circular => "C",
    };
    let mut out = letter.to_owned();
    for target in motion.via.iter().chain([&motion.target]) {
        let _ = write!(out, " {}", expression(target, 6));
    }
    let speed = motion.speed.as_ref().map(simple).unwrap_or_default();
    let _ = write!(out, " {speed}{}", motion.unit.text());
    match &motion.termination {
        Termination::Fine => out.push_str(" FINE"),
        Termination::Continuous(value) => {
            let _ = write!(out, " CNT {}", simple(value));
        }
    }
    let options = &motion.options;
    if let Some(value) = &options.acceleration {
        let _ = write!(out, " ACC {}", simple(value));
    }
    for (name, offset) in [
        ("Offset", &options.offset),
        ("Tool_Offset", &options.tool_offset),
    ] {
        match offset {
            OffsetBy::Nothing => {}
            OffsetBy::Condition => {
                let _ = write!(out, " {name}");
            }
            OffsetBy::Register(index) => {
                let _ = write!(out, " {name},PR[{}]", expression(index, 1));
            }
        }
    }
    for (on, name) in [
        (options.incremental, " INC"),
        (options.wrist_joint, " Wjnt"),
        (options.remote_tcp, " RTCP"),
    ] {
        if on {
            out.push_str(name);
        }
    }
    if let Some(label) = &options.skip {
        let _ = write!(out, " Skip,LBL[{}]", expression(label, 1));
        if let Some((target, value)) = &options.skip_position {
            let _ = write!(out, ",{}={}", item(target), expression(value, 1));
        }
    }
    for along in &options.along {
        let amount = simple(&along.amount);
        let (name, unit) = match along.when {
            AlongWhen::TimeBefore => ("TB", "sec"),
            AlongWhen::TimeAfter => ("TA", "sec"),
            AlongWhen::DistanceBefore => ("DB", "mm"),
        };
        let _ = write!(out, " {name} {amount}{unit},{}", action(&along.action));
    }
    if options.block {
        out.push_str(" TB 0.0sec,P-SPS");
    }
    out
}

fn statement(found: &Statement) -> String {
    match found {
        Statement::Empty => String::new(),
        Statement::Comment(text) => format!("!{text}"),
        Statement::Label(index) => format!("LBL[{}]", expression(index, 1)),
        Statement::Action(found) => action(found),
        Statement::Run(called) => format!("RUN {}", call(called)),
        Statement::If(condition, found) => {
            format!("IF {},{}", expression(condition, 1), action(found))
        }
        Statement::IfThen(condition) => format!("IF ({}) THEN", expression(condition, 1)),
        Statement::Else => "ELSE".into(),
        Statement::EndIf => "ENDIF".into(),
        Statement::For {
            counter,
            from,
            to,
            down,
        } => format!(
            "FOR {}={} {} {}",
            item(counter),
            expression(from, 1),
            if *down { "DOWNTO" } else { "TO" },
            expression(to, 1)
        ),
        Statement::EndFor => "ENDFOR".into(),
        Statement::Select {
            subject,
            value,
            action: found,
        } => format!(
            "SELECT {}={},{}",
            simple(subject),
            simple(value),
            action(found)
        ),
        Statement::Case {
            value,
            action: found,
        } => format!("={},{}", simple(value), action(found)),
        Statement::CaseElse(found) => format!("ELSE,{}", action(found)),
        Statement::WaitSeconds(seconds) => format!("WAIT {}(sec)", simple(seconds)),
        Statement::WaitUntil { condition, timeout } => {
            let condition = expression(condition, 1);
            match timeout {
                Some(label) => format!("WAIT ({condition}) TIMEOUT,LBL[{}]", expression(label, 1)),
                None => format!("WAIT ({condition})"),
            }
        }
        Statement::Motion(found) => motion(found),
        Statement::SkipCondition(condition) => {
            format!("SKIP CONDITION {}", expression(condition, 1))
        }
        Statement::OffsetCondition { offset, frame } => {
            let frame = frame
                .as_ref()
                .map(|f| format!(",UFRAME[{}]", expression(f, 1)));
            format!(
                "OFFSET CONDITION PR[{}]{}",
                expression(offset, 1),
                frame.unwrap_or_default()
            )
        }
        Statement::ToolOffsetCondition { offset, tool } => {
            let tool = tool
                .as_ref()
                .map(|t| format!(",UTOOL[{}]", expression(t, 1)));
            format!(
                "TOOL_OFFSET CONDITION PR[{}]{}",
                expression(offset, 1),
                tool.unwrap_or_default()
            )
        }
        Statement::Payload(index) => format!("PAYLOAD[{}]", expression(index, 1)),
        Statement::UserAlarm(index) => format!("UALM[{}]", expression(index, 1)),
        Statement::Message(text) => format!("MESSAGE[{text}]"),
        Statement::Nothing(text) => text.clone(),
    }
}
