//! A listing as a routine: its lines in order, blocks and labels.

use depal_syntax::{Diagnostic, Span};
use depal_vm::{Op, Routine, Value};

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
        for (at, line) in listing.lines.iter().enumerate() {
            if self.body.taken.contains(&at) {
                self.end_select();
                self.begin_statement(line.number);
                continue;
            }
            self.look_ahead(&listing.lines, at);
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

    /// Constant outputs right behind a CNT move are switched in its corner, and the arm does not stop for them.
    fn look_ahead(&mut self, lines: &[Line], at: usize) {
        let Statement::Motion(motion) = &lines[at].statement else {
            return;
        };
        let is_corner = matches!(motion.termination, Termination::Continuous(_));
        if !is_corner || motion.options.skip.is_some() || motion.options.block {
            return;
        }
        for (index, line) in lines.iter().enumerate().skip(at + 1) {
            match &line.statement {
                Statement::Comment(_) | Statement::Empty => {}
                Statement::Action(action) if self.is_constant_output(action) => {
                    self.body.taken.insert(index);
                    self.body.in_corner.push(Along {
                        when: AlongWhen::DistanceBefore,
                        amount: Expr {
                            kind: ExprKind::Number {
                                value: 0.0,
                                is_real: true,
                            },
                            span: line.span,
                        },
                        action: action.clone(),
                        span: line.span,
                    });
                }
                _ => break,
            }
        }
    }

    fn is_constant_output(&self, action: &Action) -> bool {
        let Action::Assign(item, Change::Value(value)) = action else {
            return false;
        };
        let is_number = |e: &Expr| matches!(e.kind, ExprKind::Number { .. });
        let fits = match item.kind {
            ItemKind::Do | ItemKind::Ro => {
                matches!(value.kind, ExprKind::Switch(_)) && !self.has_groups
            }
            ItemKind::Go | ItemKind::Ao => is_number(value),
            _ => false,
        };
        fits && item.indexes.len() == 1 && item.indexes.iter().all(is_number)
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
