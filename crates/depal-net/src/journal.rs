//! What came and went, as JSON lines, so that a session can be answered again.
//!
//! The first line is a [`Header`], every other an [`Entry`]. A received piece holds the bytes as they were
//! handed to the server, usually one command; `tick` counts 4 ms of simulated time.

use std::io::Write;

use serde::{Deserialize, Serialize};

/// Version of the format.
pub const FORMAT: u32 = 1;

/// What was served.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// Version of the format: [`FORMAT`].
    pub journal: u32,
    /// Version of the program.
    pub version: String,
    /// Name of the scene.
    pub scene: String,
    /// Its file; absent: the built-in demo.
    pub file: Option<String>,
    /// Overrides of its keys.
    pub set: Vec<String>,
    /// Faults beyond those of the scene.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub inject: Vec<String>,
    /// Kind of each port.
    pub ports: Vec<String>,
}

/// One line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// When.
    pub tick: u64,
    /// Place of the port in the header's list.
    pub port: u16,
    /// Number of the client.
    pub client: u64,
    /// What.
    #[serde(flatten)]
    pub what: What,
}

/// What happened on a connection.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum What {
    /// A client came.
    Connected {
        /// From where.
        peer: String,
    },
    /// Bytes came.
    Received {
        /// In hexadecimal.
        hex: String,
        /// The same for people, where they are text.
        #[serde(skip_serializing_if = "Option::is_none", default)]
        text: Option<String>,
    },
    /// One reply was given.
    Sent {
        /// In hexadecimal.
        hex: String,
        /// The same for people, where it is text.
        #[serde(skip_serializing_if = "Option::is_none", default)]
        text: Option<String>,
    },
    /// The client is gone.
    Disconnected {},
    /// Last line: the server was stopped.
    Ended {},
}

impl What {
    pub(crate) fn received(bytes: &[u8]) -> Self {
        let (hex, text) = (hex(bytes), text(bytes));
        Self::Received { hex, text }
    }

    pub(crate) fn sent(bytes: &[u8]) -> Self {
        let (hex, text) = (hex(bytes), text(bytes));
        Self::Sent { hex, text }
    }
}

/// Writes lines; each is with the system before what it tells of leaves the process.
pub struct Journal {
    out: Box<dyn Write + Send>,
    waiting: Vec<u8>,
}

impl Journal {
    /// Writes the header.
    pub fn start(out: Box<dyn Write + Send>, header: &Header) -> std::io::Result<Self> {
        let mut journal = Self {
            out,
            waiting: Vec::new(),
        };
        journal.line(header)?;
        journal.flush()?;
        Ok(journal)
    }

    pub(crate) fn add(&mut self, entry: &Entry) -> std::io::Result<()> {
        self.line(entry)
    }

    pub(crate) fn flush(&mut self) -> std::io::Result<()> {
        if !self.waiting.is_empty() {
            self.out.write_all(&self.waiting)?;
            self.out.flush()?;
            self.waiting.clear();
        }
        Ok(())
    }

    fn line(&mut self, line: &impl Serialize) -> std::io::Result<()> {
        serde_json::to_writer(&mut self.waiting, line)?;
        self.waiting.push(b'\n');
        Ok(())
    }
}

/// A journal that was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recorded {
    /// What was served.
    pub header: Header,
    /// The lines, in order.
    pub entries: Vec<Entry>,
}

/// Why a text is no journal.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct JournalError {
    /// Line, from 1.
    pub line: usize,
    /// Expected and found.
    pub message: String,
}

/// Reads a journal. A last line that was cut off while it was written is left out.
pub fn read(text: &str) -> Result<Recorded, JournalError> {
    let error = |place: usize, message: String| JournalError {
        line: place + 1,
        message,
    };
    let mut lines = text.lines().enumerate();
    let (_, first) = lines
        .next()
        .ok_or_else(|| error(0, "expected a header, found an empty file".to_owned()))?;
    let header: Header = serde_json::from_str(first)
        .map_err(|e| error(0, format!("expected the header of a journal: {e}")))?;
    if header.journal != FORMAT {
        let found = header.journal;
        return Err(error(0, format!("expected format {FORMAT}, found {found}")));
    }
    let count = text.lines().count();
    let mut entries = Vec::new();
    for (place, line) in lines {
        match serde_json::from_str(line) {
            Ok(entry) => entries.push(entry),
            Err(_) if place + 1 == count && !text.ends_with('\n') => {}
            Err(e) => return Err(error(place, format!("expected an entry: {e}"))),
        }
    }
    Ok(Recorded { header, entries })
}

/// Two digits a byte.
pub(crate) fn hex(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 16] = b"0123456789abcdef";
    let digits = |byte: &u8| {
        [
            DIGITS[usize::from(byte >> 4)],
            DIGITS[usize::from(byte & 15)],
        ]
    };
    bytes.iter().flat_map(digits).map(char::from).collect()
}

/// The bytes of two digits each.
pub(crate) fn from_hex(hex: &str) -> Option<Vec<u8>> {
    let digits: Option<Vec<u8>> = hex
        .chars()
        .map(|c| c.to_digit(16).map(|digit| digit as u8))
        .collect();
    let digits = digits?;
    digits.len().is_multiple_of(2).then(|| {
        digits
            .chunks_exact(2)
            .map(|pair| pair[0] << 4 | pair[1])
            .collect()
    })
}

/// The bytes as text, if they are printable.
fn text(bytes: &[u8]) -> Option<String> {
    let is_text = |b: &u8| b.is_ascii_graphic() || matches!(b, b' ' | b'\r' | b'\n');
    (!bytes.is_empty() && bytes.iter().all(is_text))
        .then(|| String::from_utf8_lossy(bytes).into_owned())
}
