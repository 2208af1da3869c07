//! A listing as a routine: its lines in order, blocks and labels.

use depal_vm::{Diagnostic, Op, Routine, Span, Value};

use super::{Block, Body, Compiler, OpenJump};
use crate::syntax::tree::*;

/// Arguments that a program may have.
pub(super) const ARGUMENTS: usize = 10;

impl Compiler<'_> {
    pub(super) fn routine(&mut self, index: usize) -> Routine {
        let listing = &self.listings[index];
        self.program = index;
        self.body = Body {
            locals: vec![Value::Absent; ARGUMENTS],
            ..Body::default()
        };
        self.collect_labels(listing);
        for line in &listing.lines {
            self.line(line);
        }
        self.end_select();
        self.close_statement();
        self.unclosed();
        self.emit(Op::Return { value: false });
        self.resolve_jumps(listing);
        self.finish_routine(listing)
    }

    fn collect_labels(&mut self, listing: &Listing) {
        for line in &listing.lines {
            let Statement::Label(index) = &line.statement else {
                continue;
            };
            let number = match index.kind {
                ExprKind::Number {
                    value,
                    is_real: false,
                } if (1.0..=32_767.0).contains(&value) => value as u32,
                _ => {
                    let message = "a label has a number from 1 to 32767";
                    self.error(Diagnostic::error("TP0220", index.span, message));
                    continue;
                }
            };
            if let Some((_, first)) = self.body.labels.get(&number) {
                let first = *first;
                self.error(
                    Diagnostic::error("TP0221", line.span, format!("LBL[{number}] is there twice"))
                        .secondary(first, "the first"),
                );
            } else {
                self.body.labels.insert(number, (u32::MAX, line.span));
            }
        }
    }

    fn line(&mut self, line: &Line) {
        match &line.statement {
            Statement::Empty | Statement::Comment(_) | Statement::Nothing(_) => return,
            Statement::Case { .. } | Statement::CaseElse(_) => {}
            _ => self.end_select(),
        }
        if let Statement::Label(index) = &line.statement {
            self.close_statement();
            if let ExprKind::Number { value, .. } = index.kind {
                let here = self.here();
                if let Some(label) = self.body.labels.get_mut(&(value as u32))
                    && label.1 == line.span
                {
                    label.0 = here;
                }
            }
            return;
        }
        self.begin_statement(line.number);
        self.statement(line);
    }

    pub(super) fn begin_statement(&mut self, number: u32) {
        self.close_statement();
        let at = self.emit(Op::Statement {
            line: number,
            next: 0,
        });
        self.body.statement = Some(at);
    }

    /// Tells the statement under way where the next one begins.
    pub(super) fn close_statement(&mut self) {
        let here = self.here();
        if let Some(at) = self.body.statement.take()
            && let Op::Statement { next, .. } = &mut self.body.code[at]
        {
            *next = here;
        }
    }

    fn unclosed(&mut self) {
        for block in std::mem::take(&mut self.body.blocks) {
            let (span, what, end) = match block {
                Block::If { span, .. } => (span, "IF ... THEN", "ENDIF"),
                Block::For { span, .. } => (span, "FOR", "ENDFOR"),
            };
            let message = format!("this {what} has no {end}");
            self.error(Diagnostic::error("TP0222", span, message));
        }
    }

    /// A jump to a label of this program.
    pub(super) fn jump(&mut self, label: &Expr) {
        if let ExprKind::Number { value, .. } = label.kind {
            let at = self.emit(Op::Jump(0));
            self.body.open_jumps.push(OpenJump {
                at,
                label: value as u32,
                span: label.span,
            });
            return;
        }
        // A computed label: compared with each that is there.
        let held = self.new_local();
        self.amount(label);
        self.emit(Op::SetLocal(held));
        let labels: Vec<u32> = self.body.labels.keys().copied().collect();
        for number in labels {
            self.push_number(equal());
            self.emit(Op::LoadLocal(held));
            self.push_number(f64::from(number));
            self.call_builtin("operate", 3, true);
            let next = self.emit(Op::JumpIfFalse(0));
            let at = self.emit(Op::Jump(0));
            self.body.open_jumps.push(OpenJump {
                at,
                label: number,
                span: label.span,
            });
            self.land(next);
        }
        self.emit(Op::LoadLocal(held));
        self.call_builtin("missing label", 1, false);
    }

    fn resolve_jumps(&mut self, listing: &Listing) {
        for jump in std::mem::take(&mut self.body.open_jumps) {
            match self.body.labels.get(&jump.label) {
                Some((target, _)) if *target != u32::MAX => {
                    self.body.code[jump.at] = Op::Jump(*target);
                }
                _ => self.missing_label(listing, jump.label, jump.span),
            }
        }
    }

    fn missing_label(&mut self, listing: &Listing, label: u32, span: Span) {
        let name = &listing.name.text;
        let mut message = Diagnostic::error(
            "TP0223",
            span,
            format!("there is no LBL[{label}] in {name}"),
        );
        let known: Vec<_> = self
            .body
            .labels
            .keys()
            .map(|n| format!("LBL[{n}]"))
            .collect();
        if !known.is_empty() && known.len() <= 12 {
            message = message.help(format!("there is {}", known.join(", ")));
        }
        self.error(message);
    }
}

/// Which row of the operators is `=`.
pub(super) fn equal() -> f64 {
    let at = Operator::ALL
        .iter()
        .position(|(o, ..)| *o == Operator::Equal);
    at.unwrap_or(0) as f64
}

/// Which row of the operators this is.
pub(super) fn row(operator: Operator) -> f64 {
    let at = Operator::ALL.iter().position(|(o, ..)| *o == operator);
    at.unwrap_or(0) as f64
}
