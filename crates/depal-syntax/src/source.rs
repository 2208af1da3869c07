use std::fmt;

/// A program text with the name it goes by in messages.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SourceFile {
    /// As the user gave it: a path, or a name for an embedded text.
    pub name: String,
    /// The decoded text.
    pub text: String,
}

/// A piece of a source text: file index and half-open byte range in the decoded text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct Span {
    /// Index into the list of files that were loaded together.
    pub file: u32,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

/// A place as people name it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct LineColumn {
    /// From 1.
    pub line: u32,
    /// From 1, in characters.
    pub column: u32,
}

impl fmt::Display for LineColumn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

impl SourceFile {
    /// A file of this name and text.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            text: text.into(),
        }
    }

    /// Line and column of a byte offset; an offset behind the end is the end.
    pub fn line_column(&self, offset: u32) -> LineColumn {
        let mut end = (offset as usize).min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &self.text[..end];
        let line = before.bytes().filter(|b| *b == b'\n').count() as u32 + 1;
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        let column = before[line_start..].chars().count() as u32 + 1;
        LineColumn { line, column }
    }

    /// The text of a line, from 1, without its end; empty if there is no such line.
    pub fn line_text(&self, line: u32) -> &str {
        let index = (line as usize).saturating_sub(1);
        self.text.lines().nth(index).unwrap_or_default()
    }
}

impl Span {
    /// A span of `file`.
    pub fn new(file: u32, start: u32, end: u32) -> Self {
        Self { file, start, end }
    }

    /// From the start of `self` to the end of `other`; `self` if they lie in different files.
    pub fn to(self, other: Self) -> Self {
        if self.file == other.file {
            Self {
                file: self.file,
                start: self.start.min(other.start),
                end: self.end.max(other.end),
            }
        } else {
            self
        }
    }
}

/// Where the lines of several texts begin.
#[derive(Debug, Clone, Default)]
pub struct LineStarts {
    files: Vec<Vec<u32>>,
}

impl LineStarts {
    /// Of texts in the order in which spans count them.
    pub fn new(files: &[SourceFile]) -> Self {
        let starts = |file: &SourceFile| {
            let bytes = file.text.bytes().zip(1..);
            let begun = bytes
                .filter(|(byte, _)| *byte == b'\n')
                .map(|(_, next)| next);
            std::iter::once(0).chain(begun).collect()
        };
        Self {
            files: files.iter().map(starts).collect(),
        }
    }

    /// The line in which a span begins, from 1; 1 in a text that is not among them.
    pub fn line(&self, span: Span) -> u32 {
        let starts = self.files.get(span.file as usize);
        starts.map_or(1, |starts| {
            starts.partition_point(|start| *start <= span.start) as u32
        })
    }
}

/// The text of a program file: UTF-8, with or without a byte order mark, else Windows-1252.
pub fn decode(bytes: &[u8]) -> String {
    // What ISO-8859-1 leaves to control characters, from 0x80 to 0x9F.
    const UPPER: [char; 32] = [
        '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž',
        '\u{8f}', '\u{90}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}',
        'ž', 'Ÿ',
    ];
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes
            .iter()
            .map(|byte| match byte {
                0x80..=0x9f => UPPER[usize::from(byte - 0x80)],
                byte => char::from(*byte),
            })
            .collect(),
    }
}
