//! Lines of a listing, and the words in them.

use depal_syntax::{Diagnostic, Scanner, Span};

/// What a token is.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Kind {
    /// Letters, digits and underscores; a system variable with its dots and dollars.
    Word(String),
    /// A number, and whether it has a point.
    Number { value: f64, is_real: bool },
    /// Text in quotes, or in the brackets of MESSAGE.
    Text(String),
    /// Punctuation.
    Symbol(&'static str),
    /// Asterisks: a value that was never taught.
    Stars,
}

/// A word, number or sign with its place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Token {
    pub kind: Kind,
    pub span: Span,
}

const SYMBOLS: [&str; 26] = [
    "[&]", "[+]", "<>", "<=", ">=", "[", "]", "(", ")", "{", "}", ",", ":", ";", "=", "<", ">",
    "+", "-", "*", "/", "!", "%", "@", "&", "|",
];

fn is_word_start(c: char) -> bool {
    c.is_alphabetic() || c == '_' || c == '$'
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Reads `text[start..end]` of a file as tokens. Comments in brackets (`R[1:count]`) are left out.
pub(crate) fn tokens(
    file: u32,
    text: &str,
    start: usize,
    end: usize,
    diagnostics: &mut Vec<Diagnostic>,
) -> Vec<Token> {
    let mut lexer = Lexer {
        scanner: Scanner::within(file, text, start, end),
        depth: 0,
        tokens: Vec::new(),
    };
    lexer.run(diagnostics);
    lexer.tokens
}

struct Lexer<'a> {
    scanner: Scanner<'a>,
    depth: usize,
    tokens: Vec<Token>,
}

impl Lexer<'_> {
    fn push(&mut self, kind: Kind, start: usize) {
        let span = self.scanner.span_from(start);
        self.tokens.push(Token { kind, span });
    }

    fn run(&mut self, diagnostics: &mut Vec<Diagnostic>) {
        let mut complained = false;
        while let Some(c) = self.scanner.peek() {
            let start = self.scanner.at();
            if c.is_whitespace() || c == '\0' || c == '\u{1a}' {
                self.scanner.take(c.len_utf8());
            } else if is_word_start(c) {
                self.word(c);
            } else if self.scanner.is_at_number() {
                let (value, integer) = self.scanner.take_number();
                let is_real = !integer;
                self.push(Kind::Number { value, is_real }, start);
            } else if c == '\'' || c == '"' {
                self.quoted(c, diagnostics);
            } else if self.scanner.rest().starts_with("**") {
                self.scanner.take_while(|c| c == '*');
                self.push(Kind::Stars, start);
            } else if self.scanner.rest().starts_with(".$") {
                // A part of a system variable with an index: `$PLST_GRP1[1].$PAYLOAD`.
                self.scanner.take(1);
            } else if let Some(symbol) = self.scanner.take_any(&SYMBOLS) {
                self.symbol(symbol, start, diagnostics);
            } else {
                self.scanner.take(c.len_utf8());
                if !complained {
                    complained = true;
                    diagnostics.push(Diagnostic::error(
                        "TP0001",
                        self.scanner.span_from(start),
                        format!("the character {c:?} has no meaning here"),
                    ));
                }
            }
        }
    }

    fn word(&mut self, first: char) {
        let start = self.scanner.at();
        let in_word = |c| is_word(c) || (first == '$' && matches!(c, '$' | '.'));
        let rest = self.scanner.rest();
        let length = rest.find(|c| !in_word(c)).unwrap_or(rest.len());
        let word = self
            .scanner
            .take(rest[..length].trim_end_matches('.').len());
        self.push(Kind::Word(word.to_owned()), start);
        if matches!(word.to_uppercase().as_str(), "MESSAGE" | "MELDUNG") {
            self.message();
        }
    }

    /// The text of a message in its brackets, up to the last one on the line.
    fn message(&mut self) {
        let rest = self.scanner.rest();
        let body = rest.trim_start();
        if let Some(body) = body.strip_prefix('[')
            && let Some(length) = body.rfind(']')
        {
            self.scanner.take(rest.len() - body.len());
            let start = self.scanner.at();
            let text = self.scanner.take(length).to_owned();
            self.push(Kind::Text(text), start);
            self.scanner.take(1);
        }
    }

    fn quoted(&mut self, quote: char, diagnostics: &mut Vec<Diagnostic>) {
        let start = self.scanner.at();
        self.scanner.take(1);
        let in_text = |c| c != quote && c != '\n' && c != '\r';
        let text = self.scanner.take_while(in_text).to_owned();
        if self.scanner.peek() == Some(quote) {
            self.scanner.take(1);
        } else {
            diagnostics.push(Diagnostic::error(
                "TP0002",
                self.scanner.span_from(start),
                "the text has no closing quote on its line",
            ));
        }
        self.push(Kind::Text(text), start);
    }

    /// A symbol that was taken.
    fn symbol(&mut self, symbol: &'static str, start: usize, diagnostics: &mut Vec<Diagnostic>) {
        // `PR[GP1:5]` names a motion group; any other colon in brackets begins a comment.
        if symbol == ":" && self.depth > 0 {
            let group = matches!(self.tokens.last(), Some(Token { kind: Kind::Word(word), .. })
                if is_group(word));
            if !group {
                let in_comment = |c| c != ']' && c != '\n' && c != '\r';
                self.scanner.take_while(in_comment);
            } else if let Some(Token {
                kind: Kind::Word(word),
                span,
            }) = self.tokens.pop()
                && !word.ends_with(['P', 'p', '1'])
            {
                let message = format!("{word}: there is one motion group, GP1");
                diagnostics.push(Diagnostic::error("TP0003", span, message));
            }
            return;
        }
        match symbol {
            "[" => self.depth += 1,
            "]" => self.depth = self.depth.saturating_sub(1),
            _ => {}
        }
        self.push(Kind::Symbol(symbol), start);
    }
}

/// `GP1`, `GRP1`: the first and only motion group here.
pub(crate) fn is_group(word: &str) -> bool {
    let upper = word.to_uppercase();
    let number = upper.strip_prefix("GRP").or(upper.strip_prefix("GP"));
    number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
}
