use depal_syntax::{Diagnostic, Scanner, Span, SpannedToken, Token};

/// Longest first, so that `==` wins over `=`.
const MARKS: [&str; 21] = [
    "==", "<>", "<=", ">=", "<", ">", "=", "+", "-", "*", "/", "(", ")", "[", "]", "{", "}", ",",
    ":", ".", "#",
];

/// Longest name.
const NAME_LIMIT: usize = 24;

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

fn in_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '$'
}

impl Lexer<'_> {
    fn push(&mut self, start: usize, token: Token) {
        let span = self.scanner.span_from(start);
        self.tokens.push(SpannedToken { token, span });
    }

    fn push_integer(&mut self, start: usize, value: f64) {
        let integer = true;
        self.push(start, Token::Number { value, integer });
    }

    /// Reports what stands from `start` to here.
    fn report(&mut self, code: &'static str, start: usize, message: String, help: &str) {
        let span = self.scanner.span_from(start);
        self.diagnostics
            .push(Diagnostic::error(code, span, message).help(help));
    }

    fn end_line(&mut self, span: Span) {
        let blank = self.tokens.last().is_none_or(|t| t.token == Token::Line);
        if !blank {
            let token = Token::Line;
            self.tokens.push(SpannedToken { token, span });
        }
    }

    fn run(&mut self) {
        let mut line_begins = true;
        while let Some(c) = self.scanner.peek() {
            let start = self.scanner.at();
            let here = self.scanner.span_from(start);
            let begins = std::mem::replace(&mut line_begins, false);
            match c {
                '\n' | '\r' => {
                    self.scanner.take(1);
                    self.end_line(here);
                    line_begins = true;
                }
                ';' => {
                    self.scanner.take_line();
                }
                // Header lines: &ACCESS, &REL, &PARAM.
                '&' if begins => {
                    self.scanner.take_line();
                }
                c if c.is_whitespace() || c == '\u{1a}' || c == '\0' => {
                    self.scanner.take(c.len_utf8());
                    line_begins = begins;
                }
                c if c.is_alphabetic() || c == '_' || c == '$' => self.name(),
                _ if self.scanner.is_at_number() => {
                    let (value, integer) = self.scanner.take_number();
                    self.push(start, Token::Number { value, integer });
                }
                '"' => self.string(),
                '\'' => self.based_number(),
                c => {
                    if let Some(mark) = self.scanner.take_any(&MARKS) {
                        self.push(start, Token::Mark(mark));
                    } else {
                        self.scanner.take(c.len_utf8());
                        self.diagnostics.push(Diagnostic::error(
                            "KRL0001",
                            self.scanner.span_from(start),
                            format!("the character {c:?} has no meaning here"),
                        ));
                    }
                }
            }
        }
        let end = self.scanner.at();
        self.end_line(self.scanner.span_from(end));
        self.push(end, Token::End);
    }

    fn name(&mut self) {
        let start = self.scanner.at();
        let name = self.scanner.take_while(in_name);
        // The system's own variables may be longer.
        if name.chars().count() > NAME_LIMIT && !name.starts_with('$') {
            self.report(
                "KRL0003",
                start,
                format!("the name {name} is longer than {NAME_LIMIT} characters"),
                "shorten it; the controller refuses longer names",
            );
        }
        self.push(start, Token::Name(name.to_owned()));
    }

    /// `'H1F'`, `'B0101'`.
    fn based_number(&mut self) {
        let start = self.scanner.at();
        let body = &self.scanner.rest()[1..];
        let radix = match body.bytes().next().map(|b| b.to_ascii_lowercase()) {
            Some(b'h') => 16,
            Some(b'b') => 2,
            _ => 0,
        };
        if radix > 0
            && let Some(end) = body.find('\'')
            && let Ok(value) = u32::from_str_radix(&body[1..end], radix)
        {
            self.scanner.take(end + 2);
            // All 32 bits may be written; the first is the sign.
            self.push_integer(start, f64::from(value as i32));
            return;
        }
        let length = body.find(|c: char| !c.is_alphanumeric());
        let length = length.unwrap_or(body.len());
        self.scanner
            .take(1 + length + usize::from(body[length..].starts_with('\'')));
        self.push_integer(start, 0.0);
        self.report(
            "KRL0005",
            start,
            "this is no hexadecimal or binary number".into(),
            "write 'H1F' or 'B0101', of at most 32 bits",
        );
    }

    fn string(&mut self) {
        let start = self.scanner.at();
        self.scanner.take(1);
        let in_text = |c: char| !matches!(c, '"' | '\n' | '\r');
        let value = self.scanner.take_while(in_text).to_owned();
        let closed = self.scanner.take_any(&["\""]).is_some();
        if !closed {
            self.report(
                "KRL0002",
                start,
                "the string is not closed on its line".into(),
                "add a double quote",
            );
        }
        let closes_call = !closed && value.ends_with(')');
        self.push(start, Token::Text(value));
        if closes_call {
            self.push(start, Token::Mark(")"));
        }
    }
}
