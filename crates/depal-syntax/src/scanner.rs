use crate::Span;

/// A place that moves through a text, and the pieces that all languages cut from it alike.
#[derive(Debug, Clone)]
pub struct Scanner<'a> {
    file: u32,
    text: &'a str,
    at: usize,
}

impl<'a> Scanner<'a> {
    /// At the beginning of a text, behind its byte order mark.
    pub fn new(file: u32, text: &'a str) -> Self {
        let body = text.strip_prefix('\u{feff}').unwrap_or(text);
        Self {
            file,
            text,
            at: text.len() - body.len(),
        }
    }

    /// At byte `start` of a text that is read up to byte `end`; both are borders of characters.
    pub fn within(file: u32, text: &'a str, start: usize, end: usize) -> Self {
        Self {
            file,
            text: &text[..end],
            at: start,
        }
    }

    /// The byte it has come to.
    pub fn at(&self) -> usize {
        self.at
    }

    /// What is still to be read.
    pub fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    /// The next character.
    pub fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// From a byte that was passed to here.
    pub fn span_from(&self, start: usize) -> Span {
        Span::new(self.file, start as u32, self.at as u32)
    }

    /// What was read from a byte to here.
    pub fn text_from(&self, start: usize) -> &'a str {
        &self.text[start..self.at]
    }

    /// Passes so many bytes, up to the border of a character, and gives them back.
    pub fn take(&mut self, length: usize) -> &'a str {
        let taken = &self.rest()[..length];
        self.at += length;
        taken
    }

    /// Passes the characters up to the first that does not fit, and gives them back.
    pub fn take_while(&mut self, fits: impl Fn(char) -> bool) -> &'a str {
        let rest = self.rest();
        self.take(rest.find(|c| !fits(c)).unwrap_or(rest.len()))
    }

    /// Passes what is left of the line, and gives it back without the line's end.
    pub fn take_line(&mut self) -> &'a str {
        self.take_while(|c| c != '\n' && c != '\r')
    }

    /// Passes the first of these marks that stands here. Longer ones must come before their beginnings.
    pub fn take_any(&mut self, marks: &[&'static str]) -> Option<&'static str> {
        let rest = self.rest();
        let mark = marks.iter().find(|mark| rest.starts_with(**mark))?;
        self.at += mark.len();
        Some(mark)
    }

    /// Whether a digit stands here, or a point before a digit.
    pub fn is_at_number(&self) -> bool {
        let rest = self.rest();
        let digits = rest.strip_prefix('.').unwrap_or(rest);
        digits.starts_with(|c: char| c.is_ascii_digit())
    }

    /// Passes digits, a point with digits, and an exponent, each if it is there: the value, and whether it was
    /// only digits. An `E` without digits is no exponent. To be called where [a number begins](Self::is_at_number).
    pub fn take_number(&mut self) -> (f64, bool) {
        let start = self.at;
        let is_digit = |c: char| c.is_ascii_digit();
        let mut integer = true;
        self.take_while(is_digit);
        if self.rest().starts_with('.') {
            integer = false;
            self.at += 1;
            self.take_while(is_digit);
        }
        if let Some(exponent) = self.rest().strip_prefix(['e', 'E']) {
            let digits = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
            if digits.starts_with(is_digit) {
                integer = false;
                self.at += self.rest().len() - digits.len();
                self.take_while(is_digit);
            }
        }
        // Digits, point and exponent as above always read as a number.
        (self.text_from(start).parse().unwrap_or(f64::NAN), integer)
    }
}
