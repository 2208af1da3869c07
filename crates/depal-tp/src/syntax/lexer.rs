//! Lines of a listing, and the words in them.

use depal_vm::{Diagnostic, Span};

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
        file,
        text: &text[..end],
        at: start,
        depth: 0,
        tokens: Vec::new(),
    };
    lexer.run(diagnostics);
    lexer.tokens
}

struct Lexer<'a> {
    file: u32,
    text: &'a str,
    at: usize,
    depth: usize,
    tokens: Vec<Token>,
}

impl Lexer<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn push(&mut self, kind: Kind, start: usize) {
        let span = Span::new(self.file, start as u32, self.at as u32);
        self.tokens.push(Token { kind, span });
    }

    fn take_while(&mut self, accept: impl Fn(char) -> bool) -> String {
        let length: usize = self
            .rest()
            .chars()
            .take_while(|c| accept(*c))
            .map(char::len_utf8)
            .sum();
        let taken = self.rest()[..length].to_owned();
        self.at += length;
        taken
    }

    fn run(&mut self, diagnostics: &mut Vec<Diagnostic>) {
        let mut complained = false;
        while let Some(c) = self.rest().chars().next() {
            let start = self.at;
            if c.is_whitespace() || c == '\0' || c == '\u{1a}' {
                self.at += c.len_utf8();
            } else if is_word_start(c) {
                self.word(c);
            } else if c.is_ascii_digit()
                || (c == '.' && self.rest()[1..].starts_with(|d: char| d.is_ascii_digit()))
            {
                self.number();
            } else if c == '\'' || c == '"' {
                self.quoted(c, diagnostics);
            } else if self.rest().starts_with("**") {
                self.take_while(|c| c == '*');
                self.push(Kind::Stars, start);
            } else if self.rest().starts_with(".$") {
                // A part of a system variable with an index: `$PLST_GRP1[1].$PAYLOAD`.
                self.at += 1;
            } else if let Some(symbol) = SYMBOLS.iter().find(|s| self.rest().starts_with(**s)) {
                self.symbol(symbol, diagnostics);
            } else {
                self.at += c.len_utf8();
                if !complained {
                    complained = true;
                    diagnostics.push(Diagnostic::error(
                        "TP0001",
                        Span::new(self.file, start as u32, self.at as u32),
                        format!("the character {c:?} has no meaning here"),
                    ));
                }
            }
        }
    }

    fn word(&mut self, first: char) {
        let start = self.at;
        let word = if first == '$' {
            let mut word = self.take_while(|c| is_word(c) || matches!(c, '$' | '.'));
            while word.ends_with('.') {
                word.pop();
                self.at -= 1;
            }
            word
        } else {
            self.take_while(is_word)
        };
        let upper = word.to_uppercase();
        self.push(Kind::Word(word), start);
        if matches!(upper.as_str(), "MESSAGE" | "MELDUNG") {
            let blanks = self.rest().len() - self.rest().trim_start().len();
            if self.rest()[blanks..].starts_with('[') {
                let start = self.at + blanks + 1;
                let end = self.text[start..].rfind(']').map(|i| start + i);
                if let Some(end) = end {
                    self.at = end;
                    let text = self.text[start..end].to_owned();
                    self.push(Kind::Text(text), start);
                    self.at = end + 1;
                }
            }
        }
    }

    fn number(&mut self) {
        let start = self.at;
        self.take_while(|c| c.is_ascii_digit());
        let mut is_real = false;
        if self.rest().starts_with('.') {
            is_real = true;
            self.at += 1;
            self.take_while(|c| c.is_ascii_digit());
        }
        // An exponent, but not the letter of a unit.
        let bytes = self.rest().as_bytes();
        if bytes.first().is_some_and(|b| matches!(b, b'e' | b'E')) {
            let sign = usize::from(bytes.get(1).is_some_and(|b| matches!(b, b'+' | b'-')));
            if bytes.get(1 + sign).is_some_and(u8::is_ascii_digit) {
                is_real = true;
                self.at += 1 + sign;
                self.take_while(|c| c.is_ascii_digit());
            }
        }
        let value = self.text[start..self.at].parse().unwrap_or(0.0);
        self.push(Kind::Number { value, is_real }, start);
    }

    fn quoted(&mut self, quote: char, diagnostics: &mut Vec<Diagnostic>) {
        let start = self.at;
        self.at += 1;
        let text = self.take_while(|c| c != quote && c != '\n' && c != '\r');
        if self.rest().starts_with(quote) {
            self.at += 1;
        } else {
            diagnostics.push(Diagnostic::error(
                "TP0002",
                Span::new(self.file, start as u32, self.at as u32),
                "the text has no closing quote on its line",
            ));
        }
        self.push(Kind::Text(text), start);
    }

    fn symbol(&mut self, symbol: &'static str, diagnostics: &mut Vec<Diagnostic>) {
        let start = self.at;
        // `PR[GP1:5]` names a motion group; any other colon in brackets begins a comment.
        if symbol == ":" && self.depth > 0 {
            let group = matches!(self.tokens.last(), Some(Token { kind: Kind::Word(word), .. })
                if is_group(word));
            if group {
                if let Some(Token {
                    kind: Kind::Word(word),
                    span,
                }) = self.tokens.pop()
                    && !word.ends_with(['P', 'p', '1'])
                {
                    let message = format!("{word}: there is one motion group, GP1");
                    diagnostics.push(Diagnostic::error("TP0003", span, message));
                }
                self.at += 1;
            } else {
                self.take_while(|c| c != ']' && c != '\n' && c != '\r');
            }
            return;
        }
        self.at += symbol.len();
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
