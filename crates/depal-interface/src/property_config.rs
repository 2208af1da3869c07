//! The property configuration: which step parameters commands 207 and 208 reach.
//!
//! A text of lines. `#` begins a comment; empty lines do not count; blanks around fields do not count.
//!
//! - `read, id, step, key`: 207 with this id reads the parameter; an id has one such line.
//! - `write, id, step, key, value`: 208 with this id writes it; all lines of an id are carried out in order.
//!   The value is a number, or else the rest of the line as text.
//!
//! The verb may be written in capitals. Ids, steps and keys are not checked against the project here.

use std::collections::BTreeMap;

use thiserror::Error;

/// A parsed property configuration.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PropertyConfig {
    reads: BTreeMap<i32, ReadLine>,
    writes: BTreeMap<i32, Vec<WriteLine>>,
}

/// What an id of 207 reads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadLine {
    /// Step id.
    pub step: i32,
    /// Name of the parameter.
    pub key: String,
}

/// One thing that an id of 208 writes.
#[derive(Debug, Clone, PartialEq)]
pub struct WriteLine {
    /// Step id.
    pub step: i32,
    /// Name of the parameter.
    pub key: String,
    /// The new value.
    pub value: PropertyValue,
}

/// A value in a `write` line.
#[derive(Debug, Clone, PartialEq)]
pub enum PropertyValue {
    /// A finite number.
    Number(f64),
    /// Anything else.
    Text(String),
}

/// What is wrong with a property configuration; lines count from 1.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PropertyConfigError {
    /// The line begins with something else.
    #[error("property configuration, line {line}: expected `read` or `write`, found {found:?}")]
    Verb {
        /// The line.
        line: usize,
        /// Its first field.
        found: String,
    },
    /// Too few fields, or too many.
    #[error("property configuration, line {line}: expected {expected} fields, found {found}")]
    FieldCount {
        /// The line.
        line: usize,
        /// Fields of this kind of line.
        expected: usize,
        /// Fields found.
        found: usize,
    },
    /// An id or step that is no number from 0.
    #[error(
        "property configuration, line {line}: {what}: expected a whole number, found {found:?}"
    )]
    Number {
        /// The line.
        line: usize,
        /// Which field.
        what: &'static str,
        /// Its text.
        found: String,
    },
    /// No name of a parameter.
    #[error("property configuration, line {line}: the key is empty")]
    EmptyKey {
        /// The line.
        line: usize,
    },
    /// A second `read` line of one id.
    #[error("property configuration, line {line}: read id {id} is there twice")]
    DuplicateRead {
        /// The line.
        line: usize,
        /// The id.
        id: i32,
    },
}

impl PropertyConfig {
    /// Reads a configuration.
    pub fn parse(text: &str) -> Result<Self, PropertyConfigError> {
        let mut config = Self::default();
        for (place, raw) in text.lines().enumerate() {
            let content = raw.split('#').next().unwrap_or_default().trim();
            if !content.is_empty() {
                config.add(place + 1, content)?;
            }
        }
        Ok(config)
    }

    fn add(&mut self, line: usize, content: &str) -> Result<(), PropertyConfigError> {
        let (verb, _) = content.split_once(',').unwrap_or((content, ""));
        let expected = match verb.trim().to_ascii_lowercase().as_str() {
            "read" => 4,
            "write" => 5,
            other => {
                return Err(PropertyConfigError::Verb {
                    line,
                    found: other.to_owned(),
                });
            }
        };
        // A text value may hold commas; a read line may not go on.
        let limit = if expected == 5 { 5 } else { usize::MAX };
        let fields: Vec<&str> = content.splitn(limit, ',').map(str::trim).collect();
        let (id, step, key, value) = match fields.as_slice() {
            [_, id, step, key] if expected == 4 => (id, step, key, None),
            [_, id, step, key, value] if expected == 5 => (id, step, key, Some(*value)),
            other => {
                return Err(PropertyConfigError::FieldCount {
                    line,
                    expected,
                    found: other.len(),
                });
            }
        };
        let number = |what, text: &str| {
            text.parse::<i32>()
                .map_err(|_| PropertyConfigError::Number {
                    line,
                    what,
                    found: text.to_owned(),
                })
        };
        let (id, step) = (number("id", id)?, number("step", step)?);
        if key.is_empty() {
            return Err(PropertyConfigError::EmptyKey { line });
        }
        let key = (*key).to_owned();
        match value {
            None => {
                if self.reads.insert(id, ReadLine { step, key }).is_some() {
                    return Err(PropertyConfigError::DuplicateRead { line, id });
                }
            }
            Some(text) => {
                let number = text.parse::<f64>().ok().filter(|value| value.is_finite());
                let value = number.map_or_else(
                    || PropertyValue::Text(text.to_owned()),
                    PropertyValue::Number,
                );
                let lines = self.writes.entry(id).or_default();
                lines.push(WriteLine { step, key, value });
            }
        }
        Ok(())
    }

    /// The `read` line of an id.
    pub fn read(&self, id: i32) -> Option<&ReadLine> {
        self.reads.get(&id)
    }

    /// The `write` lines of an id, in order; `None` if there is none.
    pub fn writes(&self, id: i32) -> Option<&[WriteLine]> {
        self.writes.get(&id).map(Vec::as_slice)
    }
}
