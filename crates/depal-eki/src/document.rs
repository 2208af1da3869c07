use quick_xml::Reader;
use quick_xml::events::{BytesDecl, BytesRef, BytesStart, Event};

use crate::value::shortened;
use crate::{DocumentSplitter, EkiError, Limits};

/// An element of a document.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Node {
    /// Its name.
    pub name: String,
    /// Line of its start tag, from 1.
    pub line: u32,
    /// Attributes in their order, with entities resolved.
    pub attributes: Vec<(String, String)>,
    /// Its own text, pieces joined, without that of its children.
    pub text: String,
    /// Elements inside, in their order.
    pub children: Vec<Node>,
}

impl Node {
    /// The value of an attribute.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes
            .iter()
            .find(|(key, _)| key == name)
            .map(|(_, value)| value.as_str())
    }

    /// The first child of this name.
    pub fn child(&self, name: &str) -> Option<&Node> {
        self.children.iter().find(|child| child.name == name)
    }
}

/// A whole XML document within [`Limits`]: UTF-8, one root, no DOCTYPE, no entities but the five of XML.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Document {
    /// The root element.
    pub root: Node,
}

impl Document {
    /// Reads the bytes of one document. Blanks and comments may follow it, no second one.
    ///
    /// # Errors
    /// [`EkiError::Malformed`] with the line, or [`EkiError::TooManyBytes`].
    pub fn parse(bytes: &[u8], limits: Limits) -> Result<Self, EkiError> {
        let mut splitter = DocumentSplitter::new(limits);
        let mut whole = None;
        let blanks = bytes.iter().take_while(|byte| byte.is_ascii_whitespace());
        let first_line = 1 + blanks.filter(|byte| **byte == b'\n').count() as u32;
        let mut line = 1;
        for byte in bytes {
            match splitter.push(*byte) {
                Ok(None) => {}
                Ok(Some(_)) if whole.is_some() => {
                    return malformed(line, "a second root element");
                }
                Ok(Some(document)) => {
                    whole = Some(Self::parse_cut(&document, limits, first_line)?);
                }
                Err(EkiError::Malformed { message, .. }) => return malformed(line, message),
                Err(error) => return Err(error),
            }
            line += u32::from(*byte == b'\n');
        }
        match whole {
            Some(document) if splitter.is_between() => Ok(document),
            Some(_) => malformed(line, "an unfinished second element"),
            None if bytes.iter().all(u8::is_ascii_whitespace) => malformed(line, "no element"),
            None => malformed(line, "the root element is not closed"),
        }
    }

    /// Reads what a splitter with the same limits has cut out.
    pub(crate) fn parse_cut(
        bytes: &[u8],
        limits: Limits,
        first_line: u32,
    ) -> Result<Self, EkiError> {
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text.trim_start_matches('\u{feff}'),
            Err(error) => {
                let before = &bytes[..error.valid_up_to()];
                return malformed(
                    first_line + newlines(before),
                    "bytes that are not UTF-8: other encodings are not read",
                );
            }
        };
        Builder {
            limits,
            stack: Vec::new(),
            root: None,
            line: first_line,
        }
        .run(text)
    }
}

struct Builder {
    limits: Limits,
    stack: Vec<Node>,
    root: Option<Node>,
    line: u32,
}

impl Builder {
    fn run(mut self, text: &str) -> Result<Document, EkiError> {
        let mut reader = Reader::from_str(text);
        let config = reader.config_mut();
        config.check_end_names = true;
        config.check_comments = false;
        config.expand_empty_elements = false;
        let mut counted = 0;
        loop {
            let event = reader.read_event();
            let position = (reader.buffer_position() as usize).min(text.len());
            let lines = newlines(&text.as_bytes()[counted..position.max(counted)]);
            counted = position.max(counted);
            match event {
                Err(error) => return malformed(self.line, error.to_string()),
                Ok(Event::Eof) => break,
                Ok(event) => self.event(event)?,
            }
            self.line += lines;
        }
        if !self.stack.is_empty() {
            return malformed(self.line, "an element is not closed");
        }
        match self.root {
            Some(root) => Ok(Document { root }),
            None => malformed(self.line, "no element"),
        }
    }

    fn event(&mut self, event: Event<'_>) -> Result<(), EkiError> {
        match event {
            Event::Start(tag) => {
                let node = self.node(&tag)?;
                if self.stack.len() >= self.limits.depth {
                    return malformed(self.line, "elements too deep inside one another");
                }
                self.stack.push(node);
            }
            Event::Empty(tag) => {
                let node = self.node(&tag)?;
                self.close(node)?;
            }
            Event::End(_) => {
                let Some(node) = self.stack.pop() else {
                    return malformed(self.line, "an end tag without its start");
                };
                self.close(node)?;
            }
            Event::Text(text) => {
                let text = text.decode().map_err(|e| self.error(e))?;
                self.add_text(&text)?;
            }
            Event::CData(text) => {
                let text = text.decode().map_err(|e| self.error(e))?;
                self.add_text(&text)?;
            }
            Event::GeneralRef(reference) => {
                let text = self.resolve(&reference)?;
                self.add_text(&text)?;
            }
            Event::Decl(declaration) => self.declaration(&declaration)?,
            Event::DocType(_) => return malformed(self.line, "DOCTYPE is refused"),
            Event::Comment(_) | Event::PI(_) | Event::Eof => {}
        }
        Ok(())
    }

    fn error(&self, error: impl std::fmt::Display) -> EkiError {
        EkiError::Malformed {
            line: self.line,
            message: error.to_string(),
        }
    }

    fn node(&self, tag: &BytesStart<'_>) -> Result<Node, EkiError> {
        let mut attributes = Vec::new();
        for attribute in tag.attributes() {
            let attribute = attribute.map_err(|e| self.error(e))?;
            if attributes.len() >= self.limits.attributes {
                return malformed(self.line, "too many attributes in a tag");
            }
            let value = attribute.unescape_value().map_err(|e| self.error(e))?;
            attributes.push((
                String::from_utf8_lossy(attribute.key.as_ref()).into_owned(),
                value.into_owned(),
            ));
        }
        Ok(Node {
            name: String::from_utf8_lossy(tag.name().as_ref()).into_owned(),
            line: self.line,
            attributes,
            ..Node::default()
        })
    }

    fn close(&mut self, node: Node) -> Result<(), EkiError> {
        if let Some(parent) = self.stack.last_mut() {
            parent.children.push(node);
        } else if self.root.is_none() {
            self.root = Some(node);
        } else {
            return malformed(self.line, "a second root element");
        }
        Ok(())
    }

    fn add_text(&mut self, text: &str) -> Result<(), EkiError> {
        match self.stack.last_mut() {
            Some(node) => node.text.push_str(text),
            None if text.trim().is_empty() => {}
            None => return malformed(self.line, "text outside of the root element"),
        }
        Ok(())
    }

    fn resolve(&self, reference: &BytesRef<'_>) -> Result<String, EkiError> {
        if let Some(character) = reference.resolve_char_ref().map_err(|e| self.error(e))? {
            if character == '\0' {
                return malformed(self.line, "a reference to the zero character");
            }
            return Ok(character.to_string());
        }
        let name = reference.decode().map_err(|e| self.error(e))?;
        let text = match name.as_ref() {
            "lt" => "<",
            "gt" => ">",
            "amp" => "&",
            "apos" => "'",
            "quot" => "\"",
            other => {
                return malformed(self.line, format!("unknown entity &{};", shortened(other)));
            }
        };
        Ok(text.to_owned())
    }

    fn declaration(&self, declaration: &BytesDecl<'_>) -> Result<(), EkiError> {
        let Some(encoding) = declaration.encoding() else {
            return Ok(());
        };
        let encoding = encoding.map_err(|e| self.error(e))?;
        let name = String::from_utf8_lossy(&encoding);
        if ["utf-8", "utf8", "us-ascii", "ascii"]
            .iter()
            .any(|known| name.eq_ignore_ascii_case(known))
        {
            return Ok(());
        }
        malformed(
            self.line,
            format!("encoding {} is not read: only UTF-8", shortened(&name)),
        )
    }
}

fn newlines(bytes: &[u8]) -> u32 {
    bytes.iter().map(|byte| u32::from(*byte == b'\n')).sum()
}

fn malformed<T>(line: u32, message: impl Into<String>) -> Result<T, EkiError> {
    Err(EkiError::Malformed {
        line,
        message: message.into(),
    })
}
