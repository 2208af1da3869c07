//! A tree as text, one statement a line. It reads as the same tree.

use std::fmt::Write;

use super::print_expression::*;
use super::tree::*;

/// A whole file.
pub(crate) fn print(file: &File) -> String {
    let mut printer = Printer::default();
    match &file.name {
        Some(name) => {
            let public = if file.public { " PUBLIC" } else { "" };
            printer.line(&format!("DEFDAT {}{public}", name.text));
            printer.block(&file.data);
            printer.line("ENDDAT");
        }
        None => printer.statements(&file.data),
    }
    for routine in &file.routines {
        printer.routine(routine);
    }
    printer.text
}

#[derive(Default)]
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

    fn block(&mut self, statements: &[Statement]) {
        self.depth += 1;
        self.statements(statements);
        self.depth -= 1;
    }

    fn statements(&mut self, statements: &[Statement]) {
        for statement in statements {
            self.statement(&statement.kind);
        }
    }

    fn routine(&mut self, routine: &Routine) {
        let global = if routine.global { "GLOBAL " } else { "" };
        let parameters: Vec<_> = routine
            .parameters
            .iter()
            .map(|p| {
                let brackets = match p.dimensions {
                    0 => String::new(),
                    n => format!("[{}]", ",".repeat(n - 1)),
                };
                format!("{}{brackets}{}", p.name.text, mode(p.mode))
            })
            .collect();
        let heading = format!("{}({})", routine.name.text, parameters.join(", "));
        if let Some((kind, brackets)) = &routine.result {
            let brackets = if *brackets { "[]" } else { "" };
            self.line(&format!("{global}DEFFCT {}{brackets} {heading}", kind.text));
            self.block(&routine.body);
            self.line("ENDFCT");
        } else {
            self.line(&format!("{global}DEF {heading}"));
            self.block(&routine.body);
            self.line("END");
        }
    }

    fn statement(&mut self, kind: &StatementKind) {
        use StatementKind::{Declare, For, If, Label, Loop, Repeat, Switch, While};
        let e = expression_text;
        match kind {
            Declare(declaration) => {
                let text = declaration_text(declaration);
                self.line(&text);
            }
            If {
                condition,
                body,
                otherwise,
            } => {
                self.line(&format!("IF {} THEN", e(condition)));
                self.block(body);
                if let Some(otherwise) = otherwise {
                    self.line("ELSE");
                    self.block(otherwise);
                }
                self.line("ENDIF");
            }
            For {
                variable,
                from,
                to,
                step,
                body,
            } => {
                let mut text = format!("FOR {} = {} TO {}", e(variable), e(from), e(to));
                if let Some(step) = step {
                    let _ = write!(text, " STEP {}", e(step));
                }
                self.line(&text);
                self.block(body);
                self.line("ENDFOR");
            }
            While { condition, body } => {
                self.line(&format!("WHILE {}", e(condition)));
                self.block(body);
                self.line("ENDWHILE");
            }
            Repeat { body, until } => {
                self.line("REPEAT");
                self.block(body);
                self.line(&format!("UNTIL {}", e(until)));
            }
            Loop(body) => {
                self.line("LOOP");
                self.block(body);
                self.line("ENDLOOP");
            }
            Switch {
                subject,
                cases,
                default,
            } => {
                self.line(&format!("SWITCH {}", e(subject)));
                for (values, body) in cases {
                    let values: Vec<_> = values.iter().map(e).collect();
                    self.line(&format!("CASE {}", values.join(", ")));
                    self.block(body);
                }
                if let Some(default) = default {
                    self.line("DEFAULT");
                    self.block(default);
                }
                self.line("ENDSWITCH");
            }
            Label(label) => self.line(&format!("{}:", label.text)),
            other => {
                let text = simple_text(other);
                self.line(&text);
            }
        }
    }
}

/// A statement of one line.
fn simple_text(kind: &StatementKind) -> String {
    use StatementKind::{
        Assign, Brake, Call, Continue, Exit, Goto, Halt, Interrupt, InterruptDecl, Move, Refused,
        Resume, Return, Trigger, WaitFor, WaitSec,
    };
    let e = expression_text;
    match kind {
        Assign { target, value } => format!("{} = {}", e(target), e(value)),
        Call { name, arguments } => call_text(name, arguments),
        Exit => "EXIT".into(),
        Goto(label) => format!("GOTO {}", label.text),
        Return(None) => "RETURN".into(),
        Return(Some(value)) => format!("RETURN {}", e(value)),
        Halt => "HALT".into(),
        Continue => "CONTINUE".into(),
        WaitFor(condition) => format!("WAIT FOR {}", e(condition)),
        WaitSec(seconds) => format!("WAIT SEC {}", e(seconds)),
        InterruptDecl {
            global,
            number,
            condition,
            routine,
            arguments,
        } => format!(
            "{}INTERRUPT DECL {} WHEN {} DO {}",
            if *global { "GLOBAL " } else { "" },
            e(number),
            e(condition),
            call_text(routine, arguments)
        ),
        Interrupt { action, number } => match number {
            Some(number) => format!("INTERRUPT {} {}", action.text(), e(number)),
            None => format!("INTERRUPT {}", action.text()),
        },
        Brake { hard } => if *hard { "BRAKE F" } else { "BRAKE" }.into(),
        Resume => "RESUME".into(),
        Trigger {
            place,
            delay,
            action,
            priority,
        } => {
            let place = match place {
                TriggerPlace::Distance(distance) => format!("DISTANCE = {}", e(distance)),
                TriggerPlace::Path { distance, on_start } => {
                    let on_start = if *on_start { " ONSTART" } else { "" };
                    format!("PATH = {}{on_start}", e(distance))
                }
            };
            let priority = match priority {
                Some(priority) => format!(" PRIO = {}", e(priority)),
                None => String::new(),
            };
            format!(
                "TRIGGER WHEN {place} DELAY = {} DO {}{priority}",
                e(delay),
                simple_text(&action.kind)
            )
        }
        Move(movement) => move_text(movement),
        Refused(name) => name.text.clone(),
        _ => String::new(),
    }
}

fn move_text(movement: &Move) -> String {
    let points: Vec<_> = movement.points.iter().map(expression_text).collect();
    let mut text = format!("{} {}", movement.word.text(), points.join(", "));
    if let Some(angle) = &movement.angle {
        let _ = write!(text, ", CA {}", expression_text(angle));
    }
    let with: Vec<_> = movement
        .with
        .iter()
        .map(|(target, value)| format!("{} = {}", expression_text(target), expression_text(value)))
        .collect();
    if !with.is_empty() {
        let _ = write!(text, " WITH {}", with.join(", "));
    }
    for word in &movement.approximation {
        let _ = write!(text, " {}", word.text);
    }
    if let Some(frame) = &movement.frame {
        let _ = write!(text, " #{}", frame.text);
    }
    text
}

fn mode(mode: Option<Mode>) -> &'static str {
    match mode {
        None => "",
        Some(Mode::In) => ":IN",
        Some(Mode::Out) => ":OUT",
    }
}

fn item_text(item: &DataItem) -> String {
    let mut text = item.name.text.clone();
    if !item.sizes.is_empty() {
        write_indexes(&mut text, &item.sizes);
    }
    if let Some(value) = &item.value {
        text.push_str(" = ");
        write_expression(&mut text, value);
    }
    text
}

fn declaration_text(declaration: &Declaration) -> String {
    let of = |global: bool| if global { "GLOBAL " } else { "" };
    match declaration {
        Declaration::Data {
            global,
            constant,
            type_name,
            items,
        } => {
            let constant = if *constant { "CONST " } else { "" };
            let items: Vec<_> = items.iter().map(item_text).collect();
            format!(
                "DECL {}{constant}{} {}",
                of(*global),
                type_name.text,
                items.join(", ")
            )
        }
        Declaration::Struc {
            global,
            name,
            fields,
        } => {
            let fields: Vec<_> = fields
                .iter()
                .map(|(kind, item)| format!("{} {}", kind.text, item_text(item)))
                .collect();
            format!("{}STRUC {} {}", of(*global), name.text, fields.join(", "))
        }
        Declaration::Enum {
            global,
            name,
            constants,
        } => {
            let constants: Vec<_> = constants.iter().map(|c| c.text.clone()).collect();
            format!("{}ENUM {} {}", of(*global), name.text, constants.join(", "))
        }
        Declaration::Signal {
            global,
            name,
            from,
            to,
        } => {
            let mut text = format!(
                "{}SIGNAL {} {}",
                of(*global),
                name.text,
                expression_text(from)
            );
            if let Some(to) = to {
                let _ = write!(text, " TO {}", expression_text(to));
            }
            text
        }
        Declaration::External {
            result,
            name,
            parameters,
        } => {
            let parameters: Vec<_> = parameters
                .iter()
                .map(|(kind, brackets, m)| {
                    let brackets = if *brackets { "[]" } else { "" };
                    format!("{}{brackets}{}", kind.text, mode(*m))
                })
                .collect();
            let head = match result {
                Some(result) => format!("EXTFCT {} ", result.text),
                None => "EXT ".into(),
            };
            format!("{head}{}({})", name.text, parameters.join(", "))
        }
    }
}
