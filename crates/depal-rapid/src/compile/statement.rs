use depal_vm::{BinaryOp, Diagnostic, Op, Span, Value};

use super::expression::is_place;
use super::scope::{Access, Callee, Compiler, DataSymbol, RoutineSymbol, Signature, Slot, Symbol};
use super::types::Type;
use crate::syntax::tree::*;

impl Compiler<'_> {
    pub(crate) fn statements(&mut self, statements: &[Statement]) {
        for statement in statements {
            self.statement(statement);
        }
    }

    fn begin(&mut self, span: Span) -> usize {
        let line = self.line(span);
        self.emit(Op::Statement { line, next: 0 })
    }

    fn statement(&mut self, statement: &Statement) {
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

    fn connect(&mut self, variable: &Expression, trap: &Name) {
        let routine = if let Some(Symbol::Routine(RoutineSymbol {
            callee: Callee::Trap(routine),
            ..
        })) = self.lookup(&trap.key())
        {
            *routine
        } else {
            self.error(Diagnostic::error(
                "RAPID0101",
                trap.span,
                format!("there is no TRAP named {}", trap.text),
            ));
            return;
        };
        self.check_assignable(variable);
        let kind = self.place(variable);
        if !Type::Num.accepts(&kind) {
            self.mismatch(variable.span, &Type::Num, &kind);
        }
        self.emit(Op::Connect(routine));
    }

    /// Arguments of a call by name: data are given by reference, the callee takes what it needs.
    fn call_by_name(&mut self, name: &Expression, arguments: &[Argument]) {
        self.value(name, Some(&Type::Text));
        for argument in arguments {
            let Argument::Positional(value) = argument else {
                self.error(
                    Diagnostic::error(
                        "RAPID0112",
                        argument.span(),
                        "optional arguments of a call by name are not simulated",
                    )
                    .help("call the procedure by its own name, or leave the argument out"),
                );
                continue;
            };
            if is_place(value) && self.root_data(value).is_some() {
                self.place(value);
            } else {
                self.value(value, None);
            }
        }
        self.emit(Op::CallByName {
            arguments: arguments.len() as u32,
        });
    }

    fn only_in_handler(&mut self, what: &str, span: Span) {
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

    fn label(&mut self, label: &Name) {
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
            } else {
                self.error(Diagnostic::error(
                    "RAPID0115",
                    span,
                    format!("there is no label {label} in this routine"),
                ));
            }
        }
    }

    fn assign(&mut self, target: &Expression, value: &Expression) {
        if !is_place(target) {
            self.error(Diagnostic::error(
                "RAPID0108",
                target.span,
                "only variables can be assigned to",
            ));
            return;
        }
        if let ExpressionKind::Name(name) = &target.kind {
            let key = name.to_lowercase();
            if self.lookup(&key).is_none()
                && let Some((signal, kind)) = self.lookup_signal(&key)
            {
                self.error(
                    Diagnostic::error(
                        "RAPID0130",
                        target.span,
                        format!("{signal} is a signal and is not assigned to"),
                    )
                    .help(match kind {
                        crate::SignalKind::Go => format!("write SetGO {signal}, value;"),
                        _ => format!("write SetDO {signal}, value;"),
                    }),
                );
                return;
            }
            match self.lookup(&key).cloned() {
                Some(Symbol::Data(data)) => {
                    self.check_assignable(target);
                    self.value(value, Some(&data.kind));
                    self.check_value_type(&data.kind, target.span);
                    match data.slot {
                        Slot::Global(slot) => self.emit(Op::StoreGlobal(slot)),
                        Slot::Local(slot) => self.emit(Op::StoreLocal(slot)),
                    };
                    return;
                }
                Some(Symbol::Routine(_)) => {}
                None => {
                    let mut diagnostic = Diagnostic::error(
                        "RAPID0100",
                        target.span,
                        format!("there are no data named {name}"),
                    );
                    if let Some(near) = self.nearest(name, |s| matches!(s, Symbol::Data(_))) {
                        diagnostic = diagnostic.help(format!("did you mean {near}?"));
                    }
                    self.error(diagnostic);
                    self.value(value, None);
                    self.emit(Op::Pop);
                    return;
                }
            }
        }
        self.check_assignable(target);
        let kind = self.place(target);
        self.value(value, Some(&kind));
        self.check_value_type(&kind, target.span);
        self.emit(Op::StorePlace);
    }

    fn check_value_type(&mut self, kind: &Type, span: Span) {
        if matches!(kind, Type::Socket | Type::Clock | Type::Raw) {
            let name = self.type_name(kind);
            let mut diagnostic = Diagnostic::error(
                "RAPID0131",
                span,
                format!("data of type {name} cannot be assigned"),
            );
            if *kind == Type::Raw {
                diagnostic = diagnostic.help("copy with CopyRawBytes");
            }
            self.error(diagnostic);
        }
    }

    fn call(&mut self, name: &Name, arguments: &[Argument]) {
        let Some(routine) = self.lookup_routine(name, false) else {
            return;
        };
        if routine.signature.result.is_some() {
            self.error(
                Diagnostic::error(
                    "RAPID0111",
                    name.span,
                    format!("{} is a function; its value must be used", name.text),
                )
                .help(format!("write x := {}(..);", name.text)),
            );
            return;
        }
        if routine.callee == Callee::WaitUntil {
            self.wait_until(&routine.signature, name, arguments);
            return;
        }
        if let Callee::Trap(_) = routine.callee {
            self.error(
                Diagnostic::error(
                    "RAPID0111",
                    name.span,
                    format!("{} is a TRAP and cannot be called", name.text),
                )
                .help("a TRAP runs when its interrupt comes: CONNECT .. WITH .."),
            );
            return;
        }
        let count = self.arguments(&routine.signature, name, arguments);
        match routine.callee {
            Callee::Routine(routine) => self.emit(Op::Call {
                routine,
                arguments: count,
            }),
            Callee::Builtin(builtin) => self.emit(Op::CallBuiltin {
                builtin,
                arguments: count,
                result: false,
            }),
            Callee::ResetRetryCount => self.emit(Op::ResetRetries),
            Callee::WaitUntil | Callee::Trap(_) => 0,
        };
    }

    /// `WaitUntil` evaluates its condition anew each time it is asked.
    fn wait_until(&mut self, signature: &Signature, name: &Name, arguments: &[Argument]) {
        let matched = self.match_arguments(signature, name, arguments);
        let given = |key: &str| {
            let index = signature.parameters.iter().position(|p| p.key == key)?;
            matched[index]
        };
        let value = |argument: Option<&Argument>| match argument {
            Some(
                Argument::Positional(value)
                | Argument::Named {
                    value: Some(value), ..
                },
            ) => Some(value.clone()),
            _ => None,
        };
        let in_position = given("inpos").is_some() || given("zerospeed").is_some();
        let condition = value(given("cond"));
        let max_time = value(given("maxtime"));
        let time_flag = value(given("timeflag"));
        let limit = max_time.map(|max_time| {
            let slot = self.new_local(Value::Num(0.0));
            self.value(&max_time, Some(&Type::Num));
            self.emit(Op::SetLocal(slot));
            slot
        });
        self.emit(Op::WaitBegin);
        let again = self.here();
        if in_position && let Some(builtin) = self.table.operator("standing") {
            self.emit(Op::CallBuiltin {
                builtin,
                arguments: 0,
                result: true,
            });
        } else {
            self.emit(Op::Push(Value::Bool(true)));
        }
        let moving = self.emit(Op::JumpIfFalseKeep(0));
        if let Some(condition) = condition {
            self.value(&condition, Some(&Type::Bool));
        } else {
            self.emit(Op::Push(Value::Bool(true)));
        }
        self.emit(Op::Binary(BinaryOp::And));
        self.patch_here(moving);
        let waiting = self.emit(Op::JumpIfFalse(0));
        if let Some(flag) = &time_flag {
            self.store(flag, false);
        }
        let over = self.emit(Op::Jump(0));
        self.patch_here(waiting);
        let mut ends = vec![over];
        if let Some(slot) = limit {
            self.emit(Op::WaitElapsed);
            self.emit(Op::LoadLocal(slot));
            self.emit(Op::Unary(depal_vm::UnaryOp::ToDnum));
            self.emit(Op::Binary(BinaryOp::GreaterOrEqual));
            let not_yet = self.emit(Op::JumpIfFalse(0));
            if let Some(flag) = &time_flag {
                self.store(flag, true);
                ends.push(self.emit(Op::Jump(0)));
            } else {
                let error = crate::errors::error(
                    "ERR_WAIT_MAXTIME",
                    "the condition of WaitUntil did not come true within \\MaxTime",
                );
                self.emit(Op::RaiseError(Box::new(error)));
            }
            self.patch_here(not_yet);
        }
        self.emit(Op::Block(again));
        for end in ends {
            self.patch_here(end);
        }
    }

    fn store(&mut self, target: &Expression, value: bool) {
        let kind = self.place(target);
        if !Type::Bool.accepts(&kind) {
            self.mismatch(target.span, &Type::Bool, &kind);
        }
        self.emit(Op::Push(Value::Bool(value)));
        self.emit(Op::StorePlace);
    }

    fn if_statement(
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

    fn for_statement(
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

    fn test_statement(
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

    fn return_statement(&mut self, value: Option<&Expression>, span: Span) {
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
