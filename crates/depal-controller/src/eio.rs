use std::collections::BTreeMap;

use crate::{CrossConnection, SignalKind, SignalSpec};

/// What an I/O configuration file of a controller backup (EIO.cfg) says about signals.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EioConfiguration {
    /// The signals of `EIO_SIGNAL`, in the order of the file.
    pub signals: Vec<SignalSpec>,
    /// The cross connections of `EIO_CROSS`.
    pub connections: Vec<CrossConnection>,
}

/// What is wrong in an I/O configuration file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct EioError {
    /// Line where the entry begins, from 1.
    pub line: usize,
    /// What was expected and found.
    pub message: String,
}

/// An entry: keys in lower case without the dash.
struct Entry {
    line: usize,
    section: String,
    fields: BTreeMap<String, String>,
}

impl EioConfiguration {
    /// Reads the text of an EIO.cfg. Sections other than `EIO_SIGNAL` and `EIO_CROSS` are passed over.
    ///
    /// # Errors
    /// All entries that cannot be understood.
    pub fn parse(text: &str) -> Result<Self, Vec<EioError>> {
        let mut read = Self::default();
        let mut errors = Vec::new();
        for entry in entries(text) {
            let result = match entry.section.as_str() {
                "EIO_SIGNAL" => signal(&entry).map(|s| read.signals.push(s)),
                "EIO_CROSS" => connection(&entry).map(|c| read.connections.push(c)),
                _ => Ok(()),
            };
            if let Err(message) = result {
                errors.push(EioError {
                    line: entry.line,
                    message,
                });
            }
        }
        if errors.is_empty() {
            Ok(read)
        } else {
            Err(errors)
        }
    }
}

/// The entries of all sections. A section begins with `NAME:`, `#` separates, a backslash at the end of a line
/// continues the entry on the next one.
fn entries(text: &str) -> Vec<Entry> {
    let mut entries = Vec::new();
    let mut section = String::new();
    let mut lines = text.lines().enumerate();
    while let Some((index, raw)) = lines.next() {
        let mut line = raw.trim().to_owned();
        while line.ends_with('\\') {
            line.pop();
            let Some((_, more)) = lines.next() else { break };
            line.push(' ');
            line.push_str(more.trim());
        }
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        if !line.starts_with('-') {
            if let Some((name, _)) = line.split_once(':') {
                section = name.trim().to_uppercase();
            }
            continue;
        }
        entries.push(Entry {
            line: index + 1,
            section: section.clone(),
            fields: fields(&line),
        });
    }
    entries
}

/// `-Key "value"`, `-Key value` and `-Flag` (an empty value).
fn fields(line: &str) -> BTreeMap<String, String> {
    let mut words = Vec::new();
    let mut characters = line.chars().peekable();
    while let Some(c) = characters.peek().copied() {
        if c.is_whitespace() {
            characters.next();
        } else if c == '"' {
            characters.next();
            let quoted: String = characters.by_ref().take_while(|c| *c != '"').collect();
            words.push((true, quoted));
        } else {
            let mut word = String::new();
            while let Some(c) = characters.next_if(|c| !c.is_whitespace()) {
                word.push(c);
            }
            words.push((false, word));
        }
    }
    let mut fields = BTreeMap::new();
    let mut key: Option<String> = None;
    for (quoted, word) in words {
        let begins = !quoted
            && word
                .strip_prefix('-')
                .is_some_and(|rest| rest.starts_with(|c: char| c.is_alphabetic()));
        if begins {
            if let Some(flag) = key.replace(word[1..].to_lowercase()) {
                fields.entry(flag).or_default();
            }
        } else if let Some(key) = key.take() {
            fields.insert(key, word);
        }
    }
    if let Some(flag) = key {
        fields.entry(flag).or_default();
    }
    fields
}

fn required<'a>(entry: &'a Entry, key: &str) -> Result<&'a str, String> {
    entry
        .fields
        .get(&key.to_lowercase())
        .map(String::as_str)
        .filter(|value| !value.is_empty())
        .ok_or_else(|| format!("the {} entry has no -{key}", entry.section))
}

fn signal(entry: &Entry) -> Result<SignalSpec, String> {
    let name = required(entry, "Name")?;
    let kind = required(entry, "SignalType")?;
    let bits = || group_bits(entry.fields.get("devicemap").map(String::as_str), name);
    let kind = match kind.to_uppercase().as_str() {
        "DI" => SignalKind::DigitalInput,
        "DO" => SignalKind::DigitalOutput,
        "GI" => SignalKind::GroupInput { bits: bits()? },
        "GO" => SignalKind::GroupOutput { bits: bits()? },
        "AI" => SignalKind::AnalogInput,
        "AO" => SignalKind::AnalogOutput,
        other => {
            return Err(format!(
                "signal {name}: -SignalType is {other}, expected DI, DO, GI, GO, AI or AO"
            ));
        }
    };
    let initial = match entry.fields.get("default") {
        None => 0.0,
        Some(text) => text
            .parse()
            .map_err(|_| format!("signal {name}: -Default is {text:?}, expected a number"))?,
    };
    Ok(SignalSpec {
        name: name.to_owned(),
        kind,
        initial,
    })
}

/// Number of bits of a map such as `0-3,5`. A group without a map is simulated with 23 bits, as many as a
/// group of the older controllers may have.
fn group_bits(map: Option<&str>, name: &str) -> Result<u8, String> {
    let Some(map) = map.filter(|map| !map.is_empty()) else {
        return Ok(23);
    };
    let wrong = || format!("signal {name}: -DeviceMap is {map:?}, expected bits such as 0-3,5");
    let mut bits = 0u32;
    for part in map.split(',') {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let first: u32 = first.trim().parse().map_err(|_| wrong())?;
        let last: u32 = last.trim().parse().map_err(|_| wrong())?;
        bits = bits.saturating_add(first.abs_diff(last).saturating_add(1));
    }
    u8::try_from(bits)
        .ok()
        .filter(|bits| (1..=32).contains(bits))
        .ok_or_else(|| format!("signal {name} has {bits} bits, expected 1 to 32"))
}

fn connection(entry: &Entry) -> Result<CrossConnection, String> {
    let flag = |key: &str| entry.fields.contains_key(key);
    let mut connection = CrossConnection {
        result: required(entry, "Res")?.to_owned(),
        actors: vec![(required(entry, "Act1")?.to_owned(), flag("act1_invert"))],
        any: Vec::new(),
    };
    for index in 2..=5 {
        let Some(actor) = entry.fields.get(&format!("act{index}")) else {
            break;
        };
        let operator = entry
            .fields
            .get(&format!("oper{}", index - 1))
            .map_or("AND", String::as_str);
        connection.any.push(match operator.to_uppercase().as_str() {
            "AND" => false,
            "OR" => true,
            other => {
                return Err(format!("-Oper{} is {other}, expected AND or OR", index - 1));
            }
        });
        let inverted = flag(&format!("act{index}_invert"));
        connection.actors.push((actor.clone(), inverted));
    }
    Ok(connection)
}
