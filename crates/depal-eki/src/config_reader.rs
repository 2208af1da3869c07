use std::fmt;

use thiserror::Error;

use crate::config::{
    ChannelConfig, Environment, Peer, ReadConfig, ReceiveFormat, SendElement, SendFormat,
    XmlElement,
};
use crate::config_raw::raw;
use crate::config_words::Complaints;
use crate::{BufferMode, Document, EkiError, ElementType, Limits, Node};

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ConfigSeverity {
    /// The channel cannot be used.
    Error,
    /// The channel can be used; probably not as meant.
    Warning,
}

/// Something to say about a configuration file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConfigDiagnostic {
    /// Error or warning.
    pub severity: ConfigSeverity,
    /// Line in the file, from 1.
    pub line: u32,
    /// The key, `CONFIGURATION/EXTERNAL/PORT` or `RECEIVE/RAW/ELEMENT/@Size`; empty for the file as XML.
    pub key: String,
    /// What is wrong, with what was expected and found.
    pub message: String,
}

impl fmt::Display for ConfigDiagnostic {
    /// `line 4: CONFIGURATION/EXTERNAL/PORT: message`; the file's name is the caller's.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: ", self.line)?;
        if !self.key.is_empty() {
            write!(f, "{}: ", self.key)?;
        }
        f.write_str(&self.message)
    }
}

/// A configuration file that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{}", .diagnostics.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
pub struct ConfigError {
    /// Errors and warnings, in the order of the file; at least one error.
    pub diagnostics: Vec<ConfigDiagnostic>,
}

/// The largest file that is read, bytes.
const LARGEST_FILE: usize = 1 << 20;

pub(crate) fn read(text: &str) -> Result<ReadConfig, ConfigError> {
    let limits = Limits {
        bytes: LARGEST_FILE,
        ..Limits::default()
    };
    let document = Document::parse(text.as_bytes(), limits).map_err(|error| {
        let (line, message) = match error {
            EkiError::Malformed { line, message } => (line, message),
            other => (1, other.to_string()),
        };
        ConfigError {
            diagnostics: vec![ConfigDiagnostic {
                severity: ConfigSeverity::Error,
                line,
                key: String::new(),
                message,
            }],
        }
    })?;
    let mut says = Complaints::default();
    let config = file(&document.root, &mut says);
    says.list.sort_by_key(|d| d.line);
    if says
        .list
        .iter()
        .any(|d| d.severity == ConfigSeverity::Error)
    {
        return Err(ConfigError {
            diagnostics: says.list,
        });
    }
    Ok(ReadConfig {
        config,
        warnings: says.list,
    })
}

fn file(root: &Node, says: &mut Complaints) -> ChannelConfig {
    let mut config = ChannelConfig::default();
    if root.name != "ETHERNETKRL" {
        says.error(
            root.line,
            &root.name,
            "expected ETHERNETKRL as the root element",
        );
        return config;
    }
    says.unknown(
        root,
        "ETHERNETKRL",
        &["CONFIGURATION", "RECEIVE", "SEND"],
        &[],
    );
    for section in &root.children {
        match section.name.as_str() {
            "CONFIGURATION" => configuration(section, &mut config, says),
            "RECEIVE" | "SEND" => {
                says.unknown(section, &section.name, &["RAW", "XML"], &[]);
            }
            _ => {}
        }
    }
    for section in &root.children {
        match section.name.as_str() {
            "RECEIVE" => config.receive = receive(section, &config, says),
            "SEND" => config.send = send(section, &config, says),
            _ => {}
        }
    }
    match config.peer {
        Peer::Server if config.external_ip.is_empty() => says.error(
            root.line,
            "CONFIGURATION/EXTERNAL/IP",
            "missing: the address of the server to connect to",
        ),
        Peer::Server if config.external_port == 0 => says.error(
            root.line,
            "CONFIGURATION/EXTERNAL/PORT",
            "missing: the port of the server to connect to",
        ),
        Peer::Client if config.internal_port == 0 => says.error(
            root.line,
            "CONFIGURATION/INTERNAL/PORT",
            "missing: the port to listen on, because EXTERNAL/TYPE is Client",
        ),
        _ => {}
    }
    config
}

fn configuration(node: &Node, config: &mut ChannelConfig, says: &mut Complaints) {
    says.unknown(node, "CONFIGURATION", &["EXTERNAL", "INTERNAL"], &[]);
    if let Some(external) = node.child("EXTERNAL") {
        let path = "CONFIGURATION/EXTERNAL";
        says.unknown(external, path, &["TYPE", "IP", "PORT"], &[]);
        for child in &external.children {
            let key = format!("{path}/{}", child.name);
            match child.name.as_str() {
                "TYPE" => {
                    let words = [("Server", Peer::Server), ("Client", Peer::Client)];
                    if let Some(peer) = says.word(child.line, &key, &child.text, &words) {
                        config.peer = peer;
                    }
                }
                "IP" => config.external_ip = address(child, &key, says),
                "PORT" => config.external_port = port(child, &key, says),
                _ => {}
            }
        }
    }
    if let Some(internal) = node.child("INTERNAL") {
        internal_section(internal, config, says);
    }
}

fn internal_section(internal: &Node, config: &mut ChannelConfig, says: &mut Complaints) {
    let path = "CONFIGURATION/INTERNAL";
    let known = [
        "ENVIRONMENT",
        "BUFFERING",
        "BUFFSIZE",
        "TIMEOUT",
        "ALIVE",
        "IP",
        "PORT",
        "PROTOCOL",
        "MESSAGES",
    ];
    says.unknown(internal, path, &known, &[]);
    for child in &internal.children {
        let key = format!("{path}/{}", child.name);
        let line = child.line;
        let limit = |name: &str, least, most, says: &mut Complaints| {
            let text = child.attribute(name)?;
            says.number(line, &format!("{key}/@{name}"), text, least, most)
        };
        match child.name.as_str() {
            "ENVIRONMENT" => {
                let words = [
                    ("Program", Environment::Program),
                    ("Submit", Environment::Submit),
                    ("System", Environment::System),
                ];
                if let Some(found) = says.word(line, &key, &child.text, &words) {
                    config.environment = found;
                }
            }
            "BUFFERING" => {
                if let Some(found) = limit("Limit", 1, 512, says) {
                    config.buffering.limit = found as usize;
                }
                config.buffering.mode = says.mode(child, &key, BufferMode::Fifo);
                says.unknown(child, &key, &[], &["Mode", "Limit"]);
            }
            "BUFFSIZE" => {
                if let Some(found) = limit("Limit", 1, 65_534, says) {
                    config.buffer_bytes = found as usize;
                }
                says.unknown(child, &key, &[], &["Limit"]);
            }
            "TIMEOUT" => {
                if let Some(found) = limit("Connect", 0, 65_534, says) {
                    config.connect_timeout_ms = found;
                }
                says.unknown(child, &key, &[], &["Connect"]);
            }
            "ALIVE" => {
                config.alive.ping_s = limit("Ping", 1, 65_534, says);
                config.alive.signals = says.signals(child, &key);
                says.unknown(child, &key, &[], &["Set_Flag", "Set_Out", "Ping"]);
            }
            "IP" => config.internal_ip = address(child, &key, says),
            "PORT" => config.internal_port = port(child, &key, says),
            "PROTOCOL" => {
                if let Some(true) =
                    says.word(line, &key, &child.text, &[("TCP", false), ("UDP", true)])
                {
                    says.error(line, &key, "UDP is not supported: only TCP");
                }
            }
            "MESSAGES" => {
                config.show_errors = child.attribute("Display") != Some("disabled");
                says.unknown(child, &key, &[], &["Logging", "Display"]);
            }
            _ => {}
        }
    }
}

fn address(node: &Node, key: &str, says: &mut Complaints) -> String {
    let text = node.text.trim();
    if text.is_empty() || text.contains(|c: char| c.is_whitespace() || c.is_control()) {
        says.error(node.line, key, "expected an address such as 192.168.1.10");
    }
    text.to_owned()
}

fn port(node: &Node, key: &str, says: &mut Complaints) -> u16 {
    says.number(node.line, key, &node.text, 1, 65_534)
        .map_or(0, |number| number as u16)
}

/// The one section of a direction that has elements.
fn section<'a>(node: &'a Node, says: &mut Complaints) -> Option<&'a Node> {
    let mut used = node.children.iter().filter(|child| {
        ["RAW", "XML"].contains(&child.name.as_str()) && !child.children.is_empty()
    });
    let first = used.next()?;
    if let Some(second) = used.next() {
        says.error(
            second.line,
            format!("{}/{}", node.name, second.name),
            format!(
                "only one of RAW and XML can have elements; line {} has some, too",
                first.line
            ),
        );
    }
    let path = format!("{}/{}", node.name, first.name);
    says.unknown(first, &path, &["ELEMENT"], &[]);
    Some(first)
}

fn receive(node: &Node, config: &ChannelConfig, says: &mut Complaints) -> ReceiveFormat {
    let Some(found) = section(node, says) else {
        return ReceiveFormat::Nothing;
    };
    if found.name == "RAW" {
        return raw(found, "RECEIVE/RAW/ELEMENT", config, says)
            .map_or(ReceiveFormat::Nothing, ReceiveFormat::Raw);
    }
    let path = "RECEIVE/XML/ELEMENT";
    let mut elements: Vec<XmlElement> = Vec::new();
    for element in found.children.iter().filter(|c| c.name == "ELEMENT") {
        says.unknown(
            element,
            path,
            &[],
            &["Tag", "Type", "Set_Flag", "Set_Out", "Mode"],
        );
        let kind = xml_type(element, path, says);
        let signals = says.signals(element, path);
        let mode = says.mode(element, path, config.buffering.mode);
        let Some(tag) = says.tag(element, path, true) else {
            continue;
        };
        if elements
            .iter()
            .any(|known| known.tag == tag && known.kind.is_some() && kind.is_some())
        {
            says.error(
                element.line,
                format!("{path}/@Tag"),
                format!("{tag} is there twice"),
            );
            continue;
        }
        elements.push(XmlElement {
            tag,
            kind,
            signals,
            mode,
        });
    }
    ReceiveFormat::Xml(elements)
}

fn xml_type(element: &Node, path: &str, says: &mut Complaints) -> Option<ElementType> {
    let word = element.attribute("Type")?.trim();
    let kind = ElementType::from_word(word).filter(|kind| kind.is_xml());
    if kind.is_none() {
        says.error(
            element.line,
            format!("{path}/@Type"),
            format!("expected STRING, REAL, INT, BOOL or FRAME, found \"{word}\""),
        );
    }
    kind
}

fn send(node: &Node, config: &ChannelConfig, says: &mut Complaints) -> SendFormat {
    let Some(found) = section(node, says) else {
        return SendFormat::Nothing;
    };
    if found.name == "RAW" {
        return raw(found, "SEND/RAW/ELEMENT", config, says)
            .map_or(SendFormat::Nothing, SendFormat::Raw);
    }
    let path = "SEND/XML/ELEMENT";
    let mut elements: Vec<SendElement> = Vec::new();
    for element in found.children.iter().filter(|c| c.name == "ELEMENT") {
        says.unknown(element, path, &[], &["Tag", "Type"]);
        let Some(tag) = says.tag(element, path, true) else {
            continue;
        };
        if elements.iter().any(|known| known.tag == tag) {
            says.error(
                element.line,
                format!("{path}/@Tag"),
                format!("{tag} is there twice"),
            );
            continue;
        }
        elements.push(SendElement { tag });
    }
    SendFormat::Xml(elements)
}
