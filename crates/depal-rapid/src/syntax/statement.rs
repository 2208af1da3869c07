use depal_syntax::{Diagnostic, Span, Token};

use super::keywords::BLOCK_END;
use super::parser::Parser;
use super::tree::*;

impl Parser<'_> {
    /// Statements up to a word that ends any kind of block; that word is left standing.
    pub(crate) fn block(&mut self) -> Vec<Statement> {
        let mut statements = Vec::new();
        while !self.is_end() {
            if self.is_any_word(&["VAR", "PERS", "CONST"]) {
                let span = self.span();
                self.report_with(
                    Diagnostic::error(
                        "RAPID0018",
                        span,
                        "data are declared before the first statement",
                    )
                    .help("move the declaration to the top of the routine, or to the module"),
                );
                self.data(true);
                continue;
            }
            if self.is_class(BLOCK_END) {
                break;
            }
            let before = self.position();
            if let Some(statement) = self.statement() {
                statements.push(statement);
            }
            if self.position() == before {
                self.advance();
            }
        }
        statements
    }

    fn statement(&mut self) -> Option<Statement> {
        let start = self.span();
        if self.maybe_mark(";") {
            return None;
        }
        let kind = self.nested(|parser| parser.statement_kind(start))?;
        Some(Statement {
            kind,
            span: start.to(self.last_span()),
        })
    }

    fn end_statement(&mut self, why: &str) {
        if !self.expect_mark(";", why) {
            // The next statement is often intact and begins on the next line.
            if !matches!(self.peek(), Token::Name(_)) {
                self.recover();
            }
        }
    }

    fn statement_kind(&mut self, start: Span) -> StatementKind {
        if self.maybe_word("IF") {
            return self.if_statement(start);
        }
        if self.maybe_word("FOR") {
            return self.for_statement(start);
        }
        if self.maybe_word("WHILE") {
            let condition = self.expression();
            self.expect_word("DO", "behind the condition of WHILE");
            let body = self.block();
            self.close("WHILE", "ENDWHILE", start);
            return StatementKind::While { condition, body };
        }
        if self.maybe_word("TEST") {
            return self.test_statement(start);
        }
        if self.maybe_word("GOTO") {
            let Some(label) = self.expect_name("a label") else {
                self.recover();
                return StatementKind::Broken;
            };
            self.end_statement("behind GOTO");
            return StatementKind::Goto(label);
        }
        if self.maybe_word("RETURN") {
            let value = (!self.is_mark(";")).then(|| self.expression());
            self.end_statement("behind RETURN");
            return StatementKind::Return(value);
        }
        if self.maybe_word("RAISE") {
            let value = (!self.is_mark(";")).then(|| self.expression());
            self.end_statement("behind RAISE");
            return StatementKind::Raise(value);
        }
        if self.maybe_word("RETRY") {
            self.end_statement("behind RETRY");
            return StatementKind::Retry;
        }
        if self.maybe_word("TRYNEXT") {
            self.end_statement("behind TRYNEXT");
            return StatementKind::TryNext;
        }
        if self.maybe_word("EXIT") {
            self.end_statement("behind EXIT");
            return StatementKind::Exit;
        }
        if self.maybe_word("CONNECT") {
            self.begin_operators();
            let variable = self.postfix();
            self.expect_word("WITH", "behind the interrupt of CONNECT");
            let Some(trap) = self.expect_name("the name of a TRAP") else {
                self.recover();
                return StatementKind::Broken;
            };
            self.end_statement("behind CONNECT");
            return StatementKind::Connect { variable, trap };
        }
        if self.maybe_mark("%") {
            let name = self.expression();
            if !self.expect_mark("%", "behind the name of the procedure") {
                self.recover();
                return StatementKind::Broken;
            }
            let arguments = self.arguments(";");
            self.end_statement("behind the arguments of the call");
            return StatementKind::CallByName { name, arguments };
        }
        if self.placeholder() {
            self.maybe_mark(";");
            return StatementKind::Broken;
        }
        self.assignment_or_call(start)
    }

    fn assignment_or_call(&mut self, start: Span) -> StatementKind {
        let Some(name) = self.expect_name("a statement") else {
            self.recover();
            return StatementKind::Broken;
        };
        if self.is_mark(":=") || self.is_mark(".") || self.is_mark("{") {
            self.step_back();
            self.begin_operators();
            let target = self.postfix();
            if !self.expect_mark(":=", "of an assignment") {
                self.recover();
                return StatementKind::Broken;
            }
            let value = self.expression();
            self.end_statement("behind the assignment");
            return StatementKind::Assign { target, value };
        }
        if self.maybe_mark(":") {
            return StatementKind::Label(name);
        }
        if self.is_mark("=") {
            let span = self.span();
            self.report_with(
                Diagnostic::error("RAPID0021", span, "an assignment is written with `:=`")
                    .label("`=` compares"),
            );
            self.recover();
            return StatementKind::Broken;
        }
        if self.is_mark("(") {
            // An instruction takes its arguments without parentheses; an expression in parentheses
            // as the first argument is legal, so only an empty pair is surely wrong.
            if matches!(self.peek_after(1), Token::Mark(")")) {
                let span = start.to(self.span());
                self.report_with(
                    Diagnostic::error(
                        "RAPID0022",
                        span,
                        format!("a procedure is called without parentheses: {};", name.text),
                    )
                    .help("parentheses are for functions, whose value is used"),
                );
                self.recover();
                return StatementKind::Broken;
            }
        }
        let arguments = self.arguments(";");
        self.end_statement(&format!("behind the arguments of {}", name.text));
        StatementKind::Call { name, arguments }
    }

    fn if_statement(&mut self, start: Span) -> StatementKind {
        let condition = self.expression();
        if !self.maybe_word("THEN") {
            if self.is_class(BLOCK_END) || self.is_end() || self.is_mark(";") {
                let found = self.describe();
                let diagnostic = Diagnostic::error(
                    "RAPID0010",
                    self.span(),
                    format!(
                        "expected THEN or a statement behind the condition of IF, found {found}"
                    ),
                )
                .secondary(start, "this IF");
                self.report_with(diagnostic);
                self.recover();
                return StatementKind::Broken;
            }
            let body = self.statement().into_iter().collect();
            return StatementKind::If {
                arms: vec![(condition, body)],
                otherwise: None,
            };
        }
        let mut arms = vec![(condition, self.block())];
        let mut otherwise = None;
        loop {
            if self.maybe_word("ELSEIF") {
                let condition = self.expression();
                self.expect_word("THEN", "behind the condition of ELSEIF");
                arms.push((condition, self.block()));
            } else if self.maybe_word("ELSE") {
                otherwise = Some(self.block());
            } else {
                break;
            }
        }
        self.close("IF", "ENDIF", start);
        StatementKind::If { arms, otherwise }
    }

    fn for_statement(&mut self, start: Span) -> StatementKind {
        let Some(variable) = self.expect_name("the loop variable") else {
            self.recover();
            return StatementKind::Broken;
        };
        self.expect_word("FROM", "behind the loop variable");
        let from = self.expression();
        self.expect_word("TO", "behind the start value");
        let to = self.expression();
        let step = self.maybe_word("STEP").then(|| self.expression());
        self.expect_word("DO", "behind the end value");
        let body = self.block();
        self.close("FOR", "ENDFOR", start);
        StatementKind::For {
            variable,
            from,
            to,
            step,
            body,
        }
    }

    fn test_statement(&mut self, start: Span) -> StatementKind {
        let subject = self.expression();
        let mut cases = Vec::new();
        let mut default = None;
        loop {
            if self.maybe_word("CASE") {
                let mut values = Vec::new();
                loop {
                    values.push(self.expression());
                    if !self.maybe_mark(",") {
                        break;
                    }
                }
                self.expect_mark(":", "behind the values of CASE");
                cases.push((values, self.block()));
            } else if self.maybe_word("DEFAULT") {
                self.expect_mark(":", "behind DEFAULT");
                default = Some(self.block());
            } else {
                break;
            }
        }
        self.close("TEST", "ENDTEST", start);
        StatementKind::Test {
            subject,
            cases,
            default,
        }
    }

    /// The closing word of a block, or a message that names the opening one.
    fn close(&mut self, opening: &str, closing: &str, opened: Span) {
        if self.maybe_word(closing) {
            self.maybe_mark(";");
            return;
        }
        let found = self.describe();
        let opened = Span::new(
            opened.file,
            opened.start,
            opened.start + opening.len() as u32,
        );
        let diagnostic = Diagnostic::error(
            "RAPID0014",
            self.span(),
            format!("expected {closing}, found {found}"),
        )
        .secondary(
            opened,
            format!("this {opening}, opened here, has no {closing}"),
        )
        .help(format!("add {closing} where the block ends"));
        self.report_with(diagnostic);
    }
}
