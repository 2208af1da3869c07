use std::ops::{Deref, DerefMut};

use depal_syntax::{Diagnostic, Name, Span, Token, Tokens};

use super::keywords::{ENDERS, ROUTINE_ENDERS, is_any, is_keyword};
use super::lexer::lex;
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
        tokens: Tokens::new(tokens, "KRL0010", diagnostics),
        depth: 0,
        operators: 0,
        open: Vec::new(),
    };
    parser.file(kind)
}

/// Deepest nesting of expressions and blocks, so that no text can exhaust the stack.
const DEPTH_LIMIT: usize = 64;

/// Most operators in one expression.
const OPERATOR_LIMIT: usize = 256;

pub(super) struct Parser<'a> {
    tokens: Tokens<'a>,
    depth: usize,
    /// Operators of the expression being read.
    operators: usize,
    /// Words that the blocks being read end with.
    open: Vec<&'static [&'static str]>,
}

/// The grammar reads its tokens as if they were its own: `self.maybe_word("IF")`.
impl<'a> Deref for Parser<'a> {
    type Target = Tokens<'a>;

    fn deref(&self) -> &Tokens<'a> {
        &self.tokens
    }
}

impl DerefMut for Parser<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.tokens
    }
}

impl Parser<'_> {
    pub(super) fn is_line_end(&self) -> bool {
        matches!(self.peek(), Token::Line | Token::End)
    }

    /// As [`expect_mark`](Tokens::expect_mark) for the second of a pair, with the place of the first.
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
        let name = self.maybe_name(is_keyword);
        if name.is_none() {
            self.report_no_name("KRL0011", what);
        }
        name
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
        if self.last() == Some(&Token::Line) {
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
            let before = self.position();
            match self.nested(Self::statement) {
                Some(statement) => statements.push(statement),
                None => self.skip_line(),
            }
            if self.position() == before {
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
