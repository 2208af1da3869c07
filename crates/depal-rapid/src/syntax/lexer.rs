use depal_syntax::{Diagnostic, Scanner, SpannedToken, Token};

/// Longest first, so that `:=` wins over `:`.
const MARKS: [&str; 26] = [
    ":=", "<>", "<=", ">=", "<", ">", "=", "+", "-", "*", "/", "(", ")", "[", "]", "{", "}", ",",
    ";", ":", ".", "?", "|", "\\", "%", "@",
];

/// Longest name.
const NAME_LIMIT: usize = 32;

/// Longest string.
const TEXT_LIMIT: usize = 80;

/// Cuts a text into tokens. Never fails: what is no token is reported and skipped.
pub(crate) fn lex(file: u32, text: &str, diagnostics: &mut Vec<Diagnostic>) -> Vec<SpannedToken> {
    let mut lexer = Lexer {
        scanner: Scanner::new(file, text),
        tokens: Vec::new(),
        diagnostics,
    };
    lexer.run();
    lexer.tokens
}

struct Lexer<'a> {
    scanner: Scanner<'a>,
    tokens: Vec<SpannedToken>,
    diagnostics: &'a mut Vec<Diagnostic>,
}

impl Lexer<'_> {
    fn push(&mut self, start: usize, token: Token) {
        let span = self.scanner.span_from(start);
        self.tokens.push(SpannedToken { token, span });
    }

    /// What is wrong from `start` to here.
    fn report(&mut self, code: &'static str, start: usize, message: impl Into<String>) {
        let span = self.scanner.span_from(start);
        self.diagnostics
            .push(Diagnostic::error(code, span, message));
    }

    /// As [`report`](Self::report), with how to mend it.
    fn report_with_help(
        &mut self,
        code: &'static str,
        start: usize,
        message: impl Into<String>,
        help: &str,
    ) {
        let span = self.scanner.span_from(start);
        self.diagnostics
            .push(Diagnostic::error(code, span, message).help(help));
    }

    fn run(&mut self) {
        self.skip_header();
        while let Some(c) = self.scanner.peek() {
            let start = self.scanner.at();
            if c.is_whitespace() || c == '\u{1a}' {
                self.scanner.take(c.len_utf8());
            } else if c == '!' {
                self.scanner.take_while(|c| c != '\n');
            } else if c.is_alphabetic() || c == '_' {
                self.name();
            } else if self.scanner.is_at_number() {
                self.number();
            } else if c == '"' {
                self.string();
            } else if let Some(mark) = self.scanner.take_any(&MARKS) {
                self.push(start, Token::Mark(mark));
            } else {
                self.scanner.take(c.len_utf8());
                let message = format!("the character {c:?} has no meaning here");
                self.report("RAPID0001", start, message);
            }
        }
        let end = self.scanner.at();
        self.push(end, Token::End);
    }

    /// The old `%%% VERSION:1 LANGUAGE:ENGLISH %%%` header.
    fn skip_header(&mut self) {
        let rest = self.scanner.rest();
        let blank = rest.len() - rest.trim_start().len();
        if let Some(header) = rest[blank..].strip_prefix("%%%")
            && let Some(end) = header.find("%%%")
        {
            self.scanner.take(blank + 3 + end + 3);
        }
    }

    fn name(&mut self) {
        let start = self.scanner.at();
        let in_name = |c: char| c.is_alphanumeric() || c == '_';
        let name = self.scanner.take_while(in_name);
        if name.chars().count() > NAME_LIMIT {
            self.report_with_help(
                "RAPID0003",
                start,
                format!("the name {name} is longer than {NAME_LIMIT} characters"),
                "shorten it; the controller refuses longer names",
            );
        }
        self.push(start, Token::Name(name.to_owned()));
    }

    fn number(&mut self) {
        let start = self.scanner.at();
        let (value, integer) = match self.based_number() {
            Some(value) => (value, true),
            None => self.scanner.take_number(),
        };
        self.push(start, Token::Number { value, integer });
    }

    /// `0x1F`, `0o17`, `0b0101`.
    fn based_number(&mut self) -> Option<f64> {
        let body = self.scanner.rest().strip_prefix('0')?;
        let radix = match body.bytes().next()?.to_ascii_lowercase() {
            b'x' => 16,
            b'o' => 8,
            b'b' => 2,
            _ => return None,
        };
        let digits = &body[1..];
        let length = digits.find(|c: char| !c.is_digit(radix));
        let digits = &digits[..length.unwrap_or(digits.len())];
        let value = u64::from_str_radix(digits, radix).ok()?;
        self.scanner.take(2 + digits.len());
        Some(value as f64)
    }

    fn string(&mut self) {
        let start = self.scanner.at();
        self.scanner.take(1);
        let mut value = String::new();
        let closed = loop {
            value.push_str(
                self.scanner
                    .take_while(|c| !matches!(c, '"' | '\\' | '\n' | '\r')),
            );
            match self.scanner.take_any(&["\"\"", "\""]) {
                Some("\"\"") => value.push('"'),
                Some(_) => break true,
                None if self.scanner.peek() == Some('\\') => self.escape(&mut value),
                None => break false,
            }
        };
        let length = value.chars().count();
        if length > TEXT_LIMIT {
            let message = format!("the string has {length} characters, at most {TEXT_LIMIT} fit");
            self.report("RAPID0004", start, message);
        }
        self.push(start, Token::Text(value.clone()));
        if !closed {
            self.report_with_help(
                "RAPID0002",
                start,
                "the string is not closed on its line",
                "add a double quote; a double quote inside a string is written twice",
            );
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
        let start = self.scanner.at();
        let rest = self.scanner.rest();
        let code = rest.get(1..3).map(|hex| u8::from_str_radix(hex, 16));
        if rest.starts_with("\\\\") {
            value.push('\\');
            self.scanner.take(2);
        } else if let Some(Ok(code)) = code {
            value.push(char::from(code));
            self.scanner.take(3);
        } else {
            value.push('\\');
            self.scanner.take(1);
            self.report_with_help(
                "RAPID0005",
                start,
                "a backslash in a string begins an escape",
                "write \\\\ for a backslash, or \\ and two hexadecimal digits: \"\\0D\"",
            );
        }
    }
}
