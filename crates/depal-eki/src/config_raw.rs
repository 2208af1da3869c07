//! The RAW sections of a configuration file.

use crate::config_words::Complaints;
use crate::{ChannelConfig, Node, RawElement};

/// The one element of a RAW section.
pub(crate) fn raw(
    node: &Node,
    path: &str,
    config: &ChannelConfig,
    says: &mut Complaints,
) -> Option<RawElement> {
    let mut elements = node.children.iter().filter(|c| c.name == "ELEMENT");
    let element = elements.next()?;
    if let Some(second) = elements.next() {
        says.error(second.line, path, "only one element in a RAW section");
    }
    let known = ["Tag", "Type", "Size", "EOS", "Set_Flag", "Set_Out", "Mode"];
    says.unknown(element, path, &[], &known);
    let tag = says.tag(element, path, false)?;
    let words = [("BYTE", false), ("STREAM", true)];
    let Some(kind) = element.attribute("Type") else {
        says.error(
            element.line,
            format!("{path}/@Type"),
            "missing: BYTE or STREAM",
        );
        return None;
    };
    let stream = says.word(element.line, &format!("{path}/@Type"), kind, &words)?;
    let largest = config.buffer_bytes as u32;
    let mut size = None;
    let mut end = Vec::new();
    if stream {
        end = end_string(element, path, says)?;
    } else if let Some(text) = element.attribute("Size") {
        let key = format!("{path}/@Size");
        size = says
            .number(element.line, &key, text, 1, largest)
            .map(|n| n as usize);
    } else if node_receives(path) {
        says.error(
            element.line,
            format!("{path}/@Size"),
            "missing: bytes of a record of Type BYTE",
        );
    }
    Some(RawElement {
        tag,
        size,
        end,
        signals: says.signals(element, path),
        mode: says.mode(element, path, config.buffering.mode),
    })
}

/// What is sent may have any length.
fn node_receives(path: &str) -> bool {
    path.starts_with("RECEIVE")
}

/// `EOS="13,10"`: decimal numbers of bytes.
fn end_string(element: &Node, path: &str, says: &mut Complaints) -> Option<Vec<u8>> {
    let key = format!("{path}/@EOS");
    let Some(text) = element.attribute("EOS") else {
        says.error(
            element.line,
            key,
            "missing: the bytes that end a record of Type STREAM, such as \"13,10\"",
        );
        return None;
    };
    let bytes: Result<Vec<u8>, _> = text.split(',').map(|word| word.trim().parse()).collect();
    match bytes {
        Ok(bytes) if bytes.len() <= 32 => Some(bytes),
        _ => {
            says.error(
                element.line,
                key,
                format!("expected at most 32 decimal bytes such as \"13,10\", found \"{text}\""),
            );
            None
        }
    }
}
