//! A line's tokens, read from left to right.

use depal_syntax::{Diagnostic, Span};

use super::keywords::canonical;
use super::lexer::{Kind, Token};

/// A message has been written; the line is given up.
#[derive(Debug)]
pub(super) struct GivenUp;

pub(super) type Parsed<T> = Result<T, GivenUp>;

pub(super) struct Cursor<'a> {
    tokens: &'a [Token],
    at: usize,
    /// Where the line ends, for messages about what is missing there.
    end: Span,
    pub depth: u32,
    pub diagnostics: &'a mut Vec<Diagnostic>,
}

impl<'a> Cursor<'a> {
    pub fn new(tokens: &'a [Token], end: Span, diagnostics: &'a mut Vec<Diagnostic>) -> Self {
        Self {
            tokens,
            at: 0,
            end,
            depth: 0,
            diagnostics,
        }
    }

    pub fn peek(&self) -> Option<&'a Kind> {
        self.peek_at(0)
    }

    pub fn peek_at(&self, ahead: usize) -> Option<&'a Kind> {
        self.tokens.get(self.at + ahead).map(|t| &t.kind)
    }

    pub fn span(&self) -> Span {
        self.tokens.get(self.at).map_or(self.end, |t| t.span)
    }

    pub fn last_span(&self) -> Span {
        match self.at.checked_sub(1).and_then(|i| self.tokens.get(i)) {
            Some(token) => token.span,
            None => self.span(),
        }
    }

    pub fn advance(&mut self) {
        self.at += 1;
    }

    pub fn is_at_end(&self) -> bool {
        self.at >= self.tokens.len()
    }

    pub fn is_symbol(&self, symbol: &str) -> bool {
        matches!(self.peek(), Some(Kind::Symbol(s)) if *s == symbol)
    }

    pub fn is_symbol_at(&self, ahead: usize, symbol: &str) -> bool {
        matches!(self.peek_at(ahead), Some(Kind::Symbol(s)) if *s == symbol)
    }

    pub fn accept(&mut self, symbol: &str) -> bool {
        let found = self.is_symbol(symbol);
        if found {
            self.at += 1;
        }
        found
    }

    /// The English keyword here, in capitals; empty if there is no word.
    pub fn keyword(&self) -> String {
        self.keyword_at(0)
    }

    pub fn keyword_at(&self, ahead: usize) -> String {
        match self.peek_at(ahead) {
            Some(Kind::Word(word)) => canonical(word),
            _ => String::new(),
        }
    }

    pub fn accept_keyword(&mut self, keyword: &str) -> bool {
        let found = self.keyword() == keyword;
        if found {
            self.at += 1;
        }
        found
    }

    pub fn fail<T>(&mut self, diagnostic: Diagnostic) -> Parsed<T> {
        self.diagnostics.push(diagnostic);
        Err(GivenUp)
    }

    /// What stands here, in words.
    pub fn found(&self) -> String {
        match self.peek() {
            None => "the end of the line".into(),
            Some(Kind::Word(word)) => word.clone(),
            Some(Kind::Number { value, .. }) => format!("{value}"),
            Some(Kind::Text(_)) => "a text".into(),
            Some(Kind::Symbol(symbol)) => format!("\"{symbol}\""),
            Some(Kind::Stars) => "an untaught value".into(),
        }
    }

    pub fn expected<T>(&mut self, what: &str) -> Parsed<T> {
        let found = self.found();
        let span = self.span();
        self.fail(Diagnostic::error(
            "TP0010",
            span,
            format!("expected {what}, found {found}"),
        ))
    }

    pub fn expect(&mut self, symbol: &str) -> Parsed<()> {
        if self.accept(symbol) {
            Ok(())
        } else {
            self.expected(&format!("\"{symbol}\""))
        }
    }

    /// A closing bracket, with the place of the opening one.
    pub fn expect_closing(&mut self, symbol: &str, opened: Span) -> Parsed<()> {
        if self.accept(symbol) {
            return Ok(());
        }
        let (found, span) = (self.found(), self.span());
        self.fail(
            Diagnostic::error(
                "TP0011",
                span,
                format!("expected \"{symbol}\", found {found}"),
            )
            .secondary(opened, "opened here"),
        )
    }

    pub fn expect_end(&mut self) -> Parsed<()> {
        if self.is_at_end() {
            return Ok(());
        }
        let (found, span) = (self.found(), self.span());
        self.fail(
            Diagnostic::error(
                "TP0012",
                span,
                format!("the instruction is complete before {found}"),
            )
            .help("one instruction a line; a line ends with ;"),
        )
    }
}
