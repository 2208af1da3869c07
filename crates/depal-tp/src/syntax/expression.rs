//! Values, conditions, registers and signals.

use depal_syntax::{Diagnostic, Span};

use super::cursor::{Cursor, Parsed};
use super::keywords::LOCALISED_ITEMS;
use super::lexer::{Kind, is_group};
use super::tree::*;

/// Most brackets inside each other.
const DEPTH_LIMIT: u32 = 60;

impl Cursor<'_> {
    pub fn expression(&mut self) -> Parsed<Expr> {
        self.deeper(|cursor| cursor.binary(1))
    }

    fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Parsed<T>) -> Parsed<T> {
        if self.depth >= DEPTH_LIMIT {
            let span = self.span();
            return self.fail(Diagnostic::error(
                "TP0013",
                span,
                format!("more than {DEPTH_LIMIT} brackets inside each other"),
            ));
        }
        self.depth += 1;
        let read = read(self);
        self.depth -= 1;
        read
    }

    fn operator(&self) -> Option<Operator> {
        let text = match self.peek()? {
            Kind::Symbol("[&]") => "AND".to_owned(),
            Kind::Symbol("[+]") => "OR".to_owned(),
            Kind::Symbol(symbol) => (*symbol).to_owned(),
            Kind::Word(_) => self.keyword(),
            _ => return None,
        };
        let row = Operator::ALL
            .iter()
            .find(|(_, spelled, _)| *spelled == text);
        row.map(|(operator, ..)| *operator)
    }

    fn binary(&mut self, least: u8) -> Parsed<Expr> {
        let mut left = self.unary()?;
        let mut links = 0;
        while let Some(operator) = self.operator() {
            if operator.binding() < least {
                break;
            }
            links += 1;
            if links > 1000 {
                return self.expected("a shorter expression");
            }
            self.advance();
            let right = self.deeper(|cursor| cursor.binary(operator.binding() + 1))?;
            left = Expr {
                span: left.span.to(right.span),
                kind: ExprKind::Binary(operator, Box::new(left), Box::new(right)),
            };
        }
        Ok(left)
    }

    fn unary(&mut self) -> Parsed<Expr> {
        let start = self.span();
        if self.accept("!") || (self.keyword() == "NOT" && self.accept_keyword("NOT")) {
            let inner = self.deeper(Self::unary)?;
            let span = start.to(inner.span);
            return Ok(Expr {
                kind: ExprKind::Not(Box::new(inner)),
                span,
            });
        }
        if self.accept("-") {
            return Ok(negated(start, self.deeper(Self::unary)?));
        }
        if self.accept("+") {
            return self.deeper(Self::unary);
        }
        self.primary()
    }

    /// A value without comparison: what stands around the `=` of SELECT.
    pub fn unary_value(&mut self) -> Parsed<Expr> {
        let start = self.span();
        if self.accept("-") {
            return Ok(negated(start, self.deeper(Self::unary_value)?));
        }
        match self.peek() {
            Some(Kind::Number { value, is_real }) => {
                self.advance();
                Ok(Expr {
                    kind: ExprKind::Number {
                        value: *value,
                        is_real: *is_real,
                    },
                    span: start,
                })
            }
            Some(Kind::Text(text)) => {
                self.advance();
                Ok(Expr {
                    kind: ExprKind::Text(text.clone()),
                    span: start,
                })
            }
            Some(Kind::Symbol("(")) => {
                self.advance();
                let inner = self.expression()?;
                self.expect_closing(")", start)?;
                Ok(inner)
            }
            _ if self.item_kind().is_some() => {
                let item = self.item()?;
                Ok(Expr {
                    span: item.span,
                    kind: ExprKind::Item(item),
                })
            }
            _ => self.expected("a value"),
        }
    }

    fn primary(&mut self) -> Parsed<Expr> {
        let span = self.span();
        let kind = match self.peek() {
            Some(Kind::Number { value, is_real }) => {
                self.advance();
                ExprKind::Number {
                    value: *value,
                    is_real: *is_real,
                }
            }
            Some(Kind::Text(text)) => {
                self.advance();
                ExprKind::Text(text.clone())
            }
            Some(Kind::Symbol("(")) => {
                self.advance();
                let inner = self.expression()?;
                self.expect_closing(")", span)?;
                return Ok(Expr {
                    span: span.to(self.last_span()),
                    kind: inner.kind,
                });
            }
            Some(Kind::Word(word)) => {
                let keyword = self.keyword();
                let is_indexed = self.is_symbol_at(1, "[");
                match keyword.as_str() {
                    "ON" | "TRUE" if !is_indexed => {
                        self.advance();
                        self.refuse_edge()?;
                        ExprKind::Switch(true)
                    }
                    "OFF" | "FALSE" if !is_indexed => {
                        self.advance();
                        self.refuse_edge()?;
                        ExprKind::Switch(false)
                    }
                    _ => match Function::TABLE.iter().find(|(name, ..)| *name == keyword) {
                        Some((_, function, count)) => {
                            self.advance();
                            return self.function(*function, *count, span);
                        }
                        None if self.item_kind().is_some() => {
                            let item = self.item()?;
                            return Ok(Expr {
                                span: item.span,
                                kind: ExprKind::Item(item),
                            });
                        }
                        None => {
                            let message = format!("{word} is no register, signal or value");
                            return self.fail(Diagnostic::error("TP0014", span, message));
                        }
                    },
                }
            }
            _ => return self.expected("a value"),
        };
        Ok(Expr { kind, span })
    }

    /// `ON+` and `OFF-` (an edge) are not simulated.
    fn refuse_edge(&mut self) -> Parsed<()> {
        let is_edge = (self.is_symbol("+") || self.is_symbol("-"))
            && match self.peek_at(1) {
                None | Some(Kind::Symbol("," | ")" | ";")) => true,
                Some(Kind::Word(_)) => {
                    matches!(self.keyword_at(1).as_str(), "TIMEOUT" | "AND" | "OR")
                }
                _ => false,
            };
        if is_edge {
            let span = self.span();
            return self.fail(Diagnostic::error(
                "TP0015",
                span,
                "edges of signals (ON+, OFF-) are not simulated; compare with ON or OFF",
            ));
        }
        Ok(())
    }

    fn function(&mut self, function: Function, count: usize, start: Span) -> Parsed<Expr> {
        let mut arguments = Vec::new();
        let opened = self.span();
        let closing = if function.is_on_strings() {
            None
        } else if self.accept("[") {
            Some("]")
        } else {
            self.expect("(")?;
            Some(")")
        };
        loop {
            arguments.push(if function.is_on_strings() {
                self.deeper(Self::unary)?
            } else {
                self.expression()?
            });
            if arguments.len() == count && closing.is_none() || !self.accept(",") {
                break;
            }
        }
        if let Some(closing) = closing {
            self.expect_closing(closing, opened)?;
        }
        let span = start.to(self.last_span());
        if arguments.len() != count {
            let name = function.row().0;
            let given = arguments.len();
            return self.fail(Diagnostic::error(
                "TP0016",
                span,
                format!("{name} takes {count} values, {given} are given"),
            ));
        }
        Ok(Expr {
            kind: ExprKind::Function(function, arguments),
            span,
        })
    }

    /// The kind of register or signal that stands here.
    pub fn item_kind(&self) -> Option<(ItemKind, usize)> {
        let Some(Kind::Word(word)) = self.peek() else {
            return None;
        };
        if word.starts_with('$') {
            return Some((ItemKind::System, 0));
        }
        let mut name = canonical_item(word);
        let is_indexed = self.is_symbol_at(1, "[");
        if is_indexed && let Some((_, item)) = LOCALISED_ITEMS.iter().find(|(l, _)| *l == name) {
            name = (*item).to_owned();
        }
        let row = ItemKind::TABLE.iter().find(|(n, ..)| *n == name)?;
        (is_indexed || row.2 == 0).then_some((row.1, row.2))
    }

    pub fn item(&mut self) -> Parsed<Item> {
        let span = self.span();
        let (Some((kind, least)), Some(Kind::Word(word))) = (self.item_kind(), self.peek()) else {
            return self.expected("a register or signal");
        };
        self.advance();
        let mut path = match kind {
            ItemKind::System => word.to_uppercase(),
            _ => String::new(),
        };
        let mut indexes = Vec::new();
        if self.is_symbol("[") && kind != ItemKind::System {
            indexes = self.indexes()?;
            if least == 0 {
                // `UFRAME_NUM[GP1]` names the only group.
                indexes.clear();
            }
        }
        while kind == ItemKind::System && self.is_symbol("[") {
            // Indexes of system variables are part of their name; they are numbers.
            let begin = self.span();
            let mut parts = Vec::new();
            for index in self.indexes()? {
                match index.kind {
                    ExprKind::Number { value, .. } => parts.push(format!("{value}")),
                    _ => {
                        return self.fail(Diagnostic::error(
                            "TP0017",
                            begin.to(index.span),
                            "an index of a system variable must be a number here",
                        ));
                    }
                }
            }
            path.push('[');
            path.push_str(&parts.join(","));
            path.push(']');
            if let Some(Kind::Word(rest)) = self.peek()
                && rest.starts_with('$')
            {
                path.push('.');
                path.push_str(&rest.to_uppercase());
                self.advance();
            }
        }
        let span = span.to(self.last_span());
        let most = match kind {
            ItemKind::Pr | ItemKind::P => 2,
            _ => least,
        };
        if kind != ItemKind::System && (indexes.len() < least || indexes.len() > most) {
            let name = kind.name();
            let given = indexes.len();
            return self.fail(Diagnostic::error(
                "TP0018",
                span,
                format!("{name}[] takes {least} index, {given} are given"),
            ));
        }
        Ok(Item {
            kind,
            path,
            indexes,
            span,
        })
    }

    /// `[...]` with expressions, without groups.
    pub fn indexes(&mut self) -> Parsed<Vec<Expr>> {
        let opened = self.span();
        self.expect("[")?;
        let mut indexes = Vec::new();
        if let Some(Kind::Word(word)) = self.peek()
            && is_group(word)
        {
            self.advance();
            self.expect_closing("]", opened)?;
            return Ok(indexes);
        }
        loop {
            indexes.push(self.expression()?);
            if !self.accept(",") {
                break;
            }
        }
        self.expect_closing("]", opened)?;
        Ok(indexes)
    }

    /// One index in brackets.
    pub fn index(&mut self) -> Parsed<Expr> {
        let span = self.span();
        let mut indexes = self.indexes()?;
        match (indexes.pop(), indexes.is_empty()) {
            (Some(index), true) => Ok(index),
            _ => self.fail(Diagnostic::error(
                "TP0018",
                span,
                "one index is needed here",
            )),
        }
    }
}

fn canonical_item(word: &str) -> String {
    match super::keywords::canonical(word) {
        keyword if keyword == "POSITION" => "P".into(),
        keyword => keyword,
    }
}

/// A value behind the minus at `start`.
fn negated(start: Span, inner: Expr) -> Expr {
    let span = start.to(inner.span);
    let kind = match inner.kind {
        ExprKind::Number { value, is_real } => ExprKind::Number {
            value: -value,
            is_real,
        },
        kind => ExprKind::Negate(Box::new(Expr {
            kind,
            span: inner.span,
        })),
    };
    Expr { kind, span }
}
