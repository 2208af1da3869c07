//! Tree to source, in one normal form. Comments are not in the tree, so they are not in the text.

use std::fmt::Write;

use super::tree::*;

/// The modules as a program text that reads as the same tree.
pub(crate) fn print(modules: &[Module]) -> String {
    let mut printer = Printer {
        text: String::new(),
        depth: 0,
    };
    for module in modules {
        printer.module(module);
    }
    printer.text
}

struct Printer {
    text: String,
    depth: usize,
}

impl Printer {
    fn line(&mut self, text: &str) {
        for _ in 0..self.depth {
            self.text.push_str("  ");
        }
        self.text.push_str(text);
        self.text.push('\n');
    }

    fn module(&mut self, module: &Module) {
        let names: Vec<_> = module.attributes.iter().map(|a| a.text.as_str()).collect();
        let attributes = match names.as_slice() {
            [] => String::new(),
            names => format!("({})", names.join(",")),
        };
        self.line(&format!("MODULE {}{attributes}", module.name.text));
        self.depth += 1;
        for record in &module.records {
            self.line(&format!(
                "{}RECORD {}",
                local(record.local),
                record.name.text
            ));
            self.depth += 1;
            for (kind, name) in &record.fields {
                self.line(&format!("{} {};", kind.text, name.text));
            }
            self.depth -= 1;
            self.line("ENDRECORD");
        }
        for alias in &module.aliases {
            let (known, name) = (&alias.known.text, &alias.name.text);
            self.line(&format!("{}ALIAS {known} {name};", local(alias.local)));
        }
        for data in &module.data {
            let scope = local(data.local);
            self.data(scope, data);
        }
        for routine in &module.routines {
            self.routine(routine);
        }
        self.depth -= 1;
        self.line("ENDMODULE");
    }

    fn data(&mut self, scope: &str, data: &Data) {
        let task = if data.of_task { "TASK " } else { "" };
        let storage = match data.storage {
            Storage::Var => "VAR",
            Storage::Pers => "PERS",
            Storage::Const => "CONST",
        };
        let sizes = match data.sizes.as_slice() {
            [] => String::new(),
            sizes => format!("{{{}}}", list(sizes)),
        };
        let value = data.value.as_ref();
        let value = value.map_or(String::new(), |v| format!(" := {}", expression(v)));
        let (kind, name) = (&data.type_name.text, &data.name.text);
        self.line(&format!(
            "{scope}{task}{storage} {kind} {name}{sizes}{value};"
        ));
    }

    fn routine(&mut self, routine: &Routine) {
        let (opening, closing) = match &routine.kind {
            RoutineKind::Procedure => ("PROC ".to_owned(), "ENDPROC"),
            RoutineKind::Function(kind) => (format!("FUNC {} ", kind.text), "ENDFUNC"),
            RoutineKind::Trap => ("TRAP ".to_owned(), "ENDTRAP"),
        };
        let parameters = if routine.kind == RoutineKind::Trap {
            String::new()
        } else {
            format!("({})", parameters(&routine.parameters))
        };
        self.line(&format!(
            "{}{opening}{}{parameters}",
            local(routine.local),
            routine.name.text
        ));
        self.depth += 1;
        for data in &routine.data {
            self.data("", data);
        }
        self.depth -= 1;
        self.block(&routine.body);
        if let Some(body) = &routine.backward {
            self.line("BACKWARD");
            self.block(body);
        }
        if let Some(handler) = &routine.handler {
            let numbers = handler.numbers.as_ref();
            let numbers = numbers.map_or(String::new(), |n| format!(" ({})", list(n)));
            self.line(&format!("ERROR{numbers}"));
            self.block(&handler.body);
        }
        if let Some(body) = &routine.undo {
            self.line("UNDO");
            self.block(body);
        }
        self.line(closing);
    }

    fn block(&mut self, statements: &[Statement]) {
        self.depth += 1;
        for statement in statements {
            self.statement(&statement.kind);
        }
        self.depth -= 1;
    }

    fn statement(&mut self, statement: &StatementKind) {
        match statement {
            StatementKind::Assign { target, value } => {
                self.line(&format!("{} := {};", expression(target), expression(value)));
            }
            StatementKind::Call { name, arguments } => {
                self.line(&format!("{}{};", name.text, behind(arguments)));
            }
            StatementKind::CallByName { name, arguments } => {
                self.line(&format!("%{}%{};", expression(name), behind(arguments)));
            }
            StatementKind::If { arms, otherwise } => {
                for (i, (condition, body)) in arms.iter().enumerate() {
                    let word = if i == 0 { "IF" } else { "ELSEIF" };
                    self.line(&format!("{word} {} THEN", expression(condition)));
                    self.block(body);
                }
                if let Some(body) = otherwise {
                    self.line("ELSE");
                    self.block(body);
                }
                self.line("ENDIF");
            }
            StatementKind::For {
                variable,
                from,
                to,
                step,
                body,
            } => {
                let step = step.as_ref();
                let step = step.map_or(String::new(), |s| format!(" STEP {}", expression(s)));
                self.line(&format!(
                    "FOR {} FROM {} TO {}{step} DO",
                    variable.text,
                    expression(from),
                    expression(to)
                ));
                self.block(body);
                self.line("ENDFOR");
            }
            StatementKind::While { condition, body } => {
                self.line(&format!("WHILE {} DO", expression(condition)));
                self.block(body);
                self.line("ENDWHILE");
            }
            StatementKind::Test {
                subject,
                cases,
                default,
            } => {
                self.line(&format!("TEST {}", expression(subject)));
                for (values, body) in cases {
                    self.line(&format!("CASE {}:", list(values)));
                    self.block(body);
                }
                if let Some(body) = default {
                    self.line("DEFAULT:");
                    self.block(body);
                }
                self.line("ENDTEST");
            }
            StatementKind::Goto(label) => self.line(&format!("GOTO {};", label.text)),
            StatementKind::Label(label) => self.line(&format!("{}:", label.text)),
            StatementKind::Return(None) => self.line("RETURN;"),
            StatementKind::Return(Some(value)) => {
                self.line(&format!("RETURN {};", expression(value)));
            }
            StatementKind::Raise(None) => self.line("RAISE;"),
            StatementKind::Raise(Some(value)) => {
                self.line(&format!("RAISE {};", expression(value)));
            }
            StatementKind::Retry => self.line("RETRY;"),
            StatementKind::TryNext => self.line("TRYNEXT;"),
            StatementKind::Exit => self.line("EXIT;"),
            StatementKind::Connect { variable, trap } => {
                self.line(&format!(
                    "CONNECT {} WITH {};",
                    expression(variable),
                    trap.text
                ));
            }
            StatementKind::Broken => self.line("<SMT>"),
        }
    }
}

fn local(local: bool) -> &'static str {
    if local { "LOCAL " } else { "" }
}

fn parameters(parameters: &[Parameter]) -> String {
    let mut text = String::new();
    for (i, parameter) in parameters.iter().enumerate() {
        let alternative = i > 0 && parameters[i - 1].group == parameter.group;
        if alternative {
            text.push_str(" | ");
        } else if parameter.optional {
            text.push_str(if i == 0 { "\\" } else { " \\" });
        } else if i > 0 {
            text.push_str(", ");
        }
        text.push_str(match parameter.mode {
            Mode::Value => "",
            Mode::Var => "VAR ",
            Mode::Inout => "INOUT ",
            Mode::Pers => "PERS ",
        });
        text.push_str(&parameter.type_name.text);
        text.push(' ');
        text.push_str(&parameter.name.text);
        if parameter.dimensions > 0 {
            let stars = vec!["*"; parameter.dimensions];
            let _ = write!(text, "{{{}}}", stars.join(","));
        }
    }
    text
}

fn list(items: &[Expression]) -> String {
    let items: Vec<_> = items.iter().map(expression).collect();
    items.join(", ")
}

/// Arguments of an instruction, with the blank before them.
fn behind(list: &[Argument]) -> String {
    let text = arguments(list);
    if text.is_empty() || text.starts_with(' ') {
        text
    } else {
        format!(" {text}")
    }
}

fn arguments(arguments: &[Argument]) -> String {
    let mut text = String::new();
    for (i, argument) in arguments.iter().enumerate() {
        match argument {
            Argument::Positional(value) => {
                text.push_str(if i == 0 { "" } else { ", " });
                text.push_str(&expression(value));
            }
            Argument::Named { name, value } => {
                text.push_str(" \\");
                text.push_str(&name.text);
                if let Some(value) = value {
                    text.push_str(":=");
                    text.push_str(&expression(value));
                }
            }
            Argument::Conditional { name, from } => {
                let _ = write!(text, " \\{}?{}", name.text, from.text);
            }
        }
    }
    text
}

/// How tightly an expression binds: a higher level may stand inside a lower one without parentheses.
fn level(expression: &Expression) -> u8 {
    match &expression.kind {
        ExpressionKind::Not(_) => 0,
        ExpressionKind::Binary(operator, ..) => operator_level(*operator),
        ExpressionKind::Negate(_) => 6,
        ExpressionKind::Number { value, .. } if value.is_sign_negative() => 6,
        ExpressionKind::Number { .. } | ExpressionKind::Broken => 7,
        _ => 8,
    }
}

fn operator_level(operator: Operator) -> u8 {
    match operator {
        Operator::Or | Operator::Xor => 1,
        Operator::And => 2,
        Operator::Equal
        | Operator::NotEqual
        | Operator::Less
        | Operator::LessOrEqual
        | Operator::Greater
        | Operator::GreaterOrEqual => 3,
        Operator::Add | Operator::Subtract => 4,
        Operator::Multiply | Operator::Divide | Operator::Div | Operator::Mod => 5,
    }
}

/// An operand that must bind at least as tightly as `needed`.
fn operand(operand: &Expression, needed: u8) -> String {
    let text = expression(operand);
    if level(operand) < needed {
        format!("({text})")
    } else {
        text
    }
}

fn expression(tree: &Expression) -> String {
    match &tree.kind {
        ExpressionKind::Number { value, integer } => number(*value, *integer),
        ExpressionKind::Text(text) => string(text),
        ExpressionKind::Bool(value) => (if *value { "TRUE" } else { "FALSE" }).to_owned(),
        ExpressionKind::Name(name) => name.clone(),
        ExpressionKind::Field(inner, field) => format!("{}.{}", operand(inner, 8), field.text),
        ExpressionKind::Index(inner, indexes) => {
            format!("{}{{{}}}", operand(inner, 8), list(indexes))
        }
        ExpressionKind::Call {
            name,
            arguments: given,
        } => format!("{}({})", name.text, arguments(given)),
        ExpressionKind::Aggregate(items) => format!("[{}]", list(items)),
        ExpressionKind::Negate(inner) => format!("-{}", operand(inner, 8)),
        ExpressionKind::Not(inner) => format!("NOT {}", operand(inner, 3)),
        ExpressionKind::Binary(operator, left, right) => {
            let level = operator_level(*operator);
            // A comparison is not followed by another.
            let needed = if level == 3 { 4 } else { level };
            format!(
                "{} {} {}",
                operand(left, needed),
                operator.text(),
                operand(right, level + 1)
            )
        }
        ExpressionKind::Broken => "<EXP>".to_owned(),
    }
}

fn number(value: f64, integer: bool) -> String {
    if integer {
        return format!("{value:.0}");
    }
    let size = value.abs();
    if size != 0.0 && !(1e-5..1e15).contains(&size) {
        return format!("{value:e}");
    }
    let text = value.to_string();
    if text.contains('.') {
        text
    } else {
        format!("{text}.0")
    }
}

fn string(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\"\""),
            '\\' => quoted.push_str("\\\\"),
            c if u32::from(c) < 32 => {
                let _ = write!(quoted, "\\{:02X}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}
