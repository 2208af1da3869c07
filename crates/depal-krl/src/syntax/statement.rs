use depal_syntax::{Span, Token};

use super::keywords::{REFUSED, is_keyword};
use super::parser::Parser;
use super::tree::*;

type Reader<'a> = fn(&mut Parser<'a>, Span) -> Option<StatementKind>;

impl<'a> Parser<'a> {
    pub(super) fn statement(&mut self) -> Statement {
        let begin = self.span();
        let first = self.position();
        let kind = self.statement_kind(begin);
        let mut span = begin;
        if self.position() > first {
            span = begin.to(self.last_span());
        }
        let Some(kind) = kind else {
            self.skip_line();
            self.expect_line_end();
            return Statement {
                kind: StatementKind::Broken,
                span,
            };
        };
        self.expect_line_end();
        Statement { kind, span }
    }

    fn statement_kind(&mut self, begin: Span) -> Option<StatementKind> {
        if let (Token::Name(word), Token::Mark(":")) = (self.peek(), self.peek_after(1))
            && matches!(self.peek_after(2), Token::Line | Token::End)
            && !is_keyword(word)
        {
            let label = self.expect_name("a label")?;
            self.advance();
            return Some(StatementKind::Label(label));
        }
        let Token::Name(word) = self.peek().clone() else {
            let found = self.describe();
            self.report("KRL0011", format!("expected a statement, found {found}"));
            return None;
        };
        let word = word.to_lowercase();
        if let Some(read) = self.control(&word) {
            self.advance();
            return read(self, begin);
        }
        if let Some((_, word)) = MoveWord::ALL
            .iter()
            .find(|(text, _)| text.eq_ignore_ascii_case(&word))
        {
            self.advance();
            return self.movement(*word);
        }
        if REFUSED.contains(&word.as_str()) && !matches!(self.peek_after(1), Token::Mark("=" | "["))
        {
            return Some(self.refused(&word));
        }
        if self.begins_declaration() {
            return self.declaration().map(StatementKind::Declare);
        }
        self.call_or_assignment()
    }

    /// What reads a statement that begins with a word of its own, behind that word.
    fn control(&self, word: &str) -> Option<Reader<'a>> {
        let read: Reader<'a> = match word {
            "if" => Self::if_statement,
            "for" => Self::for_statement,
            "while" => Self::while_statement,
            "repeat" => Self::repeat_statement,
            "loop" => Self::loop_statement,
            "switch" => Self::switch_statement,
            "exit" => |_, _| Some(StatementKind::Exit),
            "halt" => |_, _| Some(StatementKind::Halt),
            "continue" => |_, _| Some(StatementKind::Continue),
            "resume" => |_, _| Some(StatementKind::Resume),
            "brake" => |parser, _| {
                let hard = parser.maybe_word("f");
                Some(StatementKind::Brake { hard })
            },
            "goto" => |parser, _| Some(StatementKind::Goto(parser.expect_name("a label")?)),
            "return" => |parser, _| {
                let value = (!parser.is_line_end()).then(|| parser.expression());
                Some(StatementKind::Return(value))
            },
            "wait" => Self::wait_statement,
            "interrupt" => |parser, _| parser.interrupt(false),
            "global" if matches!(self.peek_after(1), Token::Name(n) if n.eq_ignore_ascii_case("interrupt")) => {
                |parser, _| {
                    parser.advance();
                    parser.interrupt(true)
                }
            }
            "trigger" => Self::trigger,
            _ => return None,
        };
        Some(read)
    }

    fn refused(&mut self, word: &str) -> StatementKind {
        let span = self.span();
        let name = Name {
            text: word.to_uppercase(),
            span,
        };
        self.skip_line();
        if word.ends_with("spline") {
            while !self.is_end() && !self.is_any_word(&["endspline", "end", "endfct"]) {
                self.advance();
            }
            if self.is_word("endspline") {
                self.skip_line();
            }
        }
        StatementKind::Refused(name)
    }

    pub(super) fn call_or_assignment(&mut self) -> Option<StatementKind> {
        if let (Token::Name(word), Token::Mark("(")) = (self.peek(), self.peek_after(1))
            && !is_keyword(word)
        {
            let name = self.expect_name("a routine")?;
            let arguments = self.arguments();
            if !self.is_mark(".") && !self.is_mark("=") {
                return Some(StatementKind::Call { name, arguments });
            }
        }
        let target = self.expression();
        if target.kind == ExpressionKind::Broken {
            return None;
        }
        if let ExpressionKind::Binary(Operator::Equal, left, right) = target.kind {
            let diagnostic = depal_syntax::Diagnostic::error(
                "KRL0016",
                target.span,
                "this comparison stands alone",
            )
            .help("an assignment is written with one =");
            self.report_with(diagnostic);
            return Some(StatementKind::Assign {
                target: *left,
                value: *right,
            });
        }
        if !self.is_mark("=") {
            let found = self.describe();
            let name = match &target.kind {
                ExpressionKind::Name(name) => Some(name.clone()),
                _ => None,
            };
            let mut diagnostic = depal_syntax::Diagnostic::error(
                "KRL0010",
                self.span(),
                format!("expected `=` or a call, found {found}"),
            );
            if let (Some(name), true) = (name, self.is_line_end()) {
                diagnostic = diagnostic.help(format!("a call has parentheses: {name}( )"));
            }
            self.report_with(diagnostic);
            return None;
        }
        self.advance();
        let value = self.expression();
        Some(StatementKind::Assign { target, value })
    }

    fn if_statement(&mut self, begin: Span) -> Option<StatementKind> {
        let condition = self.expression();
        self.expect_word("THEN", "behind the condition");
        let body = self.block(&["else", "endif"]);
        let otherwise = if self.maybe_word("else") {
            Some(self.block(&["endif"]))
        } else {
            None
        };
        self.expect_block_end("ENDIF", "IF", begin);
        Some(StatementKind::If {
            condition,
            body,
            otherwise,
        })
    }

    fn for_statement(&mut self, begin: Span) -> Option<StatementKind> {
        // The variable without its `=`, which is no operator.
        let variable = self.expression();
        self.expect_mark("=", "behind the loop variable");
        let from = self.expression();
        self.expect_word("TO", "behind the first value");
        let to = self.expression();
        let step = if self.maybe_word("step") {
            Some(self.expression())
        } else {
            None
        };
        let body = self.block(&["endfor"]);
        self.expect_block_end("ENDFOR", "FOR", begin);
        Some(StatementKind::For {
            variable,
            from,
            to,
            step,
            body,
        })
    }

    fn while_statement(&mut self, begin: Span) -> Option<StatementKind> {
        let condition = self.expression();
        let body = self.block(&["endwhile"]);
        self.expect_block_end("ENDWHILE", "WHILE", begin);
        Some(StatementKind::While { condition, body })
    }

    fn repeat_statement(&mut self, begin: Span) -> Option<StatementKind> {
        let body = self.block(&["until"]);
        self.expect_block_end("UNTIL", "REPEAT", begin);
        let until = self.expression();
        Some(StatementKind::Repeat { body, until })
    }

    fn loop_statement(&mut self, begin: Span) -> Option<StatementKind> {
        let body = self.block(&["endloop"]);
        self.expect_block_end("ENDLOOP", "LOOP", begin);
        Some(StatementKind::Loop(body))
    }

    fn switch_statement(&mut self, begin: Span) -> Option<StatementKind> {
        const PARTS: &[&str] = &["case", "default", "endswitch"];
        let subject = self.expression();
        let before = self.block(PARTS);
        if let Some(first) = before.first() {
            let diagnostic = depal_syntax::Diagnostic::error(
                "KRL0013",
                first.span,
                "a statement between SWITCH and its first CASE is never reached",
            );
            self.report_with(diagnostic);
        }
        let mut cases = Vec::new();
        while self.maybe_word("case") {
            let mut values = vec![self.expression()];
            while self.maybe_mark(",") {
                values.push(self.expression());
            }
            cases.push((values, self.block(PARTS)));
        }
        let default = if self.maybe_word("default") {
            Some(self.block(&["endswitch"]))
        } else {
            None
        };
        self.expect_block_end("ENDSWITCH", "SWITCH", begin);
        Some(StatementKind::Switch {
            subject,
            cases,
            default,
        })
    }

    fn wait_statement(&mut self, _: Span) -> Option<StatementKind> {
        if self.maybe_word("for") {
            Some(StatementKind::WaitFor(self.expression()))
        } else if self.maybe_word("sec") {
            Some(StatementKind::WaitSec(self.expression()))
        } else {
            let found = self.describe();
            self.report(
                "KRL0010",
                format!("expected FOR or SEC behind WAIT, found {found}"),
            );
            None
        }
    }
}
