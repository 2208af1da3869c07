use depal_vm::{Diagnostic, Span};

/// A token. Keywords are names; the parser compares them without regard to case.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Token {
    Name(String),
    Number {
        value: f64,
        integer: bool,
    },
    Text(String),
    /// An operator or a mark: `:=`, `<>`, `;`.
    Mark(&'static str),
    End,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SpannedToken {
    pub(crate) token: Token,
    pub(crate) span: Span,
}

/// Longest first, so that `:=` wins over `:`.
const MARKS: [&str; 26] = [
    ":=", "<>", "<=", ">=", "<", ">", "=", "+", "-", "*", "/", "(", ")", "[", "]", "{", "}", ",",
    ";", ":", ".", "?", "|", "\\", "%", "@",
];

/// Cuts a text into tokens. Never fails: what is no token is reported and skipped.
pub(crate) fn lex(file: u32, text: &str, diagnostics: &mut Vec<Diagnostic>) -> Vec<SpannedToken> {
    let mut lexer = Lexer {
        file,
        text,
        at: 0,
        tokens: Vec::new(),
        diagnostics,
    };
    lexer.run();
    lexer.tokens
}

struct Lexer<'a> {
    file: u32,
    text: &'a str,
    at: usize,
    tokens: Vec<SpannedToken>,
    diagnostics: &'a mut Vec<Diagnostic>,
}

impl Lexer<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn span(&self, start: usize) -> Span {
        Span::new(self.file, start as u32, self.at as u32)
    }

    fn push(&mut self, start: usize, token: Token) {
        let span = self.span(start);
        self.tokens.push(SpannedToken { token, span });
    }

    fn run(&mut self) {
        if self.text.starts_with('\u{feff}') {
            self.at = '\u{feff}'.len_utf8();
        }
        self.skip_header();
        while let Some(c) = self.rest().chars().next() {
            let start = self.at;
            if c.is_whitespace() || c == '\u{1a}' {
                self.at += c.len_utf8();
            } else if c == '!' {
                self.at += self.rest().find('\n').unwrap_or(self.rest().len());
            } else if c.is_alphabetic() || c == '_' {
                let length = self
                    .rest()
                    .find(|c: char| !(c.is_alphanumeric() || c == '_'))
                    .unwrap_or(self.rest().len());
                self.at += length;
                let name = self.text[start..self.at].to_owned();
                if name.chars().count() > 32 {
                    let span = self.span(start);
                    self.diagnostics.push(
                        Diagnostic::error(
                            "RAPID0003",
                            span,
                            format!("the name {name} is longer than 32 characters"),
                        )
                        .help("shorten it; the controller refuses longer names"),
                    );
                }
                self.push(start, Token::Name(name));
            } else if c.is_ascii_digit()
                || (c == '.' && self.rest()[1..].starts_with(|c: char| c.is_ascii_digit()))
            {
                self.number();
            } else if c == '"' {
                self.string();
            } else if let Some(mark) = MARKS.iter().find(|m| self.rest().starts_with(**m)) {
                self.at += mark.len();
                self.push(start, Token::Mark(mark));
            } else {
                self.at += c.len_utf8();
                let span = self.span(start);
                self.diagnostics.push(Diagnostic::error(
                    "RAPID0001",
                    span,
                    format!("the character {c:?} has no meaning here"),
                ));
            }
        }
        let start = self.at;
        self.push(start, Token::End);
    }

    /// The old `%%% VERSION:1 LANGUAGE:ENGLISH %%%` header.
    fn skip_header(&mut self) {
        let rest = self.rest();
        let blank = rest.len() - rest.trim_start().len();
        if let Some(header) = rest[blank..].strip_prefix("%%%")
            && let Some(end) = header.find("%%%")
        {
            self.at += blank + 3 + end + 3;
        }
    }

    fn number(&mut self) {
        let start = self.at;
        let bytes = self.text.as_bytes();
        let digit = |i: usize| bytes.get(i).is_some_and(u8::is_ascii_digit);
        if bytes[start] == b'0' {
            let radix = match bytes.get(start + 1).map(u8::to_ascii_lowercase) {
                Some(b'x') => 16,
                Some(b'o') => 8,
                Some(b'b') => 2,
                _ => 10,
            };
            if radix != 10 {
                let body = &self.text[start + 2..];
                let length = body
                    .find(|c: char| !c.is_digit(radix))
                    .unwrap_or(body.len());
                if let Ok(value) = u64::from_str_radix(&body[..length], radix) {
                    self.at += 2 + length;
                    let value = value as f64;
                    self.push(
                        start,
                        Token::Number {
                            value,
                            integer: true,
                        },
                    );
                    return;
                }
            }
        }
        let mut integer = true;
        while digit(self.at) {
            self.at += 1;
        }
        if bytes.get(self.at) == Some(&b'.') {
            integer = false;
            self.at += 1;
            while digit(self.at) {
                self.at += 1;
            }
        }
        if matches!(bytes.get(self.at), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(self.at + 1), Some(b'+' | b'-')));
            if digit(self.at + 1 + sign) {
                integer = false;
                self.at += 1 + sign;
                while digit(self.at) {
                    self.at += 1;
                }
            }
        }
        // Digits, point and exponent as above always read as a number.
        let value = self.text[start..self.at].parse().unwrap_or(f64::NAN);
        self.push(start, Token::Number { value, integer });
    }

    fn string(&mut self) {
        let start = self.at;
        self.at += 1;
        let mut value = String::new();
        let mut closed = true;
        loop {
            let Some(c) = self.rest().chars().next() else {
                closed = false;
                break;
            };
            match c {
                '"' if self.rest().starts_with("\"\"") => {
                    value.push('"');
                    self.at += 2;
                }
                '"' => {
                    self.at += 1;
                    break;
                }
                '\n' | '\r' => {
                    closed = false;
                    break;
                }
                '\\' => self.escape(&mut value),
                c => {
                    value.push(c);
                    self.at += c.len_utf8();
                }
            }
        }
        let length = value.chars().count();
        if length > 80 {
            let span = self.span(start);
            self.diagnostics.push(Diagnostic::error(
                "RAPID0004",
                span,
                format!("the string has {length} characters, at most 80 fit"),
            ));
        }
        self.push(start, Token::Text(value.clone()));
        if !closed {
            self.unclosed(start);
            // What ends the line is most likely the end of the statement.
            if value.ends_with(");") {
                self.push(start, Token::Mark(")"));
            }
            if value.ends_with(';') {
                self.push(start, Token::Mark(";"));
            }
        }
    }

    fn escape(&mut self, value: &mut String) {
        let start = self.at;
        let rest = self.rest();
        if rest.starts_with("\\\\") {
            value.push('\\');
            self.at += 2;
        } else if let Some(code) = rest
            .get(1..3)
            .and_then(|hex| u8::from_str_radix(hex, 16).ok())
        {
            value.push(char::from(code));
            self.at += 3;
        } else {
            value.push('\\');
            self.at += 1;
            let span = self.span(start);
            self.diagnostics.push(
                Diagnostic::error(
                    "RAPID0005",
                    span,
                    "a backslash in a string begins an escape",
                )
                .help("write \\\\ for a backslash, or \\ and two hexadecimal digits: \"\\0D\""),
            );
        }
    }

    fn unclosed(&mut self, start: usize) {
        let span = self.span(start);
        self.diagnostics.push(
            Diagnostic::error("RAPID0002", span, "the string is not closed on its line")
                .help("add a double quote; a double quote inside a string is written twice"),
        );
    }
}
