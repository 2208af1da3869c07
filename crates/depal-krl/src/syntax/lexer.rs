use depal_vm::{Diagnostic, Span};

/// A token. Keywords are names; the parser compares them without regard to case.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Token {
    Name(String),
    Integer(i64),
    Real(f64),
    Text(String),
    /// An operator or a mark: `==`, `<>`, `[`.
    Mark(&'static str),
    /// The end of a line that has something on it.
    Line,
    End,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SpannedToken {
    pub(crate) token: Token,
    pub(crate) span: Span,
}

/// Longest first, so that `==` wins over `=`.
const MARKS: [&str; 20] = [
    "==", "<>", "<=", ">=", "<", ">", "=", "+", "-", "*", "/", "(", ")", "[", "]", "{", "}", ",",
    ":", ".",
];

/// Longest name.
const NAME_LIMIT: usize = 24;

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

fn in_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '$'
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

    fn skip_line(&mut self) {
        self.at += self.rest().find(['\n', '\r']).unwrap_or(self.rest().len());
    }

    fn end_line(&mut self, start: usize) {
        let blank = matches!(
            self.tokens.last(),
            None | Some(SpannedToken {
                token: Token::Line,
                ..
            })
        );
        if !blank {
            let span = Span::new(self.file, start as u32, start as u32);
            let token = Token::Line;
            self.tokens.push(SpannedToken { token, span });
        }
    }

    fn run(&mut self) {
        if self.text.starts_with('\u{feff}') {
            self.at = '\u{feff}'.len_utf8();
        }
        let mut line_begins = true;
        while let Some(c) = self.rest().chars().next() {
            let start = self.at;
            let begins = std::mem::replace(&mut line_begins, false);
            match c {
                '\n' | '\r' => {
                    self.at += 1;
                    self.end_line(start);
                    line_begins = true;
                }
                ';' => self.skip_line(),
                // Header lines: &ACCESS, &REL, &PARAM.
                '&' if begins => self.skip_line(),
                c if c.is_whitespace() || c == '\u{1a}' || c == '\0' => {
                    self.at += c.len_utf8();
                    line_begins = begins;
                }
                c if c.is_alphabetic() || c == '_' || c == '$' => self.name(),
                c if c.is_ascii_digit() => self.number(),
                '.' if self.rest()[1..].starts_with(|c: char| c.is_ascii_digit()) => self.number(),
                '"' => self.string(),
                '\'' => self.based_number(),
                '#' => {
                    self.at += 1;
                    self.push(start, Token::Mark("#"));
                }
                c => {
                    if let Some(mark) = MARKS.iter().find(|m| self.rest().starts_with(**m)) {
                        self.at += mark.len();
                        self.push(start, Token::Mark(mark));
                    } else {
                        self.at += c.len_utf8();
                        let span = self.span(start);
                        self.diagnostics.push(Diagnostic::error(
                            "KRL0001",
                            span,
                            format!("the character {c:?} has no meaning here"),
                        ));
                    }
                }
            }
        }
        let end = self.at;
        self.end_line(end);
        self.push(end, Token::End);
    }

    fn name(&mut self) {
        let start = self.at;
        let length = self.rest().find(|c| !in_name(c));
        self.at += length.unwrap_or(self.rest().len());
        let name = self.text[start..self.at].to_owned();
        // The system's own variables may be longer.
        if name.chars().count() > NAME_LIMIT && !name.starts_with('$') {
            let span = self.span(start);
            self.diagnostics.push(
                Diagnostic::error(
                    "KRL0003",
                    span,
                    format!("the name {name} is longer than {NAME_LIMIT} characters"),
                )
                .help("shorten it; the controller refuses longer names"),
            );
        }
        self.push(start, Token::Name(name));
    }

    fn number(&mut self) {
        let start = self.at;
        let bytes = self.text.as_bytes();
        let digit = |i: usize| bytes.get(i).is_some_and(u8::is_ascii_digit);
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
        let text = &self.text[start..self.at];
        if integer {
            let value = text.parse::<i64>().unwrap_or(i64::MAX);
            self.push(start, Token::Integer(value));
        } else {
            // Digits, point and exponent as above always read as a number.
            let value = text.parse().unwrap_or(f64::NAN);
            self.push(start, Token::Real(value));
        }
    }

    /// `'H1F'`, `'B0101'`.
    fn based_number(&mut self) {
        let start = self.at;
        let body = &self.rest()[1..];
        let radix = match body.bytes().next().map(|b| b.to_ascii_lowercase()) {
            Some(b'h') => 16,
            Some(b'b') => 2,
            _ => 0,
        };
        if radix > 0
            && let Some(end) = body.find('\'')
            && let Ok(value) = u32::from_str_radix(&body[1..end], radix)
        {
            self.at += end + 2;
            // All 32 bits may be written; the first is the sign.
            self.push(start, Token::Integer(i64::from(value as i32)));
            return;
        }
        let length = body.find(|c: char| !c.is_alphanumeric());
        let length = length.unwrap_or(body.len());
        self.at += 1 + length + usize::from(body[length..].starts_with('\''));
        self.push(start, Token::Integer(0));
        let span = self.span(start);
        self.diagnostics.push(
            Diagnostic::error("KRL0005", span, "this is no hexadecimal or binary number")
                .help("write 'H1F' or 'B0101', of at most 32 bits"),
        );
    }

    fn string(&mut self) {
        let start = self.at;
        let body = &self.rest()[1..];
        let line = &body[..body.find(['\n', '\r']).unwrap_or(body.len())];
        let closed = line.find('"');
        let value = line[..closed.unwrap_or(line.len())].to_owned();
        self.at += 1 + value.len() + usize::from(closed.is_some());
        if closed.is_none() {
            let span = self.span(start);
            self.diagnostics.push(
                Diagnostic::error("KRL0002", span, "the string is not closed on its line")
                    .help("add a double quote"),
            );
        }
        let closes_call = closed.is_none() && value.ends_with(')');
        self.push(start, Token::Text(value));
        if closes_call {
            self.push(start, Token::Mark(")"));
        }
    }
}
