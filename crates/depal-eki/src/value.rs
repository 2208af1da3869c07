use std::fmt;

/// The type of an element in a configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ElementType {
    /// Text.
    String,
    /// A decimal number.
    Real,
    /// A 32-bit whole number.
    Int,
    /// 0, 1, TRUE or FALSE.
    Bool,
    /// Six attributes X, Y, Z, A, B, C.
    Frame,
    /// Raw bytes of a fixed number.
    Byte,
    /// Raw bytes up to an end string.
    Stream,
}

impl ElementType {
    /// By the word of the file.
    pub(crate) fn from_word(word: &str) -> Option<Self> {
        Some(match word {
            "STRING" => Self::String,
            "REAL" => Self::Real,
            "INT" => Self::Int,
            "BOOL" => Self::Bool,
            "FRAME" => Self::Frame,
            "BYTE" => Self::Byte,
            "STREAM" => Self::Stream,
            _ => return None,
        })
    }

    /// Whether it may stand in an XML section.
    pub(crate) fn is_xml(self) -> bool {
        !matches!(self, Self::Byte | Self::Stream)
    }
}

impl fmt::Display for ElementType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::String => "STRING",
            Self::Real => "REAL",
            Self::Int => "INT",
            Self::Bool => "BOOL",
            Self::Frame => "FRAME",
            Self::Byte => "BYTE",
            Self::Stream => "STREAM",
        })
    }
}

/// Names of the attributes of a FRAME, in order.
pub(crate) const FRAME_FIELDS: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];

/// A value in the memory of an element.
#[derive(Debug, Clone, PartialEq)]
pub enum ElementValue {
    /// Text.
    String(String),
    /// A number.
    Real(f64),
    /// A whole number.
    Int(i32),
    /// A truth value.
    Bool(bool),
    /// X, Y, Z, A, B, C.
    Frame([f64; 6]),
    /// A raw record, without its end string.
    Bytes(Vec<u8>),
}

impl ElementValue {
    /// From the text of an element or attribute; the error says what was expected.
    pub(crate) fn parse(kind: ElementType, text: &str) -> Result<Self, String> {
        let word = text.trim();
        let expected = |what: &str| format!("expected {what}, found \"{}\"", shortened(word));
        match kind {
            ElementType::Real => parse_real(word)
                .map(Self::Real)
                .ok_or_else(|| expected("a finite number")),
            ElementType::Int => word
                .parse()
                .map(Self::Int)
                .map_err(|_| expected("a whole number of 32 bits")),
            ElementType::Bool if word == "1" || word.eq_ignore_ascii_case("true") => {
                Ok(Self::Bool(true))
            }
            ElementType::Bool if word == "0" || word.eq_ignore_ascii_case("false") => {
                Ok(Self::Bool(false))
            }
            ElementType::Bool => Err(expected("0, 1, TRUE or FALSE")),
            ElementType::Frame => Err("a frame has no text but six attributes".to_owned()),
            ElementType::String | ElementType::Byte | ElementType::Stream => {
                Ok(Self::String(text.to_owned()))
            }
        }
    }

    /// As it is sent: six decimals, truth values as 0 and 1. A frame has attributes instead.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::String(text) => text.clone(),
            Self::Real(number) => decimal(*number),
            Self::Int(number) => number.to_string(),
            Self::Bool(value) => u8::from(*value).to_string(),
            Self::Frame(_) => String::new(),
            Self::Bytes(bytes) => String::from_utf8_lossy(bytes).into_owned(),
        }
    }
}

/// A finite number.
pub(crate) fn parse_real(word: &str) -> Option<f64> {
    word.parse::<f64>().ok().filter(|number| number.is_finite())
}

/// Six decimals; no negative zero.
pub(crate) fn decimal(number: f64) -> String {
    let text = format!("{number:.6}");
    if text == "-0.000000" {
        "0.000000".to_owned()
    } else {
        text
    }
}

/// At most 40 characters for a message.
pub(crate) fn shortened(text: &str) -> String {
    const LONGEST: usize = 40;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST).chain("...".chars()).collect()
}
