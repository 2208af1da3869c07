//! From bytes to records: the framing of the three formats.

use crate::value::{FRAME_FIELDS, parse_real, shortened};
use crate::{
    ChannelConfig, Document, DocumentSplitter, EkiError, ElementType, ElementValue, Limits, Node,
    RawElement, ReceiveFormat, XmlElement,
};

/// What one record or document holds for the memories: index of the element, value.
pub(crate) type Record = Vec<(usize, ElementValue)>;

/// The framing of a connection.
#[derive(Debug, Clone)]
pub(crate) enum Framing {
    Nothing,
    Raw {
        element: RawElement,
        limit: usize,
        bytes: Vec<u8>,
    },
    Xml {
        elements: Vec<XmlElement>,
        limits: Limits,
        splitter: DocumentSplitter,
    },
}

/// A whole record, and which elements it touched.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Arrived {
    pub(crate) values: Record,
    /// Indexes of the configured elements that were there, for their signals.
    pub(crate) present: Vec<usize>,
}

impl Framing {
    pub(crate) fn new(config: &ChannelConfig) -> Self {
        match &config.receive {
            ReceiveFormat::Nothing => Self::Nothing,
            ReceiveFormat::Raw(element) => Self::Raw {
                element: element.clone(),
                limit: config.buffer_bytes,
                bytes: Vec::new(),
            },
            ReceiveFormat::Xml(elements) => Self::Xml {
                elements: elements.clone(),
                limits: config.limits(),
                splitter: DocumentSplitter::new(config.limits()),
            },
        }
    }

    /// Bytes of the record that has begun.
    pub(crate) fn pending(&self) -> usize {
        match self {
            Self::Nothing => 0,
            Self::Raw { bytes, .. } => bytes.len(),
            Self::Xml { splitter, .. } => splitter.pending(),
        }
    }

    /// Takes a byte; gives the record that it completes. A record that does not fit the configuration is an inner
    /// error; after an outer one nothing sensible can follow.
    pub(crate) fn push(&mut self, byte: u8) -> Result<Option<Result<Arrived, EkiError>>, EkiError> {
        match self {
            Self::Nothing => Ok(None),
            Self::Raw {
                element,
                limit,
                bytes,
            } => {
                bytes.push(byte);
                let end = element.end.len();
                let complete = match element.size {
                    Some(size) => bytes.len() >= size,
                    None => end > 0 && bytes.ends_with(&element.end),
                };
                if !complete {
                    if bytes.len() > *limit {
                        return Err(EkiError::TooManyBytes { limit: *limit });
                    }
                    return Ok(None);
                }
                let mut record = std::mem::take(bytes);
                record.truncate(record.len() - end);
                Ok(Some(Ok(Arrived {
                    values: vec![(0, ElementValue::Bytes(record))],
                    present: vec![0],
                })))
            }
            Self::Xml {
                elements,
                limits,
                splitter,
            } => match splitter.push(byte)? {
                Some(bytes) => {
                    let document = Document::parse_cut(&bytes, *limits, 1)?;
                    Ok(Some(interpret(&document, elements)))
                }
                None => Ok(None),
            },
        }
    }
}

/// The values of a document, in the order of the configuration.
fn interpret(document: &Document, elements: &[XmlElement]) -> Result<Arrived, EkiError> {
    let root = &document.root;
    let fits = |tag: &str| tag.split('/').next() == Some(root.name.as_str());
    if !elements.iter().any(|element| fits(&element.tag)) {
        return Err(EkiError::Unfit {
            tag: shortened(&root.name),
            message: "unknown root element".to_owned(),
        });
    }
    let mut arrived = Arrived::default();
    for (index, element) in elements.iter().enumerate() {
        if !fits(&element.tag) {
            continue;
        }
        let mut parts: Vec<&str> = element.tag.split('/').skip(1).collect();
        let attribute = parts.last().and_then(|last| last.strip_prefix('@'));
        if attribute.is_some() {
            parts.pop();
        }
        let nodes = find(root, &parts);
        let before = arrived.values.len();
        let mut present = false;
        for node in nodes {
            let text = match attribute {
                Some(name) => match node.attribute(name) {
                    Some(text) => text,
                    None => continue,
                },
                None => &node.text,
            };
            present = true;
            if let Some(kind) = element.kind {
                let value = match kind {
                    ElementType::Frame if attribute.is_none() => frame(node),
                    kind => ElementValue::parse(kind, text),
                };
                let value = value.map_err(|message| EkiError::Unfit {
                    tag: element.tag.clone(),
                    message,
                })?;
                arrived.values.push((index, value));
            }
        }
        if present || arrived.values.len() > before {
            arrived.present.push(index);
        }
    }
    Ok(arrived)
}

/// All elements at a path below a node, in the order of the document.
fn find<'a>(node: &'a Node, path: &[&str]) -> Vec<&'a Node> {
    let mut found = vec![node];
    for part in path {
        found = found
            .into_iter()
            .flat_map(|node| node.children.iter())
            .filter(|child| child.name == *part)
            .collect();
    }
    found
}

fn frame(node: &Node) -> Result<ElementValue, String> {
    let mut values = [0.0; 6];
    for (value, name) in values.iter_mut().zip(FRAME_FIELDS) {
        let text = node
            .attribute(name)
            .ok_or_else(|| format!("missing attribute {name} of a frame"))?;
        *value = parse_real(text.trim()).ok_or_else(|| {
            format!(
                "attribute {name}: expected a finite number, found \"{}\"",
                shortened(text)
            )
        })?;
    }
    Ok(ElementValue::Frame(values))
}
