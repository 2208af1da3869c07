use crate::{EkiError, Limits};

/// Where in the markup the next byte stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum State {
    /// Text, or between documents.
    #[default]
    Content,
    /// Behind `<`.
    Open,
    /// Behind `<!`, with so many bytes of `--` or `[CDATA[` seen.
    Bang { cdata: bool, seen: usize },
    /// In a comment, with so many dashes just before.
    Comment { dashes: u8 },
    /// In a CDATA section, with so many `]` just before.
    CData { brackets: u8 },
    /// In a declaration or processing instruction, with a `?` just before.
    Instruction { question: bool },
    /// In a start tag.
    Start {
        quote: Option<u8>,
        slash: bool,
        attributes: usize,
    },
    /// In an end tag.
    End,
}

const CDATA: &[u8] = b"[CDATA[";

/// Cuts a byte stream into XML documents: a document ends when its root closes. There is no prefix and no terminator.
///
/// Works a byte at a time, so that the cuts of the stream cannot matter, in time linear in the bytes, and refuses what
/// is beyond the [`Limits`], and any DOCTYPE, as soon as it shows. Names of tags and attributes are not looked at:
/// [`Document::parse`](crate::Document::parse) does that with the bytes of one document.
#[derive(Debug, Clone, Default)]
pub struct DocumentSplitter {
    limits: Limits,
    state: State,
    depth: usize,
    line: u32,
    bytes: Vec<u8>,
}

impl DocumentSplitter {
    /// For a fresh connection.
    pub fn new(limits: Limits) -> Self {
        Self {
            limits,
            line: 1,
            ..Self::default()
        }
    }

    /// Bytes of the document that has begun; 0 between documents.
    pub fn pending(&self) -> usize {
        self.bytes.len()
    }

    /// Whether nothing but blanks, comments and declarations has come since the last document.
    pub fn is_between(&self) -> bool {
        self.depth == 0 && self.state == State::Content
    }

    /// Takes a byte; gives the document that it completes.
    ///
    /// # Errors
    /// [`EkiError::Malformed`] or [`EkiError::TooManyBytes`]; nothing sensible can follow on this stream.
    pub fn push(&mut self, byte: u8) -> Result<Option<Vec<u8>>, EkiError> {
        if self.bytes.is_empty() && self.state == State::Content && byte.is_ascii_whitespace() {
            return Ok(None);
        }
        if self.bytes.len() >= self.limits.bytes {
            return Err(EkiError::TooManyBytes {
                limit: self.limits.bytes,
            });
        }
        self.bytes.push(byte);
        if byte == 0 {
            return self.refuse("a zero byte: not a document in UTF-8");
        }
        if byte == b'\n' {
            self.line += 1;
        }
        let complete = self.step(byte)?;
        if !complete {
            return Ok(None);
        }
        self.line = 1;
        Ok(Some(std::mem::take(&mut self.bytes)))
    }

    fn refuse<T>(&self, message: impl Into<String>) -> Result<T, EkiError> {
        Err(EkiError::Malformed {
            line: self.line,
            message: message.into(),
        })
    }

    /// Goes on by a byte; true if the root has closed.
    fn step(&mut self, byte: u8) -> Result<bool, EkiError> {
        self.state = match self.state {
            State::Content => self.content(byte)?,
            State::Open => match byte {
                b'!' => State::Bang {
                    cdata: false,
                    seen: 0,
                },
                b'?' => State::Instruction { question: false },
                b'/' if self.depth > 0 => State::End,
                b'/' => return self.refuse("an end tag without its start"),
                b'A'..=b'Z' | b'a'..=b'z' | b'_' | b':' | 0x80.. => State::Start {
                    quote: None,
                    slash: false,
                    attributes: 0,
                },
                _ => return self.refuse("no name behind '<'"),
            },
            State::Bang { cdata, seen } => self.bang(byte, cdata, seen)?,
            State::Comment { dashes } => match byte {
                b'-' => State::Comment {
                    dashes: (dashes + 1).min(2),
                },
                b'>' if dashes == 2 => State::Content,
                _ => State::Comment { dashes: 0 },
            },
            State::CData { brackets } => match byte {
                b']' => State::CData {
                    brackets: (brackets + 1).min(2),
                },
                b'>' if brackets == 2 => State::Content,
                _ => State::CData { brackets: 0 },
            },
            State::Instruction { question } => match byte {
                b'>' if question => State::Content,
                _ => State::Instruction {
                    question: byte == b'?',
                },
            },
            State::Start {
                quote,
                slash,
                attributes,
            } => return self.start_tag(byte, quote, slash, attributes),
            State::End => match byte {
                b'>' => {
                    self.depth -= 1;
                    self.state = State::Content;
                    return Ok(self.depth == 0);
                }
                b'<' => return self.refuse("'<' in an end tag"),
                _ => State::End,
            },
        };
        Ok(false)
    }

    fn content(&self, byte: u8) -> Result<State, EkiError> {
        if byte == b'<' {
            return Ok(State::Open);
        }
        if self.depth > 0 || byte.is_ascii_whitespace() {
            return Ok(State::Content);
        }
        let mark = [0xEF, 0xBB, 0xBF];
        if self.bytes.len() <= mark.len() && mark.starts_with(&self.bytes) {
            return Ok(State::Content);
        }
        if self.bytes.len() == 1 && byte >= 0xFE {
            return self.refuse("UTF-16: only UTF-8 is read");
        }
        self.refuse(format!(
            "byte 0x{byte:02X} outside of a document: expected '<'"
        ))
    }

    fn bang(&self, byte: u8, cdata: bool, seen: usize) -> Result<State, EkiError> {
        let state = match (cdata, seen, byte) {
            (false, 0, b'-') => State::Bang {
                cdata: false,
                seen: 1,
            },
            (false, 1, b'-') => State::Comment { dashes: 0 },
            (false, 0, b'[') if self.depth > 0 => State::Bang {
                cdata: true,
                seen: 1,
            },
            (true, seen, byte) if CDATA.get(seen) == Some(&byte) => {
                if seen + 1 == CDATA.len() {
                    State::CData { brackets: 0 }
                } else {
                    State::Bang {
                        cdata: true,
                        seen: seen + 1,
                    }
                }
            }
            (false, 0, b'D' | b'd') => return self.refuse("DOCTYPE is refused"),
            _ => return self.refuse("unknown markup behind '<!'"),
        };
        Ok(state)
    }

    fn start_tag(
        &mut self,
        byte: u8,
        quote: Option<u8>,
        slash: bool,
        attributes: usize,
    ) -> Result<bool, EkiError> {
        let mut next = State::Start {
            quote,
            slash: false,
            attributes,
        };
        match (quote, byte) {
            (_, b'<') => return self.refuse("'<' in a tag"),
            (Some(open), byte) => {
                if byte == open {
                    next = State::Start {
                        quote: None,
                        slash: false,
                        attributes,
                    };
                }
            }
            (None, b'"' | b'\'') => {
                next = State::Start {
                    quote: Some(byte),
                    slash: false,
                    attributes,
                };
            }
            (None, b'=') => {
                let attributes = attributes + 1;
                if attributes > self.limits.attributes {
                    return self.refuse(format!(
                        "more than {} attributes in a tag",
                        self.limits.attributes
                    ));
                }
                next = State::Start {
                    quote,
                    slash: false,
                    attributes,
                };
            }
            (None, b'/') => {
                next = State::Start {
                    quote,
                    slash: true,
                    attributes,
                };
            }
            (None, b'>') => {
                self.state = State::Content;
                if slash {
                    return Ok(self.depth == 0);
                }
                self.depth += 1;
                if self.depth > self.limits.depth {
                    return self.refuse(format!(
                        "elements more than {} deep inside one another",
                        self.limits.depth
                    ));
                }
                return Ok(false);
            }
            (None, _) => {}
        }
        self.state = next;
        Ok(false)
    }
}
