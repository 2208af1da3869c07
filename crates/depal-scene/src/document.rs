//! The merged tree of a scene: values that still know where they were written.

use std::collections::BTreeMap;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::error::SceneProblem;

/// Tables nested deeper than this are refused: no scene needs it, and recursion stays bounded.
const MAX_DEPTH: usize = 16;
/// Lines with syntax errors that are named.
const MAX_SYNTAX_PROBLEMS: usize = 3;

/// A text that values come from.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    /// File name, or the override as written.
    pub(crate) name: String,
    pub(crate) text: String,
    /// The value of an override as written; `None` for a file.
    pub(crate) override_value: Option<String>,
}

/// Where something was written.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    pub(crate) source: usize,
    pub(crate) span: Range<usize>,
}

#[derive(Debug, Clone)]
pub(crate) enum Value {
    Text(String),
    Integer(i64),
    Float(f64),
    Flag(bool),
    DateTime(String),
    List(Vec<Node>),
    Table(Table),
}

pub(crate) type Table = BTreeMap<String, Entry>;

#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub(crate) value: Value,
    pub(crate) place: Place,
}

#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) key_place: Place,
    pub(crate) node: Node,
}

impl Node {
    /// How the value is called in a message.
    pub(crate) fn described(&self) -> String {
        match &self.value {
            Value::Text(text) if text.chars().count() > 40 => {
                let start: String = text.chars().take(37).collect();
                format!("the text {:?}", start + "...")
            }
            Value::Text(text) => format!("the text {text:?}"),
            Value::Integer(number) => number.to_string(),
            Value::Float(number) => number.to_string(),
            Value::Flag(flag) => flag.to_string(),
            Value::DateTime(text) => format!("the date {text}"),
            Value::List(items) if items.len() == 1 => "a list of 1 value".to_owned(),
            Value::List(items) => format!("a list of {} values", items.len()),
            Value::Table(_) => "a table".to_owned(),
        }
    }
}

impl Source {
    /// A problem at a byte span of this source.
    pub(crate) fn problem(
        &self,
        span: &Range<usize>,
        key: &str,
        message: String,
        hint: Option<String>,
    ) -> SceneProblem {
        let (mut line, mut column, mut source_line) = (0, 0, String::new());
        if self.override_value.is_none() {
            let mut start = span.start.min(self.text.len());
            while !self.text.is_char_boundary(start) {
                start -= 1;
            }
            let before = &self.text[..start];
            let line_start = before.rfind('\n').map_or(0, |position| position + 1);
            line = before.matches('\n').count() + 1;
            column = before[line_start..].chars().count() + 1;
            source_line = self.text[line_start..]
                .lines()
                .next()
                .map_or_else(String::new, str::to_owned);
        }
        SceneProblem {
            source: self.name.clone(),
            line,
            column,
            key: key.to_owned(),
            message,
            hint,
            source_line,
        }
    }
}

/// Reads a text as a table; syntax errors go to `problems`.
pub(crate) fn parse(
    sources: &[Source],
    source: usize,
    problems: &mut Vec<SceneProblem>,
) -> Option<Table> {
    let origin = &sources[source];
    let (table, errors) = DeTable::parse_recoverable(&origin.text);
    if !errors.is_empty() {
        problems.extend(syntax_problems(origin, &errors));
        return None;
    }
    let mut refusals = Vec::new();
    let table = read_table(table.get_ref(), source, 0, &mut refusals);
    let refused = !refusals.is_empty();
    for (span, message) in refusals {
        problems.push(origin.problem(&span, "", message, None));
    }
    (!refused).then_some(table)
}

/// Syntax errors, one for a line. One slip, such as a bracket that is left open, spoils every line behind it:
/// so only the first lines are named.
fn syntax_problems(origin: &Source, errors: &[toml::de::Error]) -> Vec<SceneProblem> {
    let mut found: Vec<SceneProblem> = Vec::new();
    for error in errors {
        let span = error.span().unwrap_or(0..0);
        let message = format!("not TOML: {}", error.message().replace('\n', ", "));
        let problem = origin.problem(&span, "", message, None);
        if found.last().is_none_or(|last| last.line != problem.line) {
            found.push(problem);
        }
    }
    let more = found.len().saturating_sub(MAX_SYNTAX_PROBLEMS);
    found.truncate(MAX_SYNTAX_PROBLEMS);
    if more > 0
        && let Some(last) = found.last_mut()
    {
        last.hint = Some(format!(
            "{more} more lines cannot be read, maybe for the same reason: look at the first one and what stands before it"
        ));
    }
    found
}

type Refusals = Vec<(Range<usize>, String)>;

fn read_table(table: &DeTable<'_>, source: usize, depth: usize, refusals: &mut Refusals) -> Table {
    table
        .iter()
        .map(|(key, value)| {
            let entry = Entry {
                key_place: Place {
                    source,
                    span: key.span(),
                },
                node: read_value(value, source, depth + 1, refusals),
            };
            (key.get_ref().clone().into_owned(), entry)
        })
        .collect()
}

fn read_value(
    value: &Spanned<DeValue<'_>>,
    source: usize,
    depth: usize,
    refusals: &mut Refusals,
) -> Node {
    let span = value.span();
    let place = Place {
        source,
        span: span.clone(),
    };
    if depth > MAX_DEPTH {
        refusals.push((
            span,
            format!("expected at most {MAX_DEPTH} levels of tables and lists, found more"),
        ));
        return Node {
            value: Value::Flag(false),
            place,
        };
    }
    let value = match value.get_ref() {
        DeValue::String(text) => Value::Text(text.clone().into_owned()),
        DeValue::Integer(digits) => {
            if let Ok(number) = i64::from_str_radix(digits.as_str(), digits.radix()) {
                Value::Integer(number)
            } else {
                refusals.push((
                    span,
                    format!("expected an integer of 64 bits, found {digits}"),
                ));
                Value::Integer(0)
            }
        }
        DeValue::Float(digits) => {
            if let Ok(number) = digits.as_str().parse() {
                Value::Float(number)
            } else {
                refusals.push((span, format!("expected a number, found {digits}")));
                Value::Float(0.0)
            }
        }
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Datetime(date) => Value::DateTime(date.to_string()),
        DeValue::Array(items) => Value::List(
            items
                .iter()
                .map(|item| read_value(item, source, depth + 1, refusals))
                .collect(),
        ),
        DeValue::Table(table) => Value::Table(read_table(table, source, depth, refusals)),
    };
    Node { value, place }
}

/// Lays `upper` over `base`: tables are merged key by key, everything else is replaced.
pub(crate) fn merge(base: &mut Table, upper: Table) {
    for (key, entry) in upper {
        match (base.get_mut(&key), entry) {
            (
                Some(Entry {
                    node:
                        Node {
                            value: Value::Table(below),
                            ..
                        },
                    ..
                }),
                Entry {
                    node:
                        Node {
                            value: Value::Table(above),
                            ..
                        },
                    ..
                },
            ) => merge(below, above),
            (_, entry) => {
                base.insert(key, entry);
            }
        }
    }
}

/// Sets one key to the value of an override, making the tables on the way.
///
/// A number in the path picks from a list: `vision.project.0.id`.
pub(crate) fn apply_override(
    table: &mut Table,
    key: &str,
    source: usize,
    sources: &[Source],
    problems: &mut Vec<SceneProblem>,
) {
    let origin = &sources[source];
    let segments: Vec<&str> = key.split('.').map(str::trim).collect();
    if segments.len() > MAX_DEPTH || segments.iter().any(|segment| segment.is_empty()) {
        problems.push(origin.problem(
            &(0..0),
            "",
            format!("expected a key such as camera.noise_mm, found {key:?}"),
            None,
        ));
        return;
    }
    let value = override_value(origin, source);
    if let Err(message) = set_key(table, &segments, value) {
        problems.push(origin.problem(&(0..0), key, message, None));
    }
}

/// Sets the key at the end of a path of one part or more.
fn set_key(table: &mut Table, path: &[&str], value: Node) -> Result<(), String> {
    let (first, rest) = path.split_first().expect("a path has a part");
    let place = value.place.clone();
    let entry = table.entry((*first).to_owned()).or_insert_with(|| Entry {
        key_place: place.clone(),
        node: Node {
            value: Value::Table(Table::new()),
            place,
        },
    });
    set_node(&mut entry.node, rest, value, first)
}

fn set_node(node: &mut Node, path: &[&str], value: Node, name: &str) -> Result<(), String> {
    let Some((first, rest)) = path.split_first() else {
        match (&mut node.value, value) {
            (
                Value::Table(below),
                Node {
                    value: Value::Table(above),
                    ..
                },
            ) => merge(below, above),
            (_, value) => *node = value,
        }
        return Ok(());
    };
    match &mut node.value {
        Value::Table(table) => set_key(table, path, value),
        Value::List(items) => {
            let count = items.len();
            match first.parse::<usize>().ok().and_then(|at| items.get_mut(at)) {
                Some(item) => set_node(item, rest, value, first),
                None => Err(format!(
                    "expected a position below {count} in the list {name:?} (they count from 0), \
                     found {first:?}"
                )),
            }
        }
        _ => Err(format!(
            "expected a table or a list at {name:?}, found {}",
            node.described()
        )),
    }
}

fn override_value(origin: &Source, source: usize) -> Node {
    let raw = origin.override_value.clone().unwrap_or_default();
    let text = format!("value = {raw}");
    let (table, errors) = DeTable::parse_recoverable(&text);
    let mut refusals = Vec::new();
    if errors.is_empty() && table.get_ref().len() == 1 {
        let mut table = read_table(table.get_ref(), source, 0, &mut refusals);
        if let Some(entry) = table.remove("value")
            && refusals.is_empty()
        {
            return entry.node;
        }
    }
    Node {
        value: Value::Text(raw),
        place: Place { source, span: 0..0 },
    }
}
