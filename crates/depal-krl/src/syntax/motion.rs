use depal_syntax::{Span, Token};

use super::parser::Parser;
use super::tree::*;

/// How a move goes over into the next one.
const APPROXIMATIONS: [&str; 5] = ["C_PTP", "C_DIS", "C_VEL", "C_ORI", "C_SPL"];

impl Parser<'_> {
    /// What follows the word of a move.
    pub(super) fn movement(&mut self, word: MoveWord) -> Option<StatementKind> {
        let mut points = vec![self.expression()];
        let mut angle = None;
        if word.is_circular() {
            self.expect_mark(",", "between the way point and the end of the arc");
            points.push(self.expression());
            if self.maybe_mark(",") {
                self.expect_word("CA", "before the angle of the circle");
                angle = Some(self.expression());
            }
        }
        if points.iter().any(|p| p.kind == ExpressionKind::Broken) {
            return None;
        }
        let mut approximation = Vec::new();
        let mut frame = None;
        let mut with = Vec::new();
        loop {
            if self.is_any_word(&APPROXIMATIONS) {
                approximation.extend(self.constant_name());
                // Programs write C_DIS, C_ORI as well.
                if let (Token::Mark(","), Token::Name(_)) = (self.peek(), self.peek_after(1)) {
                    self.advance();
                }
            } else if self.maybe_mark("#") {
                frame = self.constant_name();
            } else if self.maybe_word("with") {
                loop {
                    let target = self.expression();
                    if !self.expect_mark("=", "behind the variable of this move") {
                        return None;
                    }
                    with.push((target, self.expression()));
                    if !self.maybe_mark(",") {
                        break;
                    }
                }
            } else {
                break;
            }
        }
        Some(StatementKind::Move(Box::new(Move {
            word,
            points,
            angle,
            approximation,
            frame,
            with,
        })))
    }

    /// INTERRUPT is behind.
    pub(super) fn interrupt(&mut self, global: bool) -> Option<StatementKind> {
        if self.maybe_word("decl") {
            let number = self.expression();
            self.expect_word("WHEN", "behind the number of the interrupt");
            let condition = self.expression();
            self.expect_word("DO", "behind the condition");
            let routine = self.expect_name("the routine of the interrupt")?;
            let arguments = self.arguments();
            return Some(StatementKind::InterruptDecl {
                global,
                number,
                condition,
                routine,
                arguments,
            });
        }
        let Some((_, action)) = InterruptAction::ALL
            .iter()
            .find(|(word, _)| self.is_word(word))
        else {
            let found = self.describe();
            self.report(
                "KRL0010",
                format!("expected DECL, ON, OFF, ENABLE or DISABLE, found {found}"),
            );
            return None;
        };
        self.advance();
        let number = (!self.is_line_end()).then(|| self.expression());
        Some(StatementKind::Interrupt {
            action: *action,
            number,
        })
    }

    /// TRIGGER is behind.
    pub(super) fn trigger(&mut self, _: Span) -> Option<StatementKind> {
        self.expect_word("WHEN", "behind TRIGGER");
        let path = self.is_word("path");
        if !path && !self.is_word("distance") {
            let found = self.describe();
            self.report(
                "KRL0010",
                format!("expected DISTANCE or PATH, found {found}"),
            );
            return None;
        }
        self.advance();
        self.expect_mark("=", "behind the kind of place");
        let distance = self.expression();
        let on_start = path && self.maybe_word("onstart");
        self.expect_word("DELAY", "behind the place");
        self.expect_mark("=", "behind DELAY");
        let delay = self.expression();
        self.expect_word("DO", "behind the delay");
        let begin = self.span();
        let kind = self.call_or_assignment()?;
        let action = Box::new(Statement {
            kind,
            span: begin.to(self.last_span()),
        });
        let priority = if self.maybe_word("prio") {
            self.expect_mark("=", "behind PRIO");
            Some(self.expression())
        } else {
            None
        };
        let place = if path {
            TriggerPlace::Path { distance, on_start }
        } else {
            TriggerPlace::Distance(distance)
        };
        Some(StatementKind::Trigger {
            place,
            delay,
            action,
            priority,
        })
    }
}
