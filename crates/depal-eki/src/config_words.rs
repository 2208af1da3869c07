//! Words and numbers of a configuration file, each with its complaint.

use crate::config_reader::{ConfigDiagnostic, ConfigSeverity};
use crate::value::shortened;
use crate::{BufferMode, Node, SignalKind, SignalTarget};

/// Collects what is to be said about a file.
#[derive(Debug, Default)]
pub(crate) struct Complaints {
    pub(crate) list: Vec<ConfigDiagnostic>,
}

impl Complaints {
    pub(crate) fn error(&mut self, line: u32, key: impl Into<String>, message: impl Into<String>) {
        self.add(ConfigSeverity::Error, line, key.into(), message.into());
    }

    pub(crate) fn warning(
        &mut self,
        line: u32,
        key: impl Into<String>,
        message: impl Into<String>,
    ) {
        self.add(ConfigSeverity::Warning, line, key.into(), message.into());
    }

    fn add(&mut self, severity: ConfigSeverity, line: u32, key: String, message: String) {
        self.list.push(ConfigDiagnostic {
            severity,
            line,
            key,
            message,
        });
    }

    /// Complains about children and attributes that are not known here.
    pub(crate) fn unknown(
        &mut self,
        node: &Node,
        path: &str,
        children: &[&str],
        attributes: &[&str],
    ) {
        for child in &node.children {
            if !children.contains(&child.name.as_str()) {
                let message = not_known("element", &child.name, children);
                self.warning(child.line, format!("{path}/{}", child.name), message);
            }
        }
        for (name, _) in &node.attributes {
            if !attributes.contains(&name.as_str()) {
                let message = not_known("attribute", name, attributes);
                self.warning(node.line, format!("{path}/@{name}"), message);
            }
        }
    }

    /// A whole number of an element's text within bounds.
    pub(crate) fn number(
        &mut self,
        line: u32,
        key: &str,
        text: &str,
        least: u32,
        most: u32,
    ) -> Option<u32> {
        let word = text.trim();
        match word.parse::<u32>() {
            Ok(number) if (least..=most).contains(&number) => Some(number),
            _ => {
                self.error(
                    line,
                    key,
                    format!(
                        "expected a whole number from {least} to {most}, found \"{}\"",
                        shortened(word)
                    ),
                );
                None
            }
        }
    }

    /// One of a few words.
    pub(crate) fn word<T: Copy>(
        &mut self,
        line: u32,
        key: &str,
        text: &str,
        words: &[(&str, T)],
    ) -> Option<T> {
        let word = text.trim();
        let found = words.iter().find(|(name, _)| *name == word);
        if found.is_none() {
            let known: Vec<_> = words.iter().map(|(name, _)| *name).collect();
            self.error(
                line,
                key,
                format!(
                    "expected {}, found \"{}\"",
                    known.join(" or "),
                    shortened(word)
                ),
            );
        }
        found.map(|(_, value)| *value)
    }

    /// `Set_Flag` and `Set_Out` of an element.
    pub(crate) fn signals(&mut self, node: &Node, path: &str) -> Vec<SignalTarget> {
        let mut signals = Vec::new();
        for (name, kind, most) in [
            ("Set_Flag", SignalKind::Flag, 1024),
            ("Set_Out", SignalKind::Output, 8192),
        ] {
            if let Some(text) = node.attribute(name) {
                let key = format!("{path}/@{name}");
                if let Some(number) = self.number(node.line, &key, text, 1, most) {
                    signals.push(SignalTarget { kind, number });
                }
            }
        }
        signals
    }

    /// The attribute `Mode`, or the mode of the file.
    pub(crate) fn mode(&mut self, node: &Node, path: &str, otherwise: BufferMode) -> BufferMode {
        let words = [("FIFO", BufferMode::Fifo), ("LIFO", BufferMode::Lifo)];
        node.attribute("Mode")
            .and_then(|text| self.word(node.line, &format!("{path}/@Mode"), text, &words))
            .unwrap_or(otherwise)
    }

    /// The attribute `Tag`: names with `/` between, the last one may be an attribute.
    pub(crate) fn tag(&mut self, node: &Node, path: &str, xml: bool) -> Option<String> {
        let key = format!("{path}/@Tag");
        let Some(tag) = node.attribute("Tag").map(str::trim) else {
            self.error(node.line, key, "missing: every element has a path");
            return None;
        };
        if !xml {
            if tag.is_empty() {
                self.error(node.line, key, "empty");
                return None;
            }
            return Some(tag.to_owned());
        }
        let parts: Vec<_> = tag.split('/').collect();
        let last = parts.len() - 1;
        let good = parts.iter().enumerate().all(|(index, part)| {
            let name = match part.strip_prefix('@') {
                Some(name) if index == last && index > 0 => name,
                Some(_) => "",
                None => part,
            };
            is_name(name)
        });
        if !good {
            self.error(
                node.line,
                key,
                format!(
                    "expected a path such as Root/Part/Name or Root/Part/@Attribute, found \"{}\"",
                    shortened(tag)
                ),
            );
            return None;
        }
        Some(tag.to_owned())
    }
}

/// Whether a word can be the name of an element: a letter, then letters, digits, `_`, `-`, `.`.
fn is_name(word: &str) -> bool {
    let mut letters = word.chars();
    letters
        .next()
        .is_some_and(|first| first.is_alphabetic() || first == '_')
        && letters.all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | ':'))
}

fn not_known(what: &str, name: &str, known: &[&str]) -> String {
    let near = known.iter().find(|word| word.eq_ignore_ascii_case(name));
    match near {
        Some(near) => format!("unknown {what}, ignored: names are case-sensitive, {near} is meant"),
        None if known.is_empty() => format!("unknown {what}, ignored: there is none here"),
        None => format!("unknown {what}, ignored; known here: {}", known.join(", ")),
    }
}
