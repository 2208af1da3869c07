use depal_syntax::{Diagnostic, Span, nearest_name};
use depal_vm::{BinaryOp, Op, Value};

use super::scope::*;
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    pub(super) fn statements(&mut self, statements: &[Statement]) {
        let mut left: Option<Span> = None;
        let mut ahead = false;
        for statement in statements {
            if let Some(last) = left.take()
                && !matches!(
                    statement.kind,
                    StatementKind::Label(_) | StatementKind::Declare(_) | StatementKind::Broken
                )
            {
                self.error(
                    Diagnostic::warning(
                        "KRL0134",
                        statement.span,
                        "this statement is never reached",
                    )
                    .secondary(last, "the program leaves here"),
                );
            }
            if matches!(
                statement.kind,
                StatementKind::Return(_) | StatementKind::Exit | StatementKind::Goto(_)
            ) {
                left = Some(statement.span);
            }
            self.statement(statement, ahead);
            ahead = matches!(statement.kind, StatementKind::Continue);
        }
    }

    pub(super) fn begin(&mut self, span: Span) -> usize {
        self.body.waited = false;
        let line = self.line(span);
        self.emit(Op::Statement { line, next: 0 })
    }

    /// `ahead`: CONTINUE stands before it.
    fn statement(&mut self, statement: &Statement, ahead: bool) {
        let begin = match &statement.kind {
            StatementKind::Label(label) => {
                self.label(label);
                return;
            }
            StatementKind::Broken | StatementKind::Continue => return,
            StatementKind::Declare(declaration) => {
                self.declare(declaration, statement.span);
                return;
            }
            _ => self.begin(statement.span),
        };
        self.body.ahead = ahead;
        match &statement.kind {
            StatementKind::Assign { target, value } => self.assign(target, value),
            StatementKind::Call { name, arguments } => self.call(name, arguments),
            StatementKind::If {
                condition,
                body,
                otherwise,
            } => self.if_statement(condition, body, otherwise.as_deref()),
            StatementKind::For {
                variable,
                from,
                to,
                step,
                body,
            } => self.for_statement(statement.span, variable, [from, to], step.as_ref(), body),
            StatementKind::While { condition, body } => {
                self.value(condition, Some(&Type::Bool));
                let exit = self.emit(Op::JumpIfFalse(0));
                self.looped(body);
                self.emit(Op::Jump(begin as u32));
                self.patch_here(exit);
                self.end_loop();
            }
            StatementKind::Repeat { body, until } => {
                self.looped(body);
                let line = self.line(until.span);
                self.body.waited = false;
                let last = self.emit(Op::Statement { line, next: 0 });
                self.value(until, Some(&Type::Bool));
                self.emit(Op::JumpIfFalse(begin as u32));
                self.patch_here(last);
                self.end_loop();
            }
            StatementKind::Loop(body) => {
                self.looped(body);
                self.emit(Op::Jump(begin as u32));
                self.end_loop();
            }
            StatementKind::Exit => {
                let at = self.emit(Op::Jump(0));
                match self.body.exits.last_mut() {
                    Some(exits) => exits.push(at),
                    None => self.error(Diagnostic::error(
                        "KRL0116",
                        statement.span,
                        "EXIT has its place in a loop",
                    )),
                }
            }
            StatementKind::Switch {
                subject,
                cases,
                default,
            } => self.switch_statement(subject, cases, default.as_deref()),
            StatementKind::Goto(label) => {
                let at = self.emit(Op::Jump(0));
                self.body.gotos.push((at, label.key(), label.span));
            }
            StatementKind::Return(value) => self.return_statement(value.as_ref(), statement.span),
            StatementKind::Halt => {
                self.stop_advance();
                self.emit(Op::Stop("HALT".into()));
            }
            StatementKind::WaitFor(condition) => self.wait_for(condition),
            StatementKind::WaitSec(seconds) => {
                self.stop_advance();
                self.value(seconds, Some(&Type::Real));
                self.emit_builtin("wait sec", 1, false);
            }
            StatementKind::InterruptDecl {
                global,
                number,
                condition,
                routine,
                arguments,
            } => self.interrupt_declaration(
                *global,
                number,
                condition,
                (routine, arguments),
                statement.span,
            ),
            StatementKind::Interrupt { action, number } => {
                match number {
                    Some(number) => {
                        self.value(number, Some(&Type::Int));
                    }
                    None => {
                        self.emit(Op::Push(Value::Int(0)));
                    }
                }
                self.emit(Op::Push(Value::Int(*action as i64)));
                self.emit_builtin("interrupt switch", 2, false);
            }
            StatementKind::Brake { .. } => self.emit_builtin("brake", 0, false),
            StatementKind::Resume => {
                self.emit_builtin("leave path", 0, false);
                self.emit(Op::Resume);
            }
            StatementKind::Trigger {
                place,
                delay,
                action,
                priority,
            } => self.trigger(place, delay, action, priority.as_ref()),
            StatementKind::Move(movement) => self.movement(movement, statement.span),
            StatementKind::Refused(name) => {
                self.error(Diagnostic::error(
                    "KRL0120",
                    name.span,
                    format!("{} is not simulated", name.text),
                ));
            }
            StatementKind::Label(_)
            | StatementKind::Broken
            | StatementKind::Continue
            | StatementKind::Declare(_) => {}
        }
        self.patch_here(begin);
    }

    fn declare(&mut self, declaration: &Declaration, span: Span) {
        if let Declaration::Data { items, .. } = declaration
            && items.iter().any(|item| item.value.is_some())
        {
            let begin = self.begin(span);
            for item in items {
                self.local_value(item);
            }
            self.patch_here(begin);
        }
    }

    fn label(&mut self, label: &Name) {
        let at = self.here();
        let previous = self.body.labels.insert(label.key(), (at, label.span));
        if let Some((_, first)) = previous {
            self.error(
                Diagnostic::error(
                    "KRL0110",
                    label.span,
                    format!("the label {} stands twice", label.text),
                )
                .secondary(first, "first here"),
            );
        }
    }

    pub(super) fn resolve_gotos(&mut self) {
        let gotos = std::mem::take(&mut self.body.gotos);
        for (at, label, span) in gotos {
            if let Some((target, _)) = self.body.labels.get(&label) {
                let target = *target;
                self.patch(at, target);
                continue;
            }
            let near = nearest_name(&label, self.body.labels.keys().cloned());
            let mut diagnostic = Diagnostic::error(
                "KRL0123",
                span,
                format!("there is no label {label} in this routine"),
            );
            if let Some(near) = near {
                diagnostic = diagnostic.help(format!("did you mean {near}?"));
            }
            self.error(diagnostic);
        }
    }

    fn if_statement(
        &mut self,
        condition: &Expression,
        body: &[Statement],
        otherwise: Option<&[Statement]>,
    ) {
        self.value(condition, Some(&Type::Bool));
        let skip = self.emit(Op::JumpIfFalse(0));
        self.statements(body);
        if let Some(otherwise) = otherwise {
            let end = self.emit(Op::Jump(0));
            self.patch_here(skip);
            self.statements(otherwise);
            self.patch_here(end);
        } else {
            self.patch_here(skip);
        }
    }

    fn switch_statement(
        &mut self,
        subject: &Expression,
        cases: &[(Vec<Expression>, Vec<Statement>)],
        default: Option<&[Statement]>,
    ) {
        let kind = self.value(subject, None);
        if !matches!(
            kind,
            Type::Int | Type::Char | Type::Enum(_) | Type::Bool | Type::Broken
        ) {
            self.operand_error(subject.span, "SWITCH", &kind);
        }
        let slot = self.new_local(Value::Int(0));
        self.emit(Op::SetLocal(slot));
        let mut ends = Vec::new();
        for (values, body) in cases {
            let mut matches = Vec::new();
            for value in values {
                self.value(value, Some(&kind));
                self.emit(Op::LoadLocal(slot));
                self.emit(Op::Binary(BinaryOp::NotEqual));
                matches.push(self.emit(Op::JumpIfFalse(0)));
            }
            let next = self.emit(Op::Jump(0));
            for found in matches {
                self.patch_here(found);
            }
            self.statements(body);
            ends.push(self.emit(Op::Jump(0)));
            self.patch_here(next);
        }
        self.statements(default.unwrap_or_default());
        for end in ends {
            self.patch_here(end);
        }
    }

    fn return_statement(&mut self, value: Option<&Expression>, span: Span) {
        match (value, self.body.result.clone()) {
            (Some(value), Some(kind)) => {
                self.value(value, Some(&kind));
                self.emit(Op::Return { value: true });
            }
            (None, None) => {
                self.emit(Op::Return { value: false });
            }
            (Some(value), None) => self.error(Diagnostic::error(
                "KRL0124",
                value.span,
                "a subprogram (DEF) returns no value",
            )),
            (None, Some(kind)) => {
                let kind = self.type_name(&kind);
                self.error(Diagnostic::error(
                    "KRL0124",
                    span,
                    format!("RETURN needs a value of type {kind} here"),
                ));
            }
        }
    }

    /// The condition is computed anew each time the task is asked.
    fn wait_for(&mut self, condition: &Expression) {
        self.stop_advance();
        let again = self.here();
        self.value(condition, Some(&Type::Bool));
        let not_yet = self.emit(Op::JumpIfFalse(0));
        let over = self.emit(Op::Jump(0));
        self.patch_here(not_yet);
        self.emit(Op::Block(again));
        self.patch_here(over);
    }
}
