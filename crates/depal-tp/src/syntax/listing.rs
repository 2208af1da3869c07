//! Sections and lines of a listing.

use depal_syntax::{Diagnostic, Span};

use super::cursor::Cursor;
use super::lexer::{Kind, Token, tokens};
use super::positions::positions;
use super::tree::*;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Section {
    Outside,
    Heading,
    Lines,
    Positions,
}

/// The programs of a file. What cannot be read is reported, and the rest is read on.
pub(crate) fn parse(file: u32, text: &str, diagnostics: &mut Vec<Diagnostic>) -> Vec<Listing> {
    let mut reader = Reader {
        file,
        text,
        section: Section::Outside,
        listings: Vec::new(),
        pending: None,
        positions_from: 0,
        complained_outside: false,
        diagnostics,
    };
    let mut start = 0;
    for (index, line) in text.split_inclusive('\n').enumerate() {
        reader.line(start, line.trim_end_matches(['\n', '\r']), index as u32 + 1);
        start += line.len();
    }
    reader.finish(text.len());
    if reader.listings.is_empty() && !reader.complained_outside {
        let end = Span::new(file, 0, text.len().min(1) as u32);
        reader.diagnostics.push(missing_prog(end));
    }
    reader.listings
}

fn missing_prog(span: Span) -> Diagnostic {
    Diagnostic::error("TP0100", span, "there is no /PROG in this file")
        .help("a listing begins with /PROG and the name of the program")
}

/// An instruction whose end has not come yet.
struct Pending {
    number: u32,
    tokens: Vec<Token>,
    span: Span,
    is_ended: bool,
}

struct Reader<'a> {
    file: u32,
    text: &'a str,
    section: Section,
    listings: Vec<Listing>,
    pending: Option<Pending>,
    positions_from: usize,
    complained_outside: bool,
    diagnostics: &'a mut Vec<Diagnostic>,
}

impl Reader<'_> {
    fn span(&self, start: usize, length: usize) -> Span {
        Span::new(self.file, start as u32, (start + length) as u32)
    }

    fn line(&mut self, start: usize, line: &str, file_line: u32) {
        let trimmed = line.trim_start_matches('\u{feff}').trim();
        if let Some(rest) = trimmed.strip_prefix('/')
            && rest.starts_with(|c: char| c.is_ascii_alphabetic())
            && (self.section != Section::Lines || is_section(rest))
        {
            self.section_line(start, line, rest, file_line);
            return;
        }
        match self.section {
            Section::Lines => self.instruction_line(start, line),
            Section::Heading => self.attribute(trimmed),
            Section::Positions => {}
            Section::Outside => {
                if !trimmed.is_empty() && !self.complained_outside {
                    self.complained_outside = true;
                    let span = self.span(start, line.len());
                    self.diagnostics.push(missing_prog(span));
                }
            }
        }
    }

    fn section_line(&mut self, start: usize, line: &str, rest: &str, file_line: u32) {
        self.close(start);
        let mut words = rest.split_whitespace();
        let word = words.next().unwrap_or_default().to_uppercase();
        let at = start + line.find('/').unwrap_or(0);
        let span = self.span(at, word.len() + 1);
        match word.as_str() {
            "PROG" => {
                let name = words.next().unwrap_or_default().to_owned();
                if name.is_empty() {
                    self.diagnostics.push(Diagnostic::error(
                        "TP0102",
                        span,
                        "/PROG needs the name of the program",
                    ));
                }
                let offset = line.find(&name).filter(|_| !name.is_empty());
                let name_span = match offset {
                    Some(offset) => self.span(start + offset, name.len()),
                    None => span,
                };
                self.listings.push(Listing {
                    name: Name {
                        text: name,
                        span: name_span,
                    },
                    comment: String::new(),
                    lines: Vec::new(),
                    positions: Vec::new(),
                    file_line,
                });
                self.section = Section::Heading;
            }
            "ATTR" | "APPL" | "TCD" | "LOC" if self.section != Section::Outside => {
                self.section = Section::Heading;
            }
            "MN" if self.section != Section::Outside => self.section = Section::Lines,
            "POS" if self.section != Section::Outside => {
                self.section = Section::Positions;
                self.positions_from = start + line.len();
            }
            "END" if self.section != Section::Outside => self.section = Section::Outside,
            "MN" | "POS" | "ATTR" | "APPL" | "END" => {
                if !self.complained_outside {
                    self.complained_outside = true;
                    self.diagnostics.push(missing_prog(span));
                }
            }
            _ => {
                // What belongs to it is not read.
                if self.section != Section::Outside {
                    self.section = Section::Heading;
                }
                self.diagnostics.push(
                    Diagnostic::error("TP0103", span, format!("there is no section /{word}"))
                        .help("sections are /PROG, /ATTR, /APPL, /MN, /POS and /END"),
                );
            }
        }
    }

    fn attribute(&mut self, line: &str) {
        let Some((name, value)) = line.split_once('=') else {
            return;
        };
        if matches!(name.trim().to_uppercase().as_str(), "COMMENT" | "KOMMENTAR")
            && let Some(listing) = self.listings.last_mut()
        {
            let value = value.trim().trim_end_matches(';').trim();
            value.trim_matches('"').clone_into(&mut listing.comment);
        }
    }

    fn instruction_line(&mut self, start: usize, line: &str) {
        let body = line.trim_start();
        if body.is_empty() {
            return;
        }
        let body_start = start + (line.len() - body.len());
        let digits = body.bytes().take_while(u8::is_ascii_digit).count();
        let after = body[digits..].trim_start();
        let colon_at = body.len() - after.len();
        let has_colon = after.starts_with(':');
        let continues =
            has_colon && digits == 0 && self.pending.as_ref().is_some_and(|p| !p.is_ended);
        if continues {
            self.add(body_start + colon_at + 1, start + line.len());
            return;
        }
        // A colon without a number begins a line, too, where none is open: listings of other tools.
        self.flush();
        let last = self.listings.last().and_then(|l| l.lines.last());
        let following = last.map_or(1, |line| line.number.saturating_add(1));
        let (number, begin) = if has_colon {
            // Without digits this is no number either.
            let number = body[..digits].parse().unwrap_or(following);
            (number, body_start + colon_at + 1)
        } else {
            (following, body_start)
        };
        let number = number.max(1);
        let end = start + line.len();
        let content = self.text[begin..end].trim();
        if content.starts_with('!') || content.starts_with("//") || content.starts_with("--eg") {
            let comment = content.trim_end_matches(';').trim_end();
            let skip = match content.as_bytes().first() {
                Some(b'!') => 1,
                Some(b'/') => 2,
                _ => 4,
            };
            let comment = comment[skip.min(comment.len())..].trim_end().to_owned();
            self.push(
                number,
                self.span(begin, end - begin),
                Statement::Comment(comment),
            );
            return;
        }
        if content.starts_with("---") {
            // The end of a block of lines that belongs to a move.
            let span = self.span(begin, end - begin);
            self.push(number, span, Statement::Nothing("------".into()));
            return;
        }
        self.pending = Some(Pending {
            number,
            tokens: Vec::new(),
            span: self.trimmed_span(begin, end),
            is_ended: false,
        });
        self.add(begin, end);
    }

    fn trimmed_span(&self, begin: usize, end: usize) -> Span {
        let text = &self.text[begin..end];
        let lead = text.len() - text.trim_start().len();
        self.span(begin + lead, text.trim().len())
    }

    fn add(&mut self, begin: usize, end: usize) {
        let mut found = tokens(self.file, self.text, begin, end, self.diagnostics);
        let is_end = |token: &Token| token.kind == Kind::Symbol(";");
        let ended = found.last().is_some_and(is_end);
        while found.last().is_some_and(is_end) {
            found.pop();
        }
        let span = self.trimmed_span(begin, end);
        if let Some(pending) = &mut self.pending {
            pending.span = pending.span.to(span);
            pending.tokens.extend(found);
            pending.is_ended |= ended;
        }
        if ended {
            self.flush();
        }
    }

    /// Reads the instruction that has come together.
    fn flush(&mut self) {
        let Some(pending) = self.pending.take() else {
            return;
        };
        // A quote that is open has eaten the end.
        let is_eaten = |d: &Diagnostic| {
            d.code == "TP0002"
                && d.primary.span.start >= pending.span.start
                && d.primary.span.end <= pending.span.end
        };
        if !pending.is_ended && !self.diagnostics.iter().any(is_eaten) {
            self.diagnostics.push(
                Diagnostic::error("TP0101", pending.span, "the line has no ; at its end").help(
                    "a line that goes on in the next one has no ; and the next one begins with :",
                ),
            );
        }
        let end = Span::new(
            self.file,
            pending.span.end.saturating_sub(1),
            pending.span.end,
        );
        let mut cursor = Cursor::new(&pending.tokens, end, self.diagnostics);
        if let Ok(statement) = cursor.statement() {
            self.push(pending.number, pending.span, statement);
        }
    }

    fn push(&mut self, number: u32, span: Span, statement: Statement) {
        if let Some(listing) = self.listings.last_mut() {
            listing.lines.push(Line {
                number,
                span,
                statement,
            });
        }
    }

    /// The end of a section.
    fn close(&mut self, at: usize) {
        self.flush();
        if self.section == Section::Positions {
            let from = self.positions_from.min(at);
            let found = tokens(self.file, self.text, from, at, self.diagnostics);
            let end = Span::new(self.file, at.saturating_sub(1) as u32, at as u32);
            let taught = positions(&found, end, self.diagnostics);
            if let Some(listing) = self.listings.last_mut() {
                for position in taught {
                    if let Some(first) = listing
                        .positions
                        .iter()
                        .find(|p| p.number == position.number)
                    {
                        self.diagnostics.push(
                            Diagnostic::error(
                                "TP0105",
                                position.span,
                                format!("P[{}] is there twice", position.number),
                            )
                            .secondary(first.span, "the first"),
                        );
                    } else {
                        listing.positions.push(position);
                    }
                }
            }
        }
    }

    fn finish(&mut self, end: usize) {
        self.close(end);
        if self.section != Section::Outside
            && let Some(listing) = self.listings.last()
        {
            let span = Span::new(self.file, end.saturating_sub(1) as u32, end as u32);
            self.diagnostics.push(
                Diagnostic::error(
                    "TP0106",
                    span,
                    format!("program {} has no /END", listing.name.text),
                )
                .secondary(listing.name.span, "begins here"),
            );
        }
    }
}

fn is_section(rest: &str) -> bool {
    let word = rest.split_whitespace().next().unwrap_or_default();
    matches!(
        word.to_uppercase().as_str(),
        "PROG" | "ATTR" | "APPL" | "MN" | "POS" | "END"
    )
}
