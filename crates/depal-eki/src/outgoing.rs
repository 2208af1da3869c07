//! From values to bytes: documents and raw records.

use quick_xml::escape::escape;

use crate::value::{FRAME_FIELDS, decimal};
use crate::{EkiError, ElementValue, RawElement, SendElement};

/// What a node of the tree to be sent is made of.
#[derive(Debug, Default)]
struct Branch<'a> {
    name: &'a str,
    attributes: Vec<(&'a str, String)>,
    text: String,
    children: Vec<Branch<'a>>,
}

/// The document of all elements at or below `path`, with their ancestors. Elements without a value are empty.
/// Nothing if there is no such element.
pub(crate) fn document(
    elements: &[SendElement],
    values: &[Option<ElementValue>],
    path: &str,
) -> Option<Vec<u8>> {
    let mut roots: Vec<Branch<'_>> = Vec::new();
    for (element, value) in elements.iter().zip(values) {
        let below = element
            .tag
            .strip_prefix(path)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('/'));
        if !below {
            continue;
        }
        let mut parts = element.tag.split('/').peekable();
        let mut level = &mut roots;
        while let Some(part) = parts.next() {
            let known = level.iter().position(|branch| branch.name == part);
            let index = known.unwrap_or(level.len());
            if known.is_none() {
                level.push(Branch {
                    name: part,
                    ..Branch::default()
                });
            }
            let branch = &mut level[index];
            match parts.peek() {
                None => branch.fill(value.as_ref()),
                Some(next) if next.starts_with('@') => {
                    let text = value.as_ref().map_or(String::new(), ElementValue::text);
                    branch.attributes.push((&next[1..], text));
                    break;
                }
                Some(_) => {}
            }
            level = &mut level[index].children;
        }
    }
    let mut text = String::new();
    for root in &roots {
        root.write(&mut text);
    }
    (!roots.is_empty()).then(|| text.into_bytes())
}

impl Branch<'_> {
    fn fill(&mut self, value: Option<&ElementValue>) {
        match value {
            Some(ElementValue::Frame(frame)) => {
                let fields = FRAME_FIELDS.iter().zip(frame);
                self.attributes
                    .extend(fields.map(|(name, number)| (*name, decimal(*number))));
            }
            Some(value) => self.text = value.text(),
            None => {}
        }
    }

    fn write(&self, out: &mut String) {
        out.push('<');
        out.push_str(self.name);
        for (name, value) in &self.attributes {
            out.push(' ');
            out.push_str(name);
            out.push_str("=\"");
            out.push_str(&escape(value.as_str()));
            out.push('"');
        }
        if self.text.is_empty() && self.children.is_empty() {
            out.push_str("/>");
            return;
        }
        out.push('>');
        out.push_str(&escape(self.text.as_str()));
        for child in &self.children {
            child.write(out);
        }
        out.push_str("</");
        out.push_str(self.name);
        out.push('>');
    }
}

/// A raw record: of fixed length filled up with zeros, of variable length up to the first zero byte, with its end
/// string; else as it is.
pub(crate) fn record(element: &RawElement, bytes: &[u8]) -> Result<Vec<u8>, EkiError> {
    let mut record = bytes.to_vec();
    if let Some(size) = element.size {
        if record.len() > size {
            return Err(EkiError::Write {
                tag: element.tag.clone(),
                message: format!("{} bytes, a record has {size}", record.len()),
            });
        }
        record.resize(size, 0);
    } else if !element.end.is_empty() {
        let length = record.iter().position(|byte| *byte == 0);
        record.truncate(length.unwrap_or(record.len()));
        record.extend_from_slice(&element.end);
    }
    Ok(record)
}
