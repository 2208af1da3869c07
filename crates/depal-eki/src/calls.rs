//! What a program does with a channel: values and documents by path.

use crate::memory::{ElementMemory, Taken};
use crate::value::FRAME_FIELDS;
use crate::{
    Channel, EkiError, ElementType, ElementValue, ReceiveFormat, SendFormat, Status, outgoing,
};

impl Channel {
    /// Takes the next value of an element (`EKI_GetReal` and its like).
    pub fn get(&mut self, tag: &str, kind: ElementType) -> (Option<ElementValue>, Status) {
        let (values, status) = self.get_many(tag, kind, 1);
        (values.into_iter().next(), status)
    }

    /// Takes the next values of an element, at most so many (`EKI_GetRealArray` and its like). Raw records are asked
    /// for as [`ElementType::String`].
    pub fn get_many(
        &mut self,
        tag: &str,
        kind: ElementType,
        most: usize,
    ) -> (Vec<ElementValue>, Status) {
        match self.take(tag, kind, most) {
            Ok((taken, left)) => {
                let mut status = self.done(left, taken.values.len());
                status.counter = i32::try_from(taken.counter).unwrap_or(i32::MAX);
                let milliseconds = taken.at.as_nanos() / 1_000_000;
                status.timestamp_ms = i32::try_from(milliseconds).unwrap_or(i32::MAX);
                (taken.values, status)
            }
            Err(error) => (Vec::new(), self.failed(error)),
        }
    }

    fn take(
        &mut self,
        tag: &str,
        kind: ElementType,
        most: usize,
    ) -> Result<(Taken, usize), EkiError> {
        self.tell_trouble()?;
        let index = self.received(tag)?;
        let found = match &self.config.receive {
            ReceiveFormat::Raw(raw) => raw.kind(),
            ReceiveFormat::Xml(elements) => elements[index].kind.unwrap_or(ElementType::String),
            ReceiveFormat::Nothing => ElementType::String,
        };
        let raw = !found.is_xml() && kind == ElementType::String;
        if found != kind && !raw {
            return Err(EkiError::WrongType {
                tag: tag.to_owned(),
                expected: kind,
                found,
            });
        }
        let Some(memory) = &mut self.memories[index] else {
            return Err(self.unknown(tag));
        };
        let taken = memory.take(most)?;
        Ok((taken, memory.len()))
    }

    /// The element of RECEIVE with a memory at this path.
    fn received(&self, tag: &str) -> Result<usize, EkiError> {
        self.memories
            .iter()
            .position(|memory| memory.as_ref().is_some_and(|memory| memory.tag == tag))
            .ok_or_else(|| self.unknown(tag))
    }

    fn unknown(&self, tag: &str) -> EkiError {
        let known: Vec<_> = self
            .memories
            .iter()
            .flatten()
            .map(|m| m.tag.as_str())
            .collect();
        EkiError::UnknownElement {
            tag: tag.to_owned(),
            section: "RECEIVE",
            known: listed(&known),
        }
    }

    /// How many values wait in the memory of an element; for a path above elements, the most of one of them
    /// (`EKI_CheckBuffer`).
    pub fn check_buffer(&mut self, tag: &str) -> Status {
        if let Err(error) = self.tell_trouble() {
            return self.failed(error);
        }
        let memories = self.memories.iter().flatten();
        match memories
            .filter(|m| is_below(&m.tag, tag))
            .map(ElementMemory::len)
            .max()
        {
            Some(waiting) => self.done(waiting, 0),
            None => self.failed(self.unknown(tag)),
        }
    }

    /// Empties the memories at or below a path, received and to be sent (`EKI_ClearBuffer`).
    pub fn clear_buffer(&mut self, tag: &str) -> Status {
        let mut found = false;
        for memory in self.memories.iter_mut().flatten() {
            if is_below(&memory.tag, tag) {
                memory.clear();
                found = true;
            }
        }
        if let SendFormat::Xml(elements) = &self.config.send {
            for (element, value) in elements.iter().zip(&mut self.values) {
                if is_below(&element.tag, tag) {
                    *value = None;
                    found = true;
                }
            }
        }
        if found {
            self.done(0, 0)
        } else {
            self.failed(self.unknown(tag))
        }
    }

    /// Writes the value of an element that is to be sent (`EKI_SetReal` and its like).
    pub fn set(&mut self, tag: &str, value: ElementValue) -> Status {
        let index = match &self.config.send {
            SendFormat::Xml(elements) => elements.iter().position(|e| e.tag == tag),
            SendFormat::Nothing | SendFormat::Raw(_) => None,
        };
        let Some(index) = index else {
            if let ElementValue::Frame(frame) = value
                && let Some(status) = self.set_parts(tag, &frame)
            {
                return status;
            }
            return self.failed(self.unknown_to_send(tag));
        };
        if let Some(message) = unsendable(tag, &value) {
            return self.failed(EkiError::Write {
                tag: tag.to_owned(),
                message,
            });
        }
        self.values[index] = Some(value);
        self.done(0, 0)
    }

    /// A frame for six attributes that are elements of their own, `Robot/Pos/@X` and so on.
    fn set_parts(&mut self, tag: &str, frame: &[f64; 6]) -> Option<Status> {
        let SendFormat::Xml(elements) = &self.config.send else {
            return None;
        };
        let mut places = [0; 6];
        for (place, name) in places.iter_mut().zip(FRAME_FIELDS) {
            let path = format!("{tag}/@{name}");
            *place = elements.iter().position(|e| e.tag == path)?;
        }
        if let Some(message) = unsendable(tag, &ElementValue::Frame(*frame)) {
            return Some(self.failed(EkiError::Write {
                tag: tag.to_owned(),
                message,
            }));
        }
        for (place, number) in places.into_iter().zip(frame) {
            self.values[place] = Some(ElementValue::Real(*number));
        }
        Some(self.done(0, 0))
    }

    fn unknown_to_send(&self, tag: &str) -> EkiError {
        let known: Vec<_> = match &self.config.send {
            SendFormat::Nothing => Vec::new(),
            SendFormat::Raw(raw) => vec![raw.tag.as_str()],
            SendFormat::Xml(elements) => elements.iter().map(|e| e.tag.as_str()).collect(),
        };
        EkiError::UnknownElement {
            tag: tag.to_owned(),
            section: "SEND",
            known: listed(&known),
        }
    }

    /// Sends one document with all elements at or below a path (`EKI_Send` with XML).
    pub fn send(&mut self, path: &str) -> Status {
        let document = match &self.config.send {
            SendFormat::Xml(elements) => outgoing::document(elements, &self.values, path),
            SendFormat::Nothing | SendFormat::Raw(_) => None,
        };
        match document {
            Some(bytes) => self.transmit(bytes),
            None => self.failed(self.unknown_to_send(path)),
        }
    }

    /// Sends a raw record (`EKI_Send` with bytes). Without any element to send, the bytes go out as they are.
    pub fn send_bytes(&mut self, bytes: &[u8]) -> Status {
        let record = match &self.config.send {
            SendFormat::Raw(element) => outgoing::record(element, bytes),
            SendFormat::Nothing if !matches!(self.config.receive, ReceiveFormat::Xml(_)) => {
                Ok(bytes.to_vec())
            }
            SendFormat::Nothing | SendFormat::Xml(_) => Err(EkiError::Write {
                tag: "(bytes)".to_owned(),
                message: "the SEND section of the configuration has no RAW element".to_owned(),
            }),
        };
        match record {
            Ok(bytes) => self.transmit(bytes),
            Err(error) => self.failed(error),
        }
    }

    fn transmit(&mut self, bytes: Vec<u8>) -> Status {
        if let Err(error) = self.tell_trouble() {
            return self.failed(error);
        }
        if !self.connected {
            return self.failed(EkiError::NotConnected);
        }
        self.outgoing.extend(bytes);
        self.done(0, 0)
    }

    /// What ended the connection, once.
    fn tell_trouble(&mut self) -> Result<(), EkiError> {
        self.trouble.take().map_or(Ok(()), Err)
    }

    pub(crate) fn done(&self, buff: usize, read: usize) -> Status {
        Status {
            buff: i32::try_from(buff).unwrap_or(i32::MAX),
            read: i32::try_from(read).unwrap_or(i32::MAX),
            connected: self.connected,
            ..Status::default()
        }
    }

    fn failed(&self, error: EkiError) -> Status {
        Status::failed(error, self.connected)
    }
}

/// Whether an element is at a path or below it.
fn is_below(tag: &str, path: &str) -> bool {
    tag.strip_prefix(path)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

fn listed(tags: &[&str]) -> String {
    if tags.is_empty() {
        "none".to_owned()
    } else {
        tags.join(", ")
    }
}

/// Why a value cannot stand in a document.
fn unsendable(tag: &str, value: &ElementValue) -> Option<String> {
    let is_attribute = tag
        .rsplit('/')
        .next()
        .is_some_and(|last| last.starts_with('@'));
    let finite = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
    match value {
        ElementValue::Frame(_) if is_attribute => Some("a frame in an attribute".to_owned()),
        ElementValue::Frame(frame) if !finite(frame) => Some("a number is not finite".to_owned()),
        ElementValue::Real(number) if !finite(&[*number]) => {
            Some("the number is not finite".to_owned())
        }
        ElementValue::String(text)
            if text
                .chars()
                .any(|c| c < ' ' && !matches!(c, '\t' | '\n' | '\r')) =>
        {
            Some("the text has control characters".to_owned())
        }
        ElementValue::Bytes(_) => Some("raw bytes in a document".to_owned()),
        _ => None,
    }
}
