//! The form that all configuration files of a controller backup share: a head that names the domain, sections,
//! entries of `-Key value` pairs.

use std::collections::BTreeMap;

/// What is wrong in a configuration file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct ConfigurationError {
    /// Line where the entry begins, from 1.
    pub line: usize,
    /// What was expected and found.
    pub message: String,
}

/// An entry: keys in lower case without the dash.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Entry {
    pub line: usize,
    pub section: String,
    pub fields: BTreeMap<String, String>,
}

/// The domain in the head of a file (`EIO:CFG_1.0:6:1::`), in upper case; none without such a head.
pub fn configuration_domain(text: &str) -> Option<String> {
    let head = text.lines().map(str::trim).find(|line| !line.is_empty())?;
    let head = head.trim_start_matches('\u{feff}');
    let (domain, rest) = head.split_once(':')?;
    rest.to_uppercase()
        .starts_with("CFG")
        .then(|| domain.trim().to_uppercase())
}

/// The entries of all sections. A section begins with `NAME:`, `#` separates, a backslash at the end of a line
/// continues the entry on the next one. A head of another domain is an error; a file without head is taken as it is.
pub(crate) fn entries(text: &str, domain: &str) -> Result<Vec<Entry>, Vec<ConfigurationError>> {
    if let Some(found) = configuration_domain(text).filter(|found| found != domain) {
        return Err(vec![ConfigurationError {
            line: 1,
            message: format!("this is a configuration of {found}, expected {domain}"),
        }]);
    }
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
    Ok(entries)
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

/// The value of a key that must be there.
pub(crate) fn required<'a>(entry: &'a Entry, key: &str) -> Result<&'a str, String> {
    entry
        .fields
        .get(&key.to_lowercase())
        .map(String::as_str)
        .filter(|value| !value.is_empty())
        .ok_or_else(|| format!("the {} entry has no -{key}", entry.section))
}
