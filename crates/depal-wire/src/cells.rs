//! Cells: the common middle of all encodings. A message is a row of integers and reals.

use std::fmt::Write as _;

use crate::{AsciiTerminator, Encoding, HexPlanCells, Profile};

/// Why a field could not be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum FieldError {
    /// The text ended before this field.
    Missing { place: usize },
    /// Not a number of the wanted kind, or out of 32 bits.
    Unreadable { place: usize, found: String },
    /// A number, but NaN or infinite.
    NotFinite { place: usize },
    /// A text, which packed cells cannot carry.
    TextInHex { place: usize },
    /// More fields than the command has.
    Extra { expected: usize, found: usize },
}

impl std::fmt::Display for FieldError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Missing { place } => write!(f, "field {place} is missing"),
            Self::Unreadable { place, found } => {
                write!(f, "field {place}: expected a number, found {found:?}")
            }
            Self::NotFinite { place } => write!(f, "field {place} is not a finite number"),
            Self::TextInHex { place } => {
                write!(
                    f,
                    "field {place} is a text; this command exists in ASCII only"
                )
            }
            Self::Extra { expected, found } => {
                write!(f, "expected {expected} fields, found {found}")
            }
        }
    }
}

/// Reads the cells of one message in order.
///
/// ASCII knows how many fields came; HEX is filled with zeros to any length.
pub(crate) struct CellReader<'a> {
    source: Source<'a>,
    /// Fields read so far; the first field has place 1.
    read: usize,
    is_cut_off: bool,
}

enum Source<'a> {
    Ascii(Vec<&'a str>),
    Hex { bytes: &'a [u8], big_endian: bool },
}

impl<'a> CellReader<'a> {
    /// Over one frame. ASCII frames may still carry their terminator.
    pub(crate) fn new(encoding: Encoding, frame: &'a [u8]) -> Self {
        let source = match encoding {
            Encoding::Ascii => Source::Ascii(split_fields(frame)),
            Encoding::HexLittleEndian => Source::Hex {
                bytes: frame,
                big_endian: false,
            },
            Encoding::HexBigEndian => Source::Hex {
                bytes: frame,
                big_endian: true,
            },
        };
        Self {
            source,
            read: 0,
            is_cut_off: false,
        }
    }

    /// Fields not yet read; `None` in HEX, where zeros follow for ever.
    pub(crate) fn remaining(&self) -> Option<usize> {
        match &self.source {
            Source::Ascii(fields) => Some(fields.len().saturating_sub(self.read)),
            Source::Hex { .. } => None,
        }
    }

    /// The next field as an integer; `1.0` counts as one.
    pub(crate) fn int(&mut self) -> Result<i32, FieldError> {
        let place = self.read + 1;
        let value = match &self.source {
            Source::Ascii(fields) => {
                let text = *fields.get(self.read).ok_or(FieldError::Missing { place })?;
                let unreadable = || FieldError::Unreadable {
                    place,
                    found: text.chars().take(40).collect(),
                };
                let value = parse_real(text).ok_or_else(unreadable)?;
                let whole = value.fract() == 0.0
                    && value >= f64::from(i32::MIN)
                    && value <= f64::from(i32::MAX);
                if !whole {
                    return Err(unreadable());
                }
                value as i32
            }
            Source::Hex { .. } => i32::from_le_bytes(self.word()),
        };
        self.read += 1;
        Ok(value)
    }

    /// The next field as a finite real.
    pub(crate) fn real(&mut self) -> Result<f64, FieldError> {
        let place = self.read + 1;
        let value = match &self.source {
            Source::Ascii(fields) => {
                let text = *fields.get(self.read).ok_or(FieldError::Missing { place })?;
                if is_non_finite_word(text) {
                    f64::NAN
                } else {
                    parse_real(text).ok_or_else(|| FieldError::Unreadable {
                        place,
                        found: text.chars().take(40).collect(),
                    })?
                }
            }
            Source::Hex { .. } => f64::from(f32::from_le_bytes(self.word())),
        };
        self.read += 1;
        if value.is_finite() {
            Ok(value)
        } else {
            Err(FieldError::NotFinite { place })
        }
    }

    /// The next `N` fields as finite reals. A HEX message may end before them, or in their midst if nothing but
    /// zeros came of them; zeros in place of what is missing of a pose would make another pose.
    pub(crate) fn reals<const N: usize>(&mut self) -> Result<[f64; N], FieldError> {
        if let Source::Hex { bytes, .. } = &self.source {
            let begun = bytes.get(4 * self.read..).unwrap_or_default();
            if begun.len() < 4 * N && begun.iter().any(|byte| *byte != 0) {
                self.is_cut_off = true;
                let place = self.read + begun.len() / 4 + 1;
                return Err(FieldError::Missing { place });
            }
        }
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.real()?;
        }
        Ok(values)
    }

    /// The next field as a text that is not empty.
    pub(crate) fn text(&mut self) -> Result<String, FieldError> {
        let place = self.read + 1;
        let Source::Ascii(fields) = &self.source else {
            return Err(FieldError::TextInHex { place });
        };
        let text = fields.get(self.read).filter(|text| !text.is_empty());
        let text = (*text.ok_or(FieldError::Missing { place })?).to_owned();
        self.read += 1;
        Ok(text)
    }

    /// Whether a row of reals was begun and is not there to its end. Never in ASCII.
    pub(crate) fn is_cut_off(&self) -> bool {
        self.is_cut_off
    }

    /// All fields have been read. Always true in HEX.
    pub(crate) fn end(&self) -> Result<(), FieldError> {
        match self.remaining() {
            Some(left) if left > 0 => Err(FieldError::Extra {
                expected: self.read,
                found: self.read + left,
            }),
            _ => Ok(()),
        }
    }

    /// The current cell, least significant byte first, zero past the end of the frame.
    fn word(&self) -> [u8; 4] {
        let Source::Hex { bytes, big_endian } = &self.source else {
            return [0; 4];
        };
        let mut word = [0; 4];
        let start = self.read.saturating_mul(4).min(bytes.len());
        for (to, from) in word.iter_mut().zip(&bytes[start..]) {
            *to = *from;
        }
        if *big_endian {
            word.reverse();
        }
        word
    }
}

/// Fields of an ASCII frame: separated by commas, blanks trimmed, empty ones at the end dropped.
fn split_fields(frame: &[u8]) -> Vec<&str> {
    // What is not UTF-8 cannot be a number; an unreadable field says so to the robot.
    let text = std::str::from_utf8(frame).unwrap_or("?");
    let mut fields: Vec<&str> = text
        .split(',')
        .map(|field| field.trim_matches(|c: char| c.is_ascii_whitespace() || c == '\0'))
        .collect();
    while fields.last().is_some_and(|field| field.is_empty()) {
        fields.pop();
    }
    fields
}

fn is_non_finite_word(text: &str) -> bool {
    let word = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
    matches!(word.as_str(), "nan" | "inf" | "infinity")
}

/// A decimal number: sign, digits with an optional point, optional exponent; may overflow to infinity.
/// The standard parser's words for NaN and infinity are no numbers here.
fn parse_real(text: &str) -> Option<f64> {
    let plain = text
        .bytes()
        .all(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b'e' | b'E'));
    if plain { text.parse().ok() } else { None }
}

/// One value of a message.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Cell {
    /// 32-bit integer.
    Int(i32),
    /// Real: single precision in HEX, decimals of the profile in ASCII.
    Real(f64),
    /// A whole number without a point in ASCII; in HEX single precision or an integer, as the profile says.
    Count(f64),
    /// Text: ASCII only; a zero in HEX.
    Text(String),
}

/// Collects the cells of one message.
#[derive(Debug, Default)]
pub(crate) struct CellWriter {
    cells: Vec<Cell>,
}

impl CellWriter {
    pub(crate) fn int(&mut self, value: i32) {
        self.cells.push(Cell::Int(value));
    }

    pub(crate) fn real(&mut self, value: f64) {
        self.cells.push(Cell::Real(value));
    }

    /// A whole number among reals: labels and counters of the plan data.
    pub(crate) fn count(&mut self, value: f64) {
        self.cells.push(Cell::Count(value));
    }

    pub(crate) fn text_field(&mut self, value: &str) {
        self.cells.push(Cell::Text(value.to_owned()));
    }

    pub(crate) fn reals(&mut self, values: &[f64]) {
        for value in values {
            self.real(*value);
        }
    }

    /// A reply as bytes.
    pub(crate) fn reply_bytes(&self, encoding: Encoding, profile: &Profile) -> Vec<u8> {
        if encoding.is_hex() {
            let cells = self.hex_bytes(encoding, profile.hex_plan_cells);
            let length = profile.hex_reply_len(cells.len());
            return padded(cells, length);
        }
        let mut text = self.ascii_text(usize::MAX, |text, value| {
            short_real(text, value, profile.ascii_decimals);
        });
        if profile.ascii_trailing_comma {
            text.push(',');
        }
        text.push_str(match profile.ascii_terminator {
            AsciiTerminator::None => "",
            AsciiTerminator::Cr => "\r",
            AsciiTerminator::Lf => "\n",
            AsciiTerminator::CrLf => "\r\n",
        });
        text.into_bytes()
    }

    /// A request as bytes, as robots send it: six decimals and CR, or a padded frame.
    pub(crate) fn request_bytes(&self, encoding: Encoding, profile: &Profile) -> Vec<u8> {
        if encoding.is_hex() {
            let cells = self.hex_bytes(encoding, profile.hex_plan_cells);
            let length = profile.hex_request_len.max(cells.len());
            return padded(cells, length);
        }
        let mut text = self.ascii_text(usize::MAX, |text, value| {
            let _ = write!(text, "{value:.6}");
        });
        text.push('\r');
        text.into_bytes()
    }

    /// The cells as text without terminator, for logs.
    pub(crate) fn text(&self) -> String {
        self.text_head(usize::MAX)
    }

    /// The beginning of [`text`](Self::text): whole fields, until there are at least `most` bytes.
    pub(crate) fn text_head(&self, most: usize) -> String {
        self.ascii_text(most, |text, value| short_real(text, value, 4))
    }

    /// All in one buffer: replies of 20 points are mostly the writing of numbers.
    fn ascii_text(&self, most: usize, real: impl Fn(&mut String, f64)) -> String {
        let mut text = String::with_capacity(most.min(8 * self.cells.len()) + 16);
        for (place, cell) in self.cells.iter().enumerate() {
            if text.len() >= most {
                break;
            }
            if place > 0 {
                text.push(',');
            }
            // Writing to a string cannot fail.
            let _ = match cell {
                Cell::Int(value) => write!(text, "{value}"),
                Cell::Real(value) => {
                    real(&mut text, *value);
                    Ok(())
                }
                Cell::Count(value) => write!(text, "{value:.0}"),
                Cell::Text(value) => text.write_str(value),
            };
        }
        text
    }

    fn hex_bytes(&self, encoding: Encoding, counts: HexPlanCells) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.cells.len() * 4);
        for cell in &self.cells {
            let mut word = match cell {
                Cell::Int(value) => value.to_le_bytes(),
                Cell::Count(value) if counts == HexPlanCells::IntegerCounts => {
                    (*value as i32).to_le_bytes()
                }
                Cell::Real(value) | Cell::Count(value) => (*value as f32).to_le_bytes(),
                Cell::Text(_) => [0; 4],
            };
            if encoding == Encoding::HexBigEndian {
                word.reverse();
            }
            bytes.extend(word);
        }
        bytes
    }
}

fn padded(mut bytes: Vec<u8>, length: usize) -> Vec<u8> {
    bytes.resize(length.max(bytes.len()), 0);
    bytes
}

/// Rounded to `decimals`, zeros stripped down to one decimal, never `-0.0`.
fn short_real(text: &mut String, value: f64, decimals: usize) {
    let start = text.len();
    let _ = write!(text, "{value:.decimals$}");
    if text[start..].contains('.') {
        while text.ends_with('0') && !text.ends_with(".0") {
            text.pop();
        }
    } else {
        text.push_str(".0");
    }
    if &text[start..] == "-0.0" {
        text.remove(start);
    }
}
