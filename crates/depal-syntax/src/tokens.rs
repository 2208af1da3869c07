use crate::{Diagnostic, Name, Span, SpannedToken, Token};

/// The tokens of a text, read from left to right, and the messages that come of it.
///
/// Methods that begin with `is_` look, `maybe_` takes what is there, `expect_` reports what is not.
/// Behind the last token the last one stands for ever, so that no parser runs out of them.
#[derive(Debug)]
pub struct Tokens<'a> {
    tokens: Vec<SpannedToken>,
    at: usize,
    reported_at: Option<usize>,
    /// Code of "expected this, found that".
    expected: &'static str,
    /// All messages so far.
    pub diagnostics: &'a mut Vec<Diagnostic>,
}

impl<'a> Tokens<'a> {
    /// Before the first token. The last one is [`Token::End`]; `expected` is the language's code of a message that
    /// something else was expected.
    pub fn new(
        tokens: Vec<SpannedToken>,
        expected: &'static str,
        diagnostics: &'a mut Vec<Diagnostic>,
    ) -> Self {
        Self {
            tokens,
            at: 0,
            reported_at: None,
            expected,
            diagnostics,
        }
    }

    fn token(&self, at: usize) -> &SpannedToken {
        &self.tokens[at.min(self.tokens.len() - 1)]
    }

    /// The next token.
    pub fn peek(&self) -> &Token {
        self.peek_after(0)
    }

    /// The token so many behind the next.
    pub fn peek_after(&self, ahead: usize) -> &Token {
        &self.token(self.at + ahead).token
    }

    /// The last token taken; none at the beginning.
    pub fn last(&self) -> Option<&Token> {
        let last = self.at.checked_sub(1)?;
        Some(&self.token(last).token)
    }

    /// Place of the next token.
    pub fn span(&self) -> Span {
        self.token(self.at).span
    }

    /// Place of the last token taken.
    pub fn last_span(&self) -> Span {
        self.token(self.at.saturating_sub(1)).span
    }

    /// How many tokens were taken: whether reading goes on.
    pub fn position(&self) -> usize {
        self.at
    }

    /// Takes the next token, but never the last of all.
    pub fn advance(&mut self) {
        if self.at + 1 < self.tokens.len() {
            self.at += 1;
        }
    }

    /// Gives back the token taken last.
    pub fn step_back(&mut self) {
        self.at = self.at.saturating_sub(1);
    }

    /// Whether the text is at its end.
    pub fn is_end(&self) -> bool {
        matches!(self.peek(), Token::End)
    }

    /// Whether this word comes next.
    pub fn is_word(&self, word: &str) -> bool {
        matches!(self.peek(), Token::Name(name) if name.eq_ignore_ascii_case(word))
    }

    /// Whether one of these words comes next.
    pub fn is_any_word(&self, words: &[&str]) -> bool {
        words.iter().any(|word| self.is_word(word))
    }

    /// Whether this mark comes next.
    pub fn is_mark(&self, mark: &str) -> bool {
        matches!(self.peek(), Token::Mark(found) if *found == mark)
    }

    /// Takes a word if it comes next.
    pub fn maybe_word(&mut self, word: &str) -> bool {
        let found = self.is_word(word);
        if found {
            self.advance();
        }
        found
    }

    /// Takes a mark if it comes next.
    pub fn maybe_mark(&mut self, mark: &str) -> bool {
        let found = self.is_mark(mark);
        if found {
            self.advance();
        }
        found
    }

    /// Takes a name if one comes next that is not reserved.
    pub fn maybe_name(&mut self, is_reserved: impl Fn(&str) -> bool) -> Option<Name> {
        let text = match self.peek() {
            Token::Name(text) if !is_reserved(text) => text.clone(),
            _ => return None,
        };
        let span = self.span();
        self.advance();
        Some(Name { text, span })
    }

    /// The next token as messages say it.
    pub fn describe(&self) -> String {
        self.peek().describe()
    }

    /// Reports at the next token, once for each place.
    pub fn report(&mut self, code: &'static str, message: String) {
        let span = self.span();
        self.report_with(Diagnostic::error(code, span, message));
    }

    /// Reports, once for each token that comes next.
    pub fn report_with(&mut self, diagnostic: Diagnostic) {
        if self.reported_at != Some(self.at) {
            self.reported_at = Some(self.at);
            self.diagnostics.push(diagnostic);
        }
    }

    /// Takes a mark, or reports that it is missing behind what was taken last.
    pub fn expect_mark(&mut self, mark: &str, why: &str) -> bool {
        if self.maybe_mark(mark) {
            return true;
        }
        let found = self.describe();
        // A missing mark belongs behind what was read last, not before the next line.
        let previous = self.last_span();
        let span = Span::new(previous.file, previous.end, previous.end);
        let message = format!("expected `{mark}` {why}, found {found}");
        let diagnostic = Diagnostic::error(self.expected, span, message)
            .label(format!("`{mark}` is missing here"));
        self.report_with(diagnostic);
        false
    }

    /// Takes a word, or reports what stands there instead.
    pub fn expect_word(&mut self, word: &str, why: &str) -> bool {
        if self.maybe_word(word) {
            return true;
        }
        let found = self.describe();
        self.report(
            self.expected,
            format!("expected {word} {why}, found {found}"),
        );
        false
    }

    /// Reports that what comes next is no name, or none that may be one.
    pub fn report_no_name(&mut self, code: &'static str, what: &str) {
        let message = format!("expected {what}, found {}", self.describe());
        let mut diagnostic = Diagnostic::error(code, self.span(), message);
        if matches!(self.peek(), Token::Name(_)) {
            diagnostic = diagnostic
                .label("a reserved word")
                .help("a reserved word cannot be a name; if it is meant as one, choose another");
        }
        self.report_with(diagnostic);
    }
}
