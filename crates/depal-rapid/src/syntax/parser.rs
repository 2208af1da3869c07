use std::ops::{Deref, DerefMut};

use depal_syntax::{Diagnostic, Label, Name, Span, Token, Tokens};

use super::keywords::{Class, FRESH_START, class, is_keyword};
use super::lexer::lex;
use super::tree::*;

/// Reads one file. The tree holds whatever could be read.
pub(crate) fn parse(file: u32, text: &str, diagnostics: &mut Vec<Diagnostic>) -> Vec<Module> {
    Parser::new(file, text, diagnostics).file()
}

/// Reads one routine heading, as the table of built-ins has them.
pub(crate) fn parse_heading(text: &str) -> Option<Routine> {
    let mut diagnostics = Vec::new();
    let routine = Parser::new(u32::MAX, text, &mut diagnostics).heading(false);
    diagnostics.is_empty().then_some(routine).flatten()
}

/// Deepest nesting of expressions and blocks, so that no text can exhaust the stack.
const DEPTH_LIMIT: usize = 64;

/// Names of placeholders: statement, expression, data, routine and so on.
const PLACEHOLDERS: [&str; 9] = ["SMT", "EXP", "ID", "VAR", "DDN", "RDN", "TDN", "PAR", "ARG"];

/// Most operators in one expression.
const OPERATOR_LIMIT: usize = 256;

pub(crate) struct Parser<'a> {
    tokens: Tokens<'a>,
    depth: usize,
    /// Operators of the expression being read.
    operators: usize,
    /// Expressions inside each other.
    pub(crate) inside: usize,
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

impl<'a> Parser<'a> {
    fn new(file: u32, text: &str, diagnostics: &'a mut Vec<Diagnostic>) -> Self {
        let tokens = lex(file, text, diagnostics);
        Self {
            tokens: Tokens::new(tokens, "RAPID0010", diagnostics),
            depth: 0,
            operators: 0,
            inside: 0,
        }
    }

    /// Whether the next word is reserved and of this class.
    pub(crate) fn is_class(&self, wanted: Class) -> bool {
        match self.peek() {
            Token::Name(name) => class(name).is_some_and(|found| found & wanted != 0),
            _ => false,
        }
    }

    pub(crate) fn expect_name(&mut self, what: &str) -> Option<Name> {
        let name = self.maybe_name(is_keyword);
        if name.is_none() && !self.placeholder() {
            self.report_no_name("RAPID0011", what);
        }
        name
    }

    /// As [`expect_mark`](Tokens::expect_mark) for the second of a pair, with the place of the first.
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

    /// Reads one level deeper; `None`, reported and skipped, when too deep.
    pub(crate) fn nested<T>(&mut self, read: impl FnOnce(&mut Self) -> T) -> Option<T> {
        if self.depth >= DEPTH_LIMIT {
            self.report(
                "RAPID0019",
                format!("more than {DEPTH_LIMIT} levels inside each other"),
            );
            self.recover();
            return None;
        }
        self.depth += 1;
        let result = read(self);
        self.depth -= 1;
        Some(result)
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
