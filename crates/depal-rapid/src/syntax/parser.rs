use depal_vm::{Diagnostic, Label, Span};

use super::keywords::{Class, FRESH_START, class, is_keyword};
use super::lexer::{SpannedToken, Token, lex};
use super::tree::*;

/// Reads one file. The tree holds whatever could be read.
pub(crate) fn parse(file: u32, text: &str, diagnostics: &mut Vec<Diagnostic>) -> Vec<Module> {
    let tokens = lex(file, text, diagnostics);
    let mut parser = Parser {
        tokens,
        at: 0,
        diagnostics,
        depth: 0,
        operators: 0,
        inside: 0,
        reported_at: None,
    };
    parser.file()
}

/// Reads one routine heading, as the table of built-ins has them.
pub(crate) fn parse_heading(text: &str) -> Option<Routine> {
    let mut diagnostics = Vec::new();
    let tokens = lex(u32::MAX, text, &mut diagnostics);
    let mut parser = Parser {
        tokens,
        at: 0,
        diagnostics: &mut diagnostics,
        depth: 0,
        operators: 0,
        inside: 0,
        reported_at: None,
    };
    let routine = parser.heading(false);
    diagnostics.is_empty().then_some(routine).flatten()
}

/// Deepest nesting of expressions and blocks, so that no text can exhaust the stack.
const DEPTH_LIMIT: usize = 64;

/// Names of placeholders: statement, expression, data, routine and so on.
const PLACEHOLDERS: [&str; 9] = ["SMT", "EXP", "ID", "VAR", "DDN", "RDN", "TDN", "PAR", "ARG"];

/// Most operators in one expression.
const OPERATOR_LIMIT: usize = 256;

pub(crate) struct Parser<'a> {
    tokens: Vec<SpannedToken>,
    at: usize,
    pub(crate) diagnostics: &'a mut Vec<Diagnostic>,
    depth: usize,
    /// Operators of the expression being read.
    operators: usize,
    /// Expressions inside each other.
    pub(crate) inside: usize,
    reported_at: Option<usize>,
}

impl Parser<'_> {
    pub(crate) fn peek(&self) -> &Token {
        &self.tokens[self.at.min(self.tokens.len() - 1)].token
    }

    pub(crate) fn peek_after(&self, ahead: usize) -> &Token {
        &self.tokens[(self.at + ahead).min(self.tokens.len() - 1)].token
    }

    pub(crate) fn span(&self) -> Span {
        self.tokens[self.at.min(self.tokens.len() - 1)].span
    }

    pub(crate) fn last_span(&self) -> Span {
        self.tokens[self.at.saturating_sub(1).min(self.tokens.len() - 1)].span
    }

    pub(crate) fn position(&self) -> usize {
        self.at
    }

    pub(crate) fn advance(&mut self) {
        if self.at + 1 < self.tokens.len() {
            self.at += 1;
        }
    }

    pub(crate) fn step_back(&mut self) {
        self.at = self.at.saturating_sub(1);
    }

    pub(crate) fn is_end(&self) -> bool {
        matches!(self.peek(), Token::End)
    }

    pub(crate) fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), Token::Name(name) if name.eq_ignore_ascii_case(word))
    }

    pub(crate) fn is_any_word(&self, words: &[&str]) -> bool {
        words.iter().any(|word| self.is_word(word))
    }

    /// Whether the next word is reserved and of this class.
    pub(crate) fn is_class(&self, wanted: Class) -> bool {
        match self.peek() {
            Token::Name(name) => class(name).is_some_and(|found| found & wanted != 0),
            _ => false,
        }
    }

    pub(crate) fn maybe_word(&mut self, word: &str) -> bool {
        let found = self.is_word(word);
        if found {
            self.advance();
        }
        found
    }

    pub(crate) fn is_mark(&self, mark: &str) -> bool {
        matches!(self.peek(), Token::Mark(found) if *found == mark)
    }

    pub(crate) fn maybe_mark(&mut self, mark: &str) -> bool {
        let found = self.is_mark(mark);
        if found {
            self.advance();
        }
        found
    }

    pub(crate) fn describe(&self) -> String {
        match self.peek() {
            Token::Name(name) => name.clone(),
            Token::Number { value, .. } => format!("the number {value}"),
            Token::Text(_) => "a string".into(),
            Token::Mark(mark) => format!("`{mark}`"),
            Token::End => "the end of the file".into(),
        }
    }

    /// Reports at the current token, once for each place.
    pub(crate) fn report(&mut self, code: &'static str, message: String) {
        let span = self.span();
        self.report_with(Diagnostic::error(code, span, message));
    }

    pub(crate) fn report_with(&mut self, diagnostic: Diagnostic) {
        if self.reported_at != Some(self.at) {
            self.reported_at = Some(self.at);
            self.diagnostics.push(diagnostic);
        }
    }

    pub(crate) fn expect_mark(&mut self, mark: &str, why: &str) -> bool {
        if self.maybe_mark(mark) {
            return true;
        }
        let found = self.describe();
        // A missing mark belongs behind what was read last, not before the next line.
        let previous = self.last_span();
        let span = Span::new(previous.file, previous.end, previous.end);
        let diagnostic = Diagnostic::error(
            "RAPID0010",
            span,
            format!("expected `{mark}` {why}, found {found}"),
        )
        .label(format!("`{mark}` is missing here"));
        self.report_with(diagnostic);
        false
    }

    pub(crate) fn expect_word(&mut self, word: &str, why: &str) -> bool {
        if self.maybe_word(word) {
            return true;
        }
        let found = self.describe();
        self.report("RAPID0010", format!("expected {word} {why}, found {found}"));
        false
    }

    pub(crate) fn expect_name(&mut self, what: &str) -> Option<Name> {
        if let Token::Name(text) = self.peek()
            && !is_keyword(text)
        {
            let name = Name {
                text: text.clone(),
                span: self.span(),
            };
            self.advance();
            return Some(name);
        }
        if self.placeholder() {
            return None;
        }
        let found = self.describe();
        let mut diagnostic = Diagnostic::error(
            "RAPID0011",
            self.span(),
            format!("expected {what}, found {found}"),
        );
        if matches!(self.peek(), Token::Name(_)) {
            diagnostic = diagnostic
                .label("a reserved word")
                .help("a reserved word cannot be a name; if it is meant as one, choose another");
        }
        self.report_with(diagnostic);
        None
    }

    /// As [`expect_mark`](Self::expect_mark) for the second of a pair, with the place of the first.
    pub(crate) fn expect_closing(&mut self, mark: &str, opened: Span, why: &str) -> bool {
        let before = self.diagnostics.len();
        let found = self.expect_mark(mark, why);
        if !found
            && self.diagnostics.len() > before
            && let Some(last) = self.diagnostics.last_mut()
        {
            last.secondary.push(Label {
                span: opened,
                message: format!("opened here, closed with `{mark}`"),
            });
        }
        found
    }

    /// A place in a program that its author has still to fill in, `<SMT>`: reported and passed over.
    pub(crate) fn placeholder(&mut self) -> bool {
        let (Token::Mark("<"), Token::Name(what), Token::Mark(">")) =
            (self.peek(), self.peek_after(1), self.peek_after(2))
        else {
            return false;
        };
        if !PLACEHOLDERS.contains(&what.to_ascii_uppercase().as_str()) {
            return false;
        }
        let message = format!("the placeholder <{what}> has not been filled in");
        let begin = self.span();
        let diagnostic = Diagnostic::error("RAPID0020", begin, message)
            .help("put in what is meant, or delete the line");
        self.report_with(diagnostic);
        for _ in 0..3 {
            self.advance();
        }
        true
    }

    /// One level deeper; `false`, reported, when too deep.
    pub(crate) fn enter(&mut self) -> bool {
        self.depth += 1;
        if self.depth > DEPTH_LIMIT {
            self.report(
                "RAPID0019",
                format!("more than {DEPTH_LIMIT} levels inside each other"),
            );
            return false;
        }
        true
    }

    /// Starts counting the operators of an outermost expression.
    pub(crate) fn begin_operators(&mut self) {
        self.operators = 0;
    }

    /// Counts an operator; `false`, reported, when one expression has too many for the tree to stay flat.
    pub(crate) fn count_operator(&mut self) -> bool {
        self.operators += 1;
        if self.operators > OPERATOR_LIMIT {
            self.report(
                "RAPID0019",
                format!("more than {OPERATOR_LIMIT} operators in one expression"),
            );
            self.recover();
            return false;
        }
        true
    }

    pub(crate) fn leave(&mut self) {
        self.depth -= 1;
    }

    /// Skips to behind the next `;`, or to a word that can only begin something new.
    pub(crate) fn recover(&mut self) {
        while !self.is_end() {
            if self.maybe_mark(";") {
                return;
            }
            if self.is_class(FRESH_START) {
                return;
            }
            self.advance();
        }
    }
}
