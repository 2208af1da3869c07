//! Motion instructions.

use depal_syntax::Diagnostic;

use super::cursor::{Cursor, Parsed};
use super::lexer::Kind;
use super::tree::*;

impl Cursor<'_> {
    pub fn motion(&mut self) -> Parsed<Statement> {
        let start = self.span();
        let keyword = self.keyword();
        let kind = match keyword.as_str() {
            "J" => MotionKind::Joint,
            "L" => MotionKind::Linear,
            "C" | "K" => MotionKind::Circular,
            other => {
                let message = format!("{other} moves are not simulated; J, L and C are");
                return self.fail(Diagnostic::error("TP0030", start, message));
            }
        };
        self.advance();
        let mut target = self.target()?;
        let mut via = None;
        if kind == MotionKind::Circular {
            via = Some(target);
            target = self.target()?;
        }
        let (speed, unit) = self.speed()?;
        if (kind == MotionKind::Joint)
            != matches!(
                unit,
                SpeedUnit::Percent | SpeedUnit::Seconds | SpeedUnit::Milliseconds | SpeedUnit::Most
            )
            && !matches!(
                unit,
                SpeedUnit::Seconds | SpeedUnit::Milliseconds | SpeedUnit::Most
            )
        {
            let span = self.last_span();
            let message = match kind {
                MotionKind::Joint => format!(
                    "the speed of a J move is a percentage or a time, not {}",
                    unit.text()
                ),
                _ => format!(
                    "the speed of an {keyword} move is a speed of the tool or a time, not {}",
                    unit.text()
                ),
            };
            return self.fail(Diagnostic::error("TP0031", span, message));
        }
        let termination = self.termination()?;
        let mut options = MotionOptions::default();
        while !self.is_at_end() {
            self.option(&mut options)?;
        }
        Ok(Statement::Motion(Box::new(Motion {
            kind,
            via,
            target,
            speed,
            unit,
            termination,
            options,
            span: start.to(self.last_span()),
        })))
    }

    fn target(&mut self) -> Parsed<Expr> {
        let span = self.span();
        let item = self.item()?;
        if !matches!(item.kind, ItemKind::P | ItemKind::Pr) || item.indexes.len() != 1 {
            return self.fail(Diagnostic::error(
                "TP0032",
                span.to(item.span),
                "a move goes to P[...] or PR[...]",
            ));
        }
        Ok(Expr {
            span: item.span,
            kind: ExprKind::Item(item),
        })
    }

    fn speed(&mut self) -> Parsed<(Option<Expr>, SpeedUnit)> {
        if self.keyword() == "MAX_SPEED" {
            self.advance();
            return Ok((None, SpeedUnit::Most));
        }
        let value = self.unary_value()?;
        if self.accept("%") {
            return Ok((Some(value), SpeedUnit::Percent));
        }
        let first = self.keyword();
        let second = if self.is_symbol_at(1, "/") {
            self.keyword_at(2)
        } else {
            String::new()
        };
        let unit = match (first.as_str(), second.as_str()) {
            ("MM", "SEC" | "S") => SpeedUnit::MmPerSec,
            ("CM", "MIN") => SpeedUnit::CmPerMin,
            ("INCH", "MIN") => SpeedUnit::InchPerMin,
            ("DEG", "SEC" | "S") => SpeedUnit::DegPerSec,
            ("SEC", "") => SpeedUnit::Seconds,
            ("MSEC", "") => SpeedUnit::Milliseconds,
            _ => return self.expected("%, mm/sec, cm/min, inch/min, deg/sec, sec or msec"),
        };
        self.advance();
        if !second.is_empty() {
            self.advance();
            self.advance();
        }
        Ok((Some(value), unit))
    }

    /// A word with a number glued to it (`CNT50`), or followed by one or a register.
    fn glued(&mut self, prefix: &str) -> Parsed<Option<Expr>> {
        let keyword = self.keyword();
        let Some(rest) = keyword.strip_prefix(prefix) else {
            return Ok(None);
        };
        let span = self.span();
        if rest.is_empty() {
            self.advance();
            return self.unary_value().map(Some);
        }
        let Ok(value) = rest.parse::<u32>() else {
            return Ok(None);
        };
        self.advance();
        Ok(Some(Expr {
            kind: ExprKind::Number {
                value: f64::from(value),
                is_real: false,
            },
            span,
        }))
    }

    fn termination(&mut self) -> Parsed<Termination> {
        if self.accept_keyword("FINE") {
            return Ok(Termination::Fine);
        }
        if let Some(value) = self.glued("CNT")? {
            return Ok(Termination::Continuous(value));
        }
        self.expected("FINE or CNT and a number")
    }

    fn option(&mut self, options: &mut MotionOptions) -> Parsed<()> {
        let span = self.span();
        let keyword = self.keyword();
        if let Some(value) = self.glued("ACC")? {
            options.acceleration = Some(value);
            return Ok(());
        }
        if let Some(_speed_of_process) = self.glued("PSPD")? {
            return Ok(());
        }
        let when = match keyword.as_str() {
            "TB" => Some(AlongWhen::TimeBefore),
            "TA" => Some(AlongWhen::TimeAfter),
            "DB" => Some(AlongWhen::DistanceBefore),
            "TIME" | "DISTANCE" => match (keyword.as_str(), self.keyword_at(1).as_str()) {
                ("TIME", "BEFORE") => Some(AlongWhen::TimeBefore),
                ("TIME", "AFTER") => Some(AlongWhen::TimeAfter),
                ("DISTANCE", "BEFORE") => Some(AlongWhen::DistanceBefore),
                _ => return self.expected("BEFORE or AFTER"),
            },
            _ => None,
        };
        if let Some(when) = when {
            self.advance();
            if matches!(keyword.as_str(), "TIME" | "DISTANCE") {
                self.advance();
            }
            return self.along(when, span, options);
        }
        match keyword.as_str() {
            "OFFSET" | "TOOL_OFFSET" => {
                self.advance();
                let mut offset = OffsetBy::Condition;
                if self.is_symbol(",") && self.keyword_at(1) == "PR" {
                    self.advance();
                    offset = OffsetBy::Register(self.register(ItemKind::Pr)?);
                }
                if keyword == "OFFSET" {
                    options.offset = offset;
                } else {
                    options.tool_offset = offset;
                }
            }
            "INC" => {
                self.advance();
                options.incremental = true;
            }
            "SKIP" => {
                self.advance();
                self.expect(",")?;
                if !self.accept_keyword("LBL") {
                    return self.expected("LBL[...]");
                }
                options.skip = Some(self.index()?);
                if self.accept(",") {
                    let item = self.item()?;
                    self.expect("=")?;
                    options.skip_position = Some((item, self.expression()?));
                }
            }
            "WJNT" => {
                self.advance();
                options.wrist_joint = true;
            }
            "RTCP" => {
                self.advance();
                options.remote_tcp = true;
            }
            // They change how the controller plans, not where the arm goes.
            "PTH" | "BREAK" | "MROT" => self.advance(),
            "EV" => {
                self.advance();
                self.unary_value()?;
                self.accept("%");
            }
            _ => {
                let found = self.found();
                return self.fail(
                    Diagnostic::error("TP0033", span, format!("{found} is no option of a move"))
                        .help("known are ACC, Offset, Tool_Offset, INC, Skip, Wjnt, RTCP, PTH, TA, TB and DB"),
                );
            }
        }
        Ok(())
    }

    fn along(
        &mut self,
        when: AlongWhen,
        start: depal_syntax::Span,
        options: &mut MotionOptions,
    ) -> Parsed<()> {
        let amount = self.unary_value()?;
        match when {
            AlongWhen::DistanceBefore => {
                self.accept_keyword("MM");
            }
            _ => self.unit_of_seconds(),
        }
        self.expect(",")?;
        if let Some(Kind::Word(word)) = self.peek()
            && word.eq_ignore_ascii_case("P")
            && self.is_symbol_at(1, "-")
        {
            // `P-SPS`: a block of lines follows.
            self.advance();
            self.advance();
            self.advance();
            options.block = true;
            return Ok(());
        }
        let action = self.action()?;
        options.along.push(Along {
            when,
            amount,
            action,
            span: start.to(self.last_span()),
        });
        Ok(())
    }
}
