use depal_syntax::{Diagnostic, Span, nearest_name};
use depal_vm::{BinaryOp, Op, Value};

use super::scope::{Access, Compiler, DataSymbol, Slot, Symbol};
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    pub(crate) fn statements(&mut self, statements: &[Statement]) {
        let mut left: Option<Span> = None;
        for statement in statements {
            if let Some(last) = left.take()
                && !matches!(
                    statement.kind,
                    StatementKind::Label(_) | StatementKind::Broken
                )
            {
                self.error(
                    Diagnostic::warning(
                        "RAPID0122",
                        statement.span,
                        "this statement is never reached",
                    )
                    .secondary(last, "the program leaves here"),
                );
            }
            if leaves(&statement.kind, self.body.in_handler) {
                left = Some(statement.span);
            }
            self.statement(statement);
        }
    }

    pub(super) fn begin(&mut self, span: Span) -> usize {
        let line = self.line(span);
        self.emit(Op::Statement { line, next: 0 })
    }

    pub(super) fn statement(&mut self, statement: &Statement) {
        let begin = match &statement.kind {
            StatementKind::Label(label) => {
                self.label(label);
                return;
            }
            StatementKind::Broken => return,
            _ => self.begin(statement.span),
        };
        match &statement.kind {
            StatementKind::Assign { target, value } => self.assign(target, value),
            StatementKind::Call { name, arguments } => self.call(name, arguments),
            StatementKind::If { arms, otherwise } => self.if_statement(arms, otherwise.as_deref()),
            StatementKind::For {
                variable,
                from,
                to,
                step,
                body,
            } => self.for_statement(
                statement.span,
                variable,
                [Some(from), Some(to), step.as_ref()],
                body,
            ),
            StatementKind::While { condition, body } => {
                self.value(condition, Some(&Type::Bool));
                let exit = self.emit(Op::JumpIfFalse(0));
                self.statements(body);
                self.emit(Op::Jump(begin as u32));
                self.patch_here(exit);
            }
            StatementKind::Test {
                subject,
                cases,
                default,
            } => self.test_statement(subject, cases, default.as_deref()),
            StatementKind::Goto(label) => {
                let at = self.emit(Op::Jump(0));
                self.body.gotos.push((at, label.key(), label.span));
            }
            StatementKind::Return(value) => self.return_statement(value.as_ref(), statement.span),
            StatementKind::Raise(Some(number)) => {
                self.value(number, Some(&Type::Num));
                self.emit(Op::Raise);
            }
            StatementKind::Raise(None) => {
                self.only_in_handler("RAISE without a number", statement.span);
                self.emit(Op::Reraise);
            }
            StatementKind::Retry => {
                self.only_in_handler("RETRY", statement.span);
                self.emit(Op::Retry);
            }
            StatementKind::TryNext => {
                self.only_in_handler("TRYNEXT", statement.span);
                self.emit(Op::TryNext);
            }
            StatementKind::Exit => {
                self.emit(Op::Stop("EXIT".into()));
            }
            StatementKind::Connect { variable, trap } => self.connect(variable, trap),
            StatementKind::CallByName { name, arguments } => self.call_by_name(name, arguments),
            StatementKind::Label(_) | StatementKind::Broken => {}
        }
        self.patch_here(begin);
    }

    pub(super) fn only_in_handler(&mut self, what: &str, span: Span) {
        if !self.body.in_handler {
            self.error(
                Diagnostic::error(
                    "RAPID0118",
                    span,
                    format!("{what} has its place in an ERROR clause"),
                )
                .help("move it behind ERROR at the end of the routine"),
            );
        }
    }

    pub(super) fn label(&mut self, label: &Name) {
        let at = self.here();
        let previous = self.body.labels.insert(label.key(), (at, label.span));
        if let Some((_, first)) = previous {
            self.error(
                Diagnostic::error(
                    "RAPID0110",
                    label.span,
                    format!("the label {} stands twice", label.text),
                )
                .secondary(first, "first here"),
            );
        }
    }

    pub(crate) fn resolve_gotos(&mut self) {
        let gotos = std::mem::take(&mut self.body.gotos);
        for (at, label, span) in gotos {
            if let Some((target, _)) = self.body.labels.get(&label) {
                let target = *target;
                self.patch(at, target);
                continue;
            }
            let mut diagnostic = Diagnostic::error(
                "RAPID0115",
                span,
                format!("there is no label {label} in this routine"),
            );
            if let Some(near) = nearest_name(&label, self.body.labels.keys().cloned()) {
                diagnostic = diagnostic.help(format!("did you mean {near}?"));
            }
            self.error(diagnostic);
        }
    }

    pub(super) fn if_statement(
        &mut self,
        arms: &[(Expression, Vec<Statement>)],
        otherwise: Option<&[Statement]>,
    ) {
        let mut ends = Vec::new();
        for (i, (condition, body)) in arms.iter().enumerate() {
            self.value(condition, Some(&Type::Bool));
            let skip = self.emit(Op::JumpIfFalse(0));
            self.statements(body);
            if i + 1 < arms.len() || otherwise.is_some() {
                ends.push(self.emit(Op::Jump(0)));
            }
            self.patch_here(skip);
        }
        if let Some(body) = otherwise {
            self.statements(body);
        }
        for end in ends {
            self.patch_here(end);
        }
    }

    pub(super) fn for_statement(
        &mut self,
        span: Span,
        variable: &Name,
        bounds: [Option<&Expression>; 3],
        body: &[Statement],
    ) {
        for bound in bounds.into_iter().flatten() {
            self.value(bound, Some(&Type::Num));
        }
        let slot = self.new_local(Value::Num(0.0));
        self.new_local(Value::Num(0.0));
        self.new_local(Value::Num(0.0));
        self.emit(Op::ForBegin {
            slot,
            stepped: bounds[2].is_some(),
        });
        let first = self.emit(Op::Jump(0));
        let top = self.begin(span);
        self.patch_here(first);
        let test = self.emit(Op::ForTest { slot, exit: 0 });
        let symbol = Symbol::Data(DataSymbol {
            name: variable.text.clone(),
            slot: Slot::Local(slot),
            kind: Type::Num,
            access: Access::LoopVariable,
            optional: false,
            span: variable.span,
            constant: None,
        });
        let hidden = self.body.scope.insert(variable.key(), symbol);
        self.statements(body);
        match hidden {
            Some(symbol) => self.body.scope.insert(variable.key(), symbol),
            None => self.body.scope.remove(&variable.key()),
        };
        self.emit(Op::ForStep { slot });
        self.emit(Op::Jump(top as u32));
        self.patch_here(test);
        self.patch_here(top);
    }

    pub(super) fn test_statement(
        &mut self,
        subject: &Expression,
        cases: &[(Vec<Expression>, Vec<Statement>)],
        default: Option<&[Statement]>,
    ) {
        let kind = self.value(subject, None);
        let slot = self.new_local(Value::Absent);
        self.emit(Op::SetLocal(slot));
        let mut ends = Vec::new();
        for (values, body) in cases {
            let mut hits = Vec::new();
            for value in values {
                self.emit(Op::LoadLocal(slot));
                self.value(value, Some(&kind));
                self.emit(Op::Binary(BinaryOp::NotEqual));
                hits.push(self.emit(Op::JumpIfFalse(0)));
            }
            let miss = self.emit(Op::Jump(0));
            for hit in hits {
                self.patch_here(hit);
            }
            self.statements(body);
            ends.push(self.emit(Op::Jump(0)));
            self.patch_here(miss);
        }
        if let Some(body) = default {
            self.statements(body);
        }
        for end in ends {
            self.patch_here(end);
        }
    }

    pub(super) fn return_statement(&mut self, value: Option<&Expression>, span: Span) {
        match (self.body.result.clone(), value) {
            (Some(kind), Some(value)) => {
                self.value(value, Some(&kind));
                self.emit(Op::Return { value: true });
            }
            (None, None) => {
                self.emit(Op::Return { value: false });
            }
            (Some(kind), None) => {
                let name = self.type_name(&kind);
                self.error(Diagnostic::error(
                    "RAPID0119",
                    span,
                    format!("RETURN in this function needs a value of type {name}"),
                ));
            }
            (None, Some(value)) => self.error(Diagnostic::error(
                "RAPID0119",
                value.span,
                "RETURN in a procedure has no value",
            )),
        }
    }
}

/// Whether nothing behind the statement runs. What is wrong outside of a handler is reported as that.
fn leaves(statement: &StatementKind, in_handler: bool) -> bool {
    match statement {
        StatementKind::Return(_)
        | StatementKind::Raise(Some(_))
        | StatementKind::Exit
        | StatementKind::Goto(_) => true,
        StatementKind::Raise(None) | StatementKind::Retry | StatementKind::TryNext => in_handler,
        _ => false,
    }
}
