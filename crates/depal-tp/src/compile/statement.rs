//! Instructions.

use depal_syntax::{Diagnostic, Span};
use depal_vm::{Op, Value};

use super::expression::Known;
use super::routine::{equal, row};
use super::{Block, Compiler};
use crate::state;
use crate::syntax::tree::*;

impl Compiler<'_> {
    pub(super) fn statement(&mut self, line: &Line) {
        let span = line.span;
        match &line.statement {
            Statement::Empty
            | Statement::Comment(_)
            | Statement::Label(_)
            | Statement::Nothing(_) => {}
            Statement::Action(action) => self.action(action, span),
            Statement::Run(call) => self.run(call, span),
            Statement::If(condition, action) => {
                self.condition(condition);
                let skip = self.emit(Op::JumpIfFalse(0));
                self.action(action, span);
                self.land(skip);
            }
            Statement::IfThen(condition) => {
                self.condition(condition);
                let skip = self.emit(Op::JumpIfFalse(0));
                self.body.blocks.push(Block::If {
                    span,
                    skip,
                    end: None,
                });
            }
            Statement::Else => self.otherwise(span),
            Statement::EndIf => self.end_if(span),
            Statement::For {
                counter,
                from,
                to,
                down,
            } => self.begin_for(counter, from, to, *down, span),
            Statement::EndFor => self.end_for(span),
            Statement::Select {
                subject,
                value,
                action,
            } => {
                let held = self.new_local();
                self.value(subject);
                self.emit(Op::SetLocal(held));
                self.body.select = Some((held, Vec::new()));
                self.case(value, action, span);
            }
            Statement::Case { value, action } => self.case(value, action, span),
            Statement::CaseElse(action) => {
                if self.body.select.is_some() {
                    self.action(action, span);
                } else {
                    self.stray(span, "ELSE", "SELECT");
                }
            }
            Statement::WaitSeconds(seconds) => {
                self.settle();
                self.amount(seconds);
                self.call_builtin("wait", 1, false);
            }
            Statement::WaitUntil { condition, timeout } => {
                self.wait_until(condition, timeout.as_ref());
            }
            Statement::Motion(motion) => self.motion(motion),
            Statement::SkipCondition(condition) => {
                self.demand(condition, &[Known::Switch], "as a condition");
                let at = self
                    .skip_conditions
                    .iter()
                    .position(|(place, _)| *place == span);
                self.push_number(state::SKIP as f64);
                self.push_number(at.unwrap_or(0) as f64);
                self.call_builtin("condition set", 2, false);
            }
            Statement::OffsetCondition { offset, frame } => {
                self.keep_register(state::OFFSET, offset);
                self.push_number(state::OFFSET_FRAME as f64);
                match frame {
                    Some(frame) => self.amount(frame),
                    None => {
                        self.emit(Op::Push(Value::Bool(false)));
                    }
                }
                self.call_builtin("condition set", 2, false);
            }
            Statement::ToolOffsetCondition { offset, tool } => {
                if tool.is_some() {
                    self.refuse(span, "TOOL_OFFSET CONDITION with a tool of its own");
                }
                self.keep_register(state::TOOL_OFFSET, offset);
            }
            Statement::Payload(index) => {
                self.push_number(state::PAYLOAD as f64);
                self.amount(index);
                self.call_builtin("number set", 2, false);
            }
            Statement::UserAlarm(index) => {
                self.settle();
                self.amount(index);
                self.call_builtin("alarm", 1, false);
            }
            Statement::Message(text) => {
                self.settle();
                self.push_text(text.clone());
                self.call_builtin("message", 1, false);
            }
        }
    }

    fn keep_register(&mut self, which: usize, index: &Expr) {
        self.push_number(which as f64);
        self.amount(index);
        self.call_builtin("pr get", 1, true);
        self.call_builtin("condition set", 2, false);
    }

    pub(super) fn action(&mut self, action: &Action, span: Span) {
        match action {
            Action::Jump(label) => self.jump(label),
            Action::Call(call) => self.call(call, span),
            Action::Assign(item, change) => self.assign(item, change, span),
            Action::Pause => self.call_builtin("pause", 0, false),
            Action::Abort => self.call_builtin("abort", 0, false),
            Action::End => {
                self.emit(Op::Return { value: false });
            }
            Action::Unsupported(word) => self.refuse(span, word),
        }
    }

    fn assign(&mut self, item: &Item, change: &Change, span: Span) {
        match change {
            Change::Value(value) => {
                use Known::{Number, Position, Switch, Text};
                let wanted: &[Known] = match item.kind {
                    ItemKind::R => &[Number, Switch, Text],
                    ItemKind::Sr => &[Text, Number],
                    ItemKind::Pr | ItemKind::P if item.indexes.len() > 1 => &[Number],
                    ItemKind::Pr | ItemKind::P | ItemKind::Uframe | ItemKind::Utool => &[Position],
                    ItemKind::Go | ItemKind::Ao => &[Number],
                    ItemKind::Timer
                    | ItemKind::UframeNum
                    | ItemKind::UtoolNum
                    | ItemKind::Override => &[Number],
                    ItemKind::System => &[Number, Switch, Text, Position],
                    _ => &[Switch, Number],
                };
                self.demand(value, wanted, &format!("for {}", item.kind.name()));
                self.write(item, &|compiler| compiler.value(value));
            }
            Change::Pulse(width) => {
                if !matches!(item.kind, ItemKind::Do | ItemKind::Ro) {
                    let message = format!("{} takes no PULSE; DO and RO do", item.kind.name());
                    self.error(Diagnostic::error("TP0213", span, message));
                    return;
                }
                self.settle();
                self.push_text(item.kind.name());
                for index in &item.indexes {
                    self.amount(index);
                }
                match width {
                    Some(width) => self.amount(width),
                    None => self.push_number(0.1),
                }
                self.call_builtin("signal pulse", 3, false);
            }
            Change::TimerStart | Change::TimerStop | Change::TimerReset => {
                self.settle();
                for index in &item.indexes {
                    self.amount(index);
                }
                let name = match change {
                    Change::TimerStart => "timer start",
                    Change::TimerStop => "timer stop",
                    _ => "timer reset",
                };
                self.call_builtin(name, 1, false);
            }
        }
    }

    fn stray(&mut self, span: Span, what: &str, before: &str) {
        let message = format!("{what} without {before} before it");
        self.error(Diagnostic::error("TP0224", span, message));
    }

    /// ELSE and ENDIF that stand inside a FOR of the same IF.
    fn crossed(&mut self, span: Span, what: &str, block: Block) {
        let opened = match &block {
            Block::If { span, .. } | Block::For { span, .. } => *span,
        };
        let closing = match &block {
            Block::If { .. } => "ENDIF",
            Block::For { .. } => "ENDFOR",
        };
        let message = format!("{what} comes before the {closing} of a block inside");
        self.error(
            Diagnostic::error("TP0225", span, message).secondary(opened, "the block begins here"),
        );
        self.body.blocks.push(block);
    }

    fn otherwise(&mut self, span: Span) {
        match self.body.blocks.pop() {
            Some(Block::If {
                span: opened,
                skip,
                end: None,
            }) => {
                let end = self.emit(Op::Jump(0));
                self.land(skip);
                self.body.blocks.push(Block::If {
                    span: opened,
                    skip,
                    end: Some(end),
                });
            }
            Some(Block::If {
                span: opened,
                skip,
                end,
            }) => {
                self.error(
                    Diagnostic::error("TP0226", span, "a second ELSE")
                        .secondary(opened, "of this IF"),
                );
                self.body.blocks.push(Block::If {
                    span: opened,
                    skip,
                    end,
                });
            }
            Some(block) => self.crossed(span, "ELSE", block),
            None => self.stray(span, "ELSE", "IF ... THEN"),
        }
    }

    fn end_if(&mut self, span: Span) {
        match self.body.blocks.pop() {
            Some(Block::If { skip, end, .. }) => self.land(end.unwrap_or(skip)),
            Some(block) => self.crossed(span, "ENDIF", block),
            None => self.stray(span, "ENDIF", "IF ... THEN"),
        }
    }

    /// The end value is worked out once. The counter keeps the last value it ran with.
    fn begin_for(&mut self, counter: &Item, from: &Expr, to: &Expr, down: bool, span: Span) {
        self.demand(from, &[Known::Number], "as the start of FOR");
        self.demand(to, &[Known::Number], "as the end of FOR");
        let last = self.new_local();
        self.value(to);
        self.emit(Op::SetLocal(last));
        self.write(counter, &|compiler| compiler.value(from));
        let counter = Expr {
            span: counter.span,
            kind: ExprKind::Item(counter.clone()),
        };
        let test = if down {
            Operator::GreaterOrEqual
        } else {
            Operator::LessOrEqual
        };
        self.compare(test, &counter, last);
        let exit = self.emit(Op::JumpIfFalse(0));
        let begin = self.here();
        self.body.blocks.push(Block::For {
            span,
            begin,
            exit,
            counter,
            last,
            down,
        });
    }

    fn compare(&mut self, operator: Operator, value: &Expr, held: u32) {
        self.push_number(row(operator));
        self.value(value);
        self.emit(Op::LoadLocal(held));
        self.call_builtin("operate", 3, true);
    }

    fn end_for(&mut self, span: Span) {
        match self.body.blocks.pop() {
            Some(Block::For {
                begin,
                exit,
                counter,
                last,
                down,
                ..
            }) => {
                let test = if down {
                    Operator::Greater
                } else {
                    Operator::Less
                };
                self.compare(test, &counter, last);
                let over = self.emit(Op::JumpIfFalse(0));
                if let ExprKind::Item(item) = &counter.kind {
                    let step = row(if down {
                        Operator::Subtract
                    } else {
                        Operator::Add
                    });
                    self.write(item, &|compiler| {
                        compiler.push_number(step);
                        compiler.value(&counter);
                        compiler.push_number(1.0);
                        compiler.call_builtin("operate", 3, true);
                    });
                }
                self.emit(Op::Jump(begin));
                self.land(over);
                self.land(exit);
            }
            Some(block) => self.crossed(span, "ENDFOR", block),
            None => self.stray(span, "ENDFOR", "FOR"),
        }
    }

    fn case(&mut self, value: &Expr, action: &Action, span: Span) {
        let Some((held, _)) = self.body.select else {
            self.stray(span, "a case", "SELECT");
            return;
        };
        self.push_number(equal());
        self.emit(Op::LoadLocal(held));
        self.value(value);
        self.call_builtin("operate", 3, true);
        let next = self.emit(Op::JumpIfFalse(0));
        self.action(action, span);
        let end = self.emit(Op::Jump(0));
        if let Some((_, ends)) = &mut self.body.select {
            ends.push(end);
        }
        self.land(next);
    }

    pub(super) fn end_select(&mut self) {
        if let Some((_, ends)) = self.body.select.take() {
            for end in ends {
                self.land(end);
            }
        }
    }

    fn wait_until(&mut self, condition: &Expr, timeout: Option<&Expr>) {
        self.settle();
        self.emit(Op::WaitBegin);
        let again = self.here();
        self.condition(condition);
        let wait = self.emit(Op::JumpIfFalse(0));
        let end = self.emit(Op::Jump(0));
        self.land(wait);
        if let Some(label) = timeout {
            self.emit(Op::WaitElapsed);
            self.call_builtin("timed out", 1, true);
            let more = self.emit(Op::JumpIfFalse(0));
            self.jump(label);
            self.land(more);
        }
        self.emit(Op::Block(again));
        self.land(end);
    }
}
