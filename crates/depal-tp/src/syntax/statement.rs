//! One instruction.

use depal_syntax::{Diagnostic, Span};

use super::cursor::{Cursor, Parsed};
use super::keywords::STATEMENTS;
use super::lexer::Kind;
use super::tree::*;

impl Cursor<'_> {
    pub fn statement(&mut self) -> Parsed<Statement> {
        let statement = self.begin()?;
        self.expect_end()?;
        Ok(statement)
    }

    fn begin(&mut self) -> Parsed<Statement> {
        if self.is_at_end() {
            return Ok(Statement::Empty);
        }
        let span = self.span();
        if self.is_symbol("=") {
            self.advance();
            let value = self.unary_value()?;
            self.expect(",")?;
            let action = self.action()?;
            return Ok(Statement::Case { value, action });
        }
        let Some(Kind::Word(word)) = self.peek() else {
            return self.expected("an instruction");
        };
        let keyword = self.keyword();
        let is_position =
            matches!(self.keyword_at(1).as_str(), "P" | "PR") && self.is_symbol_at(2, "[");
        match keyword.as_str() {
            "J" | "L" | "C" | "A" | "S" | "K" if is_position => return self.motion(),
            _ => {}
        }
        if self.item_kind().is_some() && keyword != "TIMER" {
            return Ok(Statement::Action(self.assignment()?));
        }
        Ok(match keyword.as_str() {
            "LBL" => {
                self.advance();
                Statement::Label(self.index()?)
            }
            "RUN" => {
                self.advance();
                Statement::Run(self.call()?)
            }
            "IF" => {
                self.advance();
                let condition = self.expression()?;
                if self.accept_keyword("THEN") {
                    return Ok(Statement::IfThen(condition));
                }
                self.expect(",")?;
                Statement::If(condition, self.action()?)
            }
            "ELSE" => {
                self.advance();
                if self.accept(",") {
                    Statement::CaseElse(self.action()?)
                } else {
                    Statement::Else
                }
            }
            "ENDIF" => {
                self.advance();
                Statement::EndIf
            }
            "FOR" => {
                self.advance();
                self.for_loop()?
            }
            "ENDFOR" => {
                self.advance();
                Statement::EndFor
            }
            "SELECT" => {
                self.advance();
                let subject = self.unary_value()?;
                self.expect("=")?;
                let value = self.unary_value()?;
                self.expect(",")?;
                let action = self.action()?;
                Statement::Select {
                    subject,
                    value,
                    action,
                }
            }
            "WAIT" => {
                self.advance();
                self.wait()?
            }
            "SKIP" if self.keyword_at(1) == "CONDITION" => {
                self.advance();
                self.advance();
                Statement::SkipCondition(self.expression()?)
            }
            "OFFSET" if self.keyword_at(1) == "CONDITION" => {
                self.advance();
                self.advance();
                let offset = self.register(ItemKind::Pr)?;
                let frame = if self.accept(",") {
                    Some(self.register(ItemKind::Uframe)?)
                } else {
                    None
                };
                Statement::OffsetCondition { offset, frame }
            }
            "TOOL_OFFSET" if self.keyword_at(1) == "CONDITION" => {
                self.advance();
                self.advance();
                let offset = self.register(ItemKind::Pr)?;
                let tool = if self.accept(",") {
                    Some(self.register(ItemKind::Utool)?)
                } else {
                    None
                };
                Statement::ToolOffsetCondition { offset, tool }
            }
            "PAYLOAD" => {
                self.advance();
                Statement::Payload(self.index()?)
            }
            "UALM" => {
                self.advance();
                Statement::UserAlarm(self.index()?)
            }
            "MESSAGE" => {
                self.advance();
                let Some(Kind::Text(text)) = self.peek() else {
                    return self.expected("a text in brackets");
                };
                self.advance();
                Statement::Message(text.clone())
            }
            "LOCK" | "UNLOCK" if self.keyword_at(1) == "PREG" => {
                self.advance();
                self.advance();
                Statement::Nothing(format!("{keyword} PREG"))
            }
            "COL" => {
                while !self.is_at_end() {
                    self.advance();
                }
                Statement::Nothing("COL DETECT".into())
            }
            // The condition of the drive enable in German listings: the program goes on when it holds.
            "FB" if self.is_symbol_at(1, "-") => {
                self.advance();
                self.advance();
                self.advance();
                Statement::WaitUntil {
                    condition: self.expression()?,
                    timeout: None,
                }
            }
            "MONITOR" | "WHEN" | "LINEAR_MAX_SPEED" | "JOINT_MAX_SPEED" | "DIAG_REC"
            | "STOP_TRACKING" | "CALIB" | "RSR" | "VISION" | "TRACK" | "PAUSE_TRACKING"
            | "ENABLE" | "DISABLE" | "ARC" | "WEAVE" | "SPOT" | "SENSOR_ON" | "SENSOR_OFF"
            | "STICK" | "TORQ_LIMIT" | "ERROR_PROG" | "RESUME_PROG" | "CLEAR_RESUME_PROG"
            | "MAINT_PROG" | "RETURN_PATH_DSBL" | "POINT_LOGIC" | "PRINT" | "GET_VAR"
            | "SET_VAR" | "INDEPENDENT" | "SIMULTANEOUS" => {
                while !self.is_at_end() {
                    self.advance();
                }
                Statement::Action(Action::Unsupported(word.clone()))
            }
            "CALL" | "JMP" | "PAUSE" | "ABORT" | "END" | "TIMER" => {
                Statement::Action(self.action()?)
            }
            _ => return self.unknown(word, span),
        })
    }

    fn unknown<T>(&mut self, word: &str, span: Span) -> Parsed<T> {
        let mut message =
            Diagnostic::error("TP0020", span, format!("there is no instruction {word}"));
        let known = STATEMENTS.iter().map(|known| (*known).to_owned());
        if let Some(near) = depal_syntax::nearest_name(word, known) {
            message = message.help(format!("did you mean {near}?"));
        }
        self.fail(message)
    }

    /// `PR[...]`, `UFRAME[...]`: its index.
    pub fn register(&mut self, kind: ItemKind) -> Parsed<Expr> {
        let span = self.span();
        let item = self.item()?;
        let mut indexes = item.indexes.into_iter();
        if let (true, Some(index), None) = (item.kind == kind, indexes.next(), indexes.next()) {
            return Ok(index);
        }
        let name = kind.name();
        self.fail(Diagnostic::error(
            "TP0019",
            span,
            format!("expected {name}[...] here"),
        ))
    }

    pub fn action(&mut self) -> Parsed<Action> {
        let keyword = self.keyword();
        let span = self.span();
        Ok(match keyword.as_str() {
            "JMP" => {
                self.advance();
                if !self.accept_keyword("LBL") {
                    return self.expected("LBL[...]");
                }
                Action::Jump(self.index()?)
            }
            "CALL" => {
                self.advance();
                Action::Call(self.call()?)
            }
            "PAUSE" => {
                self.advance();
                Action::Pause
            }
            "ABORT" => {
                self.advance();
                Action::Abort
            }
            "END" => {
                self.advance();
                Action::End
            }
            _ if self.item_kind().is_some() => self.assignment()?,
            _ => {
                let found = self.found();
                return self.fail(
                    Diagnostic::error(
                        "TP0021",
                        span,
                        format!("expected an instruction here, found {found}"),
                    )
                    .help(
                        "JMP LBL[...], CALL ..., an assignment, PAUSE, ABORT or END can stand here",
                    ),
                );
            }
        })
    }

    pub fn call(&mut self) -> Parsed<Call> {
        let span = self.span();
        let Some(Kind::Word(word)) = self.peek() else {
            return self.expected("the name of a program");
        };
        let callee = if self
            .item_kind()
            .is_some_and(|(kind, _)| kind == ItemKind::Sr)
        {
            Callee::Register(self.register(ItemKind::Sr)?)
        } else {
            self.advance();
            let mut name = word.clone();
            let mut end = span;
            // Names may hold hyphens.
            while self.is_symbol("-")
                && self.span().start == end.end
                && let Some(Kind::Word(_) | Kind::Number { .. }) = self.peek_at(1)
            {
                self.advance();
                end = self.span();
                name.push('-');
                name.push_str(&self.found());
                self.advance();
            }
            Callee::Name(Name {
                text: name,
                span: span.to(end),
            })
        };
        let mut arguments = Vec::new();
        let opened = self.span();
        if self.accept("(") {
            while !self.is_symbol(")") {
                arguments.push(self.expression()?);
                if !self.accept(",") {
                    break;
                }
            }
            self.expect_closing(")", opened)?;
        }
        Ok(Call { callee, arguments })
    }

    pub fn assignment(&mut self) -> Parsed<Action> {
        let item = self.item()?;
        self.expect("=")?;
        let keyword = self.keyword();
        let is_bare = !self.is_symbol_at(1, "[");
        let change = match keyword.as_str() {
            "PULSE" if is_bare => {
                self.advance();
                let width = if self.accept(",") {
                    let width = self.unary_value()?;
                    self.unit_of_seconds();
                    Some(width)
                } else {
                    None
                };
                Change::Pulse(width)
            }
            "START" if item.kind == ItemKind::Timer => {
                self.advance();
                Change::TimerStart
            }
            "STOP" if item.kind == ItemKind::Timer => {
                self.advance();
                Change::TimerStop
            }
            "RESET" if item.kind == ItemKind::Timer => {
                self.advance();
                Change::TimerReset
            }
            _ => {
                let value = self.expression()?;
                if item.kind == ItemKind::Override {
                    self.accept("%");
                }
                Change::Value(value)
            }
        };
        Ok(Action::Assign(item, change))
    }

    /// `sec` or `(sec)` behind a number.
    pub fn unit_of_seconds(&mut self) {
        if self.is_symbol("(") && self.keyword_at(1) == "SEC" && self.is_symbol_at(2, ")") {
            self.advance();
            self.advance();
            self.advance();
        } else {
            self.accept_keyword("SEC");
        }
    }

    fn for_loop(&mut self) -> Parsed<Statement> {
        let span = self.span();
        let counter = self.item()?;
        if counter.kind != ItemKind::R {
            return self.fail(Diagnostic::error(
                "TP0022",
                span.to(counter.span),
                "the counter of FOR is a numeric register, R[...]",
            ));
        }
        self.expect("=")?;
        let from = self.expression()?;
        let down = match self.keyword().as_str() {
            "TO" => false,
            "DOWNTO" => true,
            _ => return self.expected("TO or DOWNTO"),
        };
        self.advance();
        let to = self.expression()?;
        Ok(Statement::For {
            counter,
            from,
            to,
            down,
        })
    }

    fn wait(&mut self) -> Parsed<Statement> {
        let condition = self.expression()?;
        let is_number = match &condition.kind {
            ExprKind::Number { .. } => true,
            ExprKind::Item(item) => matches!(item.kind, ItemKind::R | ItemKind::Ar),
            _ => false,
        };
        if is_number {
            self.unit_of_seconds();
            return Ok(Statement::WaitSeconds(condition));
        }
        self.accept(",");
        let timeout = if self.accept_keyword("TIMEOUT") {
            self.expect(",")?;
            if !self.accept_keyword("LBL") {
                return self.expected("LBL[...]");
            }
            Some(self.index()?)
        } else {
            None
        };
        Ok(Statement::WaitUntil { condition, timeout })
    }
}
