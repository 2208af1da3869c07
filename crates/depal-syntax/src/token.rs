use crate::Span;

/// A token. Keywords are names; a parser compares them without regard to case.
#[derive(Debug, Clone, PartialEq)]
pub enum Token {
    /// A word.
    Name(String),
    /// A number without sign.
    Number {
        /// Its value.
        value: f64,
        /// Whether it is written as a whole number, without point and exponent.
        integer: bool,
    },
    /// A string, without its quotes.
    Text(String),
    /// An operator or a mark: `:=`, `<>`, `;`.
    Mark(&'static str),
    /// The end of a line that has something on it, in languages where lines count.
    Line,
    /// The end of the text.
    End,
}

impl Token {
    /// What it is, as messages say it: "found ...".
    pub fn describe(&self) -> String {
        match self {
            Self::Name(name) => name.clone(),
            Self::Number { value, .. } => format!("the number {value}"),
            Self::Text(_) => "a string".into(),
            Self::Mark(mark) => format!("`{mark}`"),
            Self::Line => "the end of the line".into(),
            Self::End => "the end of the file".into(),
        }
    }
}

/// A token with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct SpannedToken {
    /// What.
    pub token: Token,
    /// Where.
    pub span: Span,
}

impl From<(Token, Span)> for SpannedToken {
    fn from((token, span): (Token, Span)) -> Self {
        Self { token, span }
    }
}
