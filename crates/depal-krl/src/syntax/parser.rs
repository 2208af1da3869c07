use depal_vm::{Diagnostic, Span};

use super::keywords::{ENDERS, ROUTINE_ENDERS, is_any, is_keyword};
use super::lexer::{SpannedToken, Token, lex};
use super::tree::*;

/// Reads one file. The tree holds whatever could be read.
pub(crate) fn parse(
    file: u32,
    text: &str,
    kind: FileKind,
    diagnostics: &mut Vec<Diagnostic>,
) -> File {
    let tokens = lex(file, text, diagnostics);
    let mut parser = Parser {
        tokens,
        at: 0,
        diagnostics,
        depth: 0,
        operators: 0,
        open: Vec::new(),
        reported_at: None,
    };
    parser.file(kind)
}

/// Deepest nesting of expressions and blocks, so that no text can exhaust the stack.
const DEPTH_LIMIT: usize = 64;

/// Most operators in one expression.
const OPERATOR_LIMIT: usize = 256;

pub(super) struct Parser<'a> {
    tokens: Vec<SpannedToken>,
    at: usize,
    pub(super) diagnostics: &'a mut Vec<Diagnostic>,
    depth: usize,
    /// Operators of the expression being read.
    operators: usize,
    /// Words that the blocks being read end with.
    open: Vec<&'static [&'static str]>,
    reported_at: Option<usize>,
}

impl Parser<'_> {
    fn token(&self, ahead: usize) -> &SpannedToken {
        &self.tokens[(self.at + ahead).min(self.tokens.len() - 1)]
    }

    pub(super) fn peek(&self) -> &Token {
        &self.token(0).token
    }

    pub(super) fn peek_after(&self, ahead: usize) -> &Token {
        &self.token(ahead).token
    }

    pub(super) fn span(&self) -> Span {
        self.token(0).span
    }

    pub(super) fn last_span(&self) -> Span {
        self.tokens[self.at.saturating_sub(1).min(self.tokens.len() - 1)].span
    }

    pub(super) fn position(&self) -> usize {
        self.at
    }

    pub(super) fn advance(&mut self) {
        if self.at + 1 < self.tokens.len() {
            self.at += 1;
        }
    }

    pub(super) fn is_end(&self) -> bool {
        matches!(self.peek(), Token::End)
    }

    pub(super) fn is_line_end(&self) -> bool {
        matches!(self.peek(), Token::Line | Token::End)
    }

    pub(super) fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), Token::Name(name) if name.eq_ignore_ascii_case(word))
    }

    pub(super) fn is_any_word(&self, words: &[&str]) -> bool {
        matches!(self.peek(), Token::Name(name) if is_any(name, words))
    }

    pub(super) fn maybe_word(&mut self, word: &str) -> bool {
        let found = self.is_word(word);
        if found {
            self.advance();
        }
        found
    }

    pub(super) fn is_mark(&self, mark: &str) -> bool {
        matches!(self.peek(), Token::Mark(found) if *found == mark)
    }

    pub(super) fn maybe_mark(&mut self, mark: &str) -> bool {
        let found = self.is_mark(mark);
        if found {
            self.advance();
        }
        found
    }

    pub(super) fn describe(&self) -> String {
        match self.peek() {
            Token::Name(name) => name.clone(),
            Token::Integer(value) => format!("the number {value}"),
            Token::Real(value) => format!("the number {value}"),
            Token::Text(_) => "a string".into(),
            Token::Mark(mark) => format!("`{mark}`"),
            Token::Line => "the end of the line".into(),
            Token::End => "the end of the file".into(),
        }
    }

    /// Reports at the current token, once for each place.
    pub(super) fn report(&mut self, code: &'static str, message: String) {
        let span = self.span();
        self.report_with(Diagnostic::error(code, span, message));
    }

    pub(super) fn report_with(&mut self, diagnostic: Diagnostic) {
        if self.reported_at != Some(self.at) {
            self.reported_at = Some(self.at);
            self.diagnostics.push(diagnostic);
        }
    }

    pub(super) fn expect_mark(&mut self, mark: &str, why: &str) -> bool {
        if self.maybe_mark(mark) {
            return true;
        }
        let found = self.describe();
        // A missing mark belongs behind what was read last, not before the next line.
        let previous = self.last_span();
        let span = Span::new(previous.file, previous.end, previous.end);
        let diagnostic = Diagnostic::error(
            "KRL0010",
            span,
            format!("expected `{mark}` {why}, found {found}"),
        )
        .label(format!("`{mark}` is missing here"));
        self.report_with(diagnostic);
        false
    }

    pub(super) fn expect_word(&mut self, word: &str, why: &str) -> bool {
        if self.maybe_word(word) {
            return true;
        }
        let found = self.describe();
        self.report("KRL0010", format!("expected {word} {why}, found {found}"));
        false
    }

    /// As [`expect_mark`](Self::expect_mark) for the second of a pair, with the place of the first.
    pub(super) fn expect_closing(&mut self, mark: &str, opening: Span, what: &str) -> bool {
        if self.maybe_mark(mark) {
            return true;
        }
        let found = self.describe();
        let diagnostic = Diagnostic::error(
            "KRL0010",
            self.span(),
            format!("expected `{mark}` {what}, found {found}"),
        )
        .secondary(opening, "opened here");
        self.report_with(diagnostic);
        false
    }

    pub(super) fn expect_name(&mut self, what: &str) -> Option<Name> {
        if let Token::Name(text) = self.peek()
            && !is_keyword(text)
        {
            let text = text.clone();
            let span = self.span();
            self.advance();
            return Some(Name { text, span });
        }
        let found = self.describe();
        let mut diagnostic = Diagnostic::error(
            "KRL0011",
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

    /// Enters a level of nesting; `None` (reported) when there are too many.
    pub(super) fn nested<T>(&mut self, read: impl FnOnce(&mut Self) -> T) -> Option<T> {
        if self.depth >= DEPTH_LIMIT {
            self.report(
                "KRL0012",
                format!("more than {DEPTH_LIMIT} levels inside each other"),
            );
            return None;
        }
        self.depth += 1;
        let result = read(self);
        self.depth -= 1;
        Some(result)
    }

    /// Counts an operator of the expression being read; `false` (reported) when there are too many.
    pub(super) fn one_more_operator(&mut self) -> bool {
        self.operators += 1;
        if self.operators > OPERATOR_LIMIT {
            self.report(
                "KRL0012",
                format!("more than {OPERATOR_LIMIT} operators in one statement"),
            );
        }
        self.operators <= OPERATOR_LIMIT
    }

    pub(super) fn skip_line(&mut self) {
        while !self.is_line_end() {
            self.advance();
        }
    }

    /// The end of a statement. What is left on the line is reported and skipped.
    pub(super) fn expect_line_end(&mut self) {
        self.operators = 0;
        let begins_line = self.at > 0 && matches!(self.tokens[self.at - 1].token, Token::Line);
        if begins_line {
            // A block that is not ended left the next line unread.
            return;
        }
        if !self.is_line_end() {
            let found = self.describe();
            self.report(
                "KRL0013",
                format!("expected the end of the line, found {found}"),
            );
            self.skip_line();
        }
        if matches!(self.peek(), Token::Line) {
            self.advance();
        }
    }

    pub(super) fn skip_empty(&mut self) {
        while matches!(self.peek(), Token::Line) {
            self.advance();
        }
    }

    /// Statements up to one of `stops`, the end of a block around it, or the end of the routine.
    pub(super) fn block(&mut self, stops: &'static [&'static str]) -> Vec<Statement> {
        self.open.push(stops);
        let mut statements = Vec::new();
        loop {
            self.skip_empty();
            if self.is_end() || self.is_any_word(stops) || self.begins_routine() {
                break;
            }
            if let Token::Name(word) = self.peek()
                && is_any(word, ENDERS)
            {
                let word = word.to_uppercase();
                if self.open.iter().any(|stops| is_any(&word, stops)) {
                    break;
                }
                self.report("KRL0014", format!("{word} without its beginning"));
                self.skip_line();
                continue;
            }
            let before = self.at;
            match self.nested(Self::statement) {
                Some(statement) => statements.push(statement),
                None => self.skip_line(),
            }
            if self.at == before {
                self.advance();
            }
        }
        self.open.pop();
        statements
    }

    /// END, or the heading of another routine.
    pub(super) fn begins_routine(&self) -> bool {
        self.is_any_word(ROUTINE_ENDERS)
            || (self.is_word("global")
                && matches!(self.peek_after(1), Token::Name(n) if is_any(n, &["def", "deffct"])))
    }

    /// The word that ends what began at `opening`.
    pub(super) fn expect_block_end(&mut self, word: &'static str, what: &str, opening: Span) {
        if self.maybe_word(word) {
            return;
        }
        let found = self.describe();
        let diagnostic = Diagnostic::error(
            "KRL0015",
            self.span(),
            format!("{word} is missing: found {found}"),
        )
        .label(format!("expected {word} before this"))
        .secondary(opening, format!("this {what} is not ended"));
        self.report_with(diagnostic);
    }

    /// Takes an opening mark and gives back its place.
    pub(super) fn opening(&mut self, mark: &str) -> Option<Span> {
        let span = self.span();
        self.maybe_mark(mark).then_some(span)
    }

    /// `[]`, `[,]`, `[,,]`, or nothing: how many dimensions.
    pub(super) fn brackets(&mut self) -> usize {
        let Some(opening) = self.opening("[") else {
            return 0;
        };
        let mut dimensions = 1;
        while self.maybe_mark(",") {
            dimensions += 1;
        }
        self.expect_closing("]", opening, "behind the dimensions");
        dimensions
    }

    /// `:IN`, `:OUT`.
    pub(super) fn mode(&mut self) -> Option<Mode> {
        if !self.maybe_mark(":") {
            return None;
        }
        if self.maybe_word("in") {
            Some(Mode::In)
        } else if self.maybe_word("out") {
            Some(Mode::Out)
        } else {
            let found = self.describe();
            self.report("KRL0010", format!("expected IN or OUT, found {found}"));
            None
        }
    }
}
