//! Reads typed sections from the tree, collecting every problem on the way.

use serde_json::{Map, Value as Json, json};

use crate::document::{Node, Place, Source, Table, Value};
use crate::error::SceneProblem;
use crate::files::Resolver;

/// What a rule needs besides the value: the sources for messages, and where files come from.
pub(crate) struct Reader<'a> {
    pub(crate) sources: &'a [Source],
    pub(crate) resolver: Resolver<'a>,
    pub(crate) problems: Vec<SceneProblem>,
}

impl Reader<'_> {
    /// Notes a problem at a place.
    pub(crate) fn problem(
        &mut self,
        place: &Place,
        key: &str,
        message: String,
        hint: Option<String>,
    ) {
        let problem = self.sources[place.source].problem(&place.span, key, message, hint);
        self.problems.push(problem);
    }

    /// Notes that a value is not what its key takes.
    pub(crate) fn unexpected(&mut self, node: &Node, key: &str, expected: &str) {
        let message = format!("expected {expected}, found {}", node.described());
        self.problem(&node.place, key, message, None);
    }

    /// Notes every key of the table that is not in `known`.
    pub(crate) fn refuse_unknown(&mut self, table: &Table, key: &str, known: &[&str]) {
        for (name, entry) in table {
            if !known.contains(&name.as_str()) {
                let hint = nearest(name, known);
                self.problem(
                    &entry.key_place,
                    &join(key, name),
                    "unknown key".to_owned(),
                    Some(hint),
                );
            }
        }
    }
}

/// The hint for an unknown name: the nearest known one, or all of them.
pub(crate) fn nearest(name: &str, known: &[&str]) -> String {
    let best = known
        .iter()
        .map(|candidate| (strsim::jaro_winkler(name, candidate), *candidate))
        .fold(
            (0.0, ""),
            |best, next| if next.0 > best.0 { next } else { best },
        );
    if best.0 >= 0.75 {
        format!("did you mean {:?}?", best.1)
    } else {
        format!("known here: {}", known.join(", "))
    }
}

/// A key path one step further.
pub(crate) fn join(key: &str, name: &str) -> String {
    if key.is_empty() {
        name.to_owned()
    } else {
        format!("{key}.{name}")
    }
}

/// What a value may be, as a reader and as a JSON Schema.
pub(crate) trait Rule {
    type Output;
    /// The value, or `None` after noting at least one problem.
    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<Self::Output>;
    /// JSON Schema of the value.
    fn schema(&self) -> Json;
}

/// JSON Schema of a rule that reads a `T`.
pub(crate) fn schema_of<T, R: Rule<Output = T>>(rule: &R) -> Json {
    rule.schema()
}

/// A table with known keys.
pub(crate) trait Section: Sized {
    /// What the section is, for the JSON Schema.
    const DOC: &'static str;
    /// Names of all keys.
    const KEYS: &'static [&'static str];
    /// Reads every key; `extra` are keys that the caller has read itself.
    fn read(
        table: &Table,
        place: &Place,
        key: &str,
        extra: &[&str],
        reader: &mut Reader<'_>,
    ) -> Option<Self>;
    /// Each key's JSON Schema with its text and default, and the names of the required ones.
    fn key_schemas() -> (Map<String, Json>, Vec<String>);
    /// JSON Schema of the table.
    fn schema() -> Json {
        let (properties, required) = Self::key_schemas();
        json!({
            "type": "object",
            "description": Self::DOC,
            "properties": properties,
            "required": required,
            "additionalProperties": false,
        })
    }
}

/// A place to note problems that show only when several keys are looked at together.
pub(crate) struct Checker<'a, 'b> {
    pub(crate) table: &'a Table,
    pub(crate) place: &'a Place,
    pub(crate) key: &'a str,
    pub(crate) reader: &'a mut Reader<'b>,
}

impl Checker<'_, '_> {
    /// Notes a problem of a key; it is shown where the key stands, or where its table begins.
    /// The path may go through tables (`gripper.vacuum_signal`).
    pub(crate) fn problem(&mut self, path: &str, message: String, hint: Option<&str>) {
        let mut place = self.place.clone();
        let mut table = Some(self.table);
        for name in path.split('.') {
            let Some(entry) = table.and_then(|table| table.get(name)) else {
                break;
            };
            place = entry.node.place.clone();
            table = match &entry.node.value {
                Value::Table(next) => Some(next),
                _ => None,
            };
        }
        let key = join(self.key, path);
        self.reader
            .problem(&place, &key, message, hint.map(str::to_owned));
    }

    /// Whether the command line gives this key.
    pub(crate) fn is_override(&self, key: &str) -> bool {
        self.table.get(key).is_some_and(|entry| {
            let source = entry.node.place.source;
            self.reader.sources[source].override_value.is_some()
        })
    }
}

/// The text of doc comment lines, joined.
pub(crate) fn doc_text(lines: &[&str]) -> String {
    let lines: Vec<&str> = lines.iter().map(|line| line.trim()).collect();
    lines.join(" ")
}

/// Declares a section: the public struct, its reader and its JSON Schema, from one table.
///
/// Each line is `name: Type, rule, mode;` where the mode is `required`, `default(value)`,
/// `section` (a table that may be left out when its own keys may) or `file(path)`
/// (a file that is read from this path when the key is left out).
macro_rules! section {
    (
        $(#[doc = $doc:literal])*
        pub struct $Name:ident {
            $(
                $(#[doc = $field_doc:literal])*
                $field:ident : $Type:ty, $rule:expr, $mode:ident $(($value:expr))?;
            )*
        }
        $(check $check:path;)?
    ) => {
        $(#[doc = $doc])*
        #[derive(Debug, Clone, PartialEq, serde::Serialize)]
        pub struct $Name {
            $(
                $(#[doc = $field_doc])*
                pub $field: $Type,
            )*
        }

        impl $crate::reader::Section for $Name {
            const DOC: &'static str = concat!($($doc, " ",)* "");
            const KEYS: &'static [&'static str] = &[$(stringify!($field)),*];

            fn read(
                table: &$crate::document::Table,
                place: &$crate::document::Place,
                key: &str,
                extra: &[&str],
                reader: &mut $crate::reader::Reader<'_>,
            ) -> Option<Self> {
                let _ = place;
                let mut known = Self::KEYS.to_vec();
                known.extend_from_slice(extra);
                reader.refuse_unknown(table, key, &known);
                $(
                    let $field: Option<$Type> = {
                        let path = $crate::reader::join(key, stringify!($field));
                        match table.get(stringify!($field)) {
                            Some(entry) => {
                                $crate::reader::Rule::read(&$rule, &entry.node, &path, reader)
                            }
                            None => section!(@absent $mode $(($value))?, $rule, place, path, reader),
                        }
                    };
                )*
                let section = Self { $($field: $field?),* };
                $(
                    $check(
                        &section,
                        &mut $crate::reader::Checker { table, place, key, reader },
                    );
                )?
                Some(section)
            }

            fn key_schemas() -> (serde_json::Map<String, serde_json::Value>, Vec<String>) {
                #[allow(unused_mut)]
                let mut properties = serde_json::Map::new();
                #[allow(unused_mut)]
                let mut required = Vec::new();
                $(
                    let mut schema = $crate::reader::schema_of::<$Type, _>(&$rule);
                    schema["description"] =
                        $crate::reader::doc_text(&[$($field_doc),*]).into();
                    section!(@schema $mode $(($value))?, $Type, stringify!($field), schema, required);
                    properties.insert(stringify!($field).to_owned(), schema);
                )*
                (properties, required)
            }
        }
    };
    (@absent required, $rule:expr, $place:ident, $path:ident, $reader:ident) => {{
        $reader.problem($place, &$path, "missing key".to_owned(), None);
        None
    }};
    (@absent default($value:expr), $rule:expr, $place:ident, $path:ident, $reader:ident) => {
        Some($value)
    };
    (@absent section, $rule:expr, $place:ident, $path:ident, $reader:ident) => {{
        let empty = $crate::document::Node {
            value: $crate::document::Value::Table($crate::document::Table::new()),
            place: $place.clone(),
        };
        $crate::reader::Rule::read(&$rule, &empty, &$path, $reader)
    }};
    (@absent file($value:expr), $rule:expr, $place:ident, $path:ident, $reader:ident) => {{
        let written = $crate::document::Node {
            value: $crate::document::Value::Text($value.to_owned()),
            place: $place.clone(),
        };
        $crate::reader::Rule::read(&$rule, &written, &$path, $reader)
    }};
    (@schema required, $Type:ty, $name:expr, $schema:ident, $required:ident) => {
        $required.push($name.to_owned());
    };
    (@schema default($value:expr), $Type:ty, $name:expr, $schema:ident, $required:ident) => {
        let default: $Type = $value;
        $schema["default"] =
            serde_json::to_value(default).expect("plain data with text keys is JSON");
    };
    (@schema section, $Type:ty, $name:expr, $schema:ident, $required:ident) => {
        // A table that has required keys is itself required.
        if $schema["required"].as_array().is_some_and(|keys| !keys.is_empty()) {
            $required.push($name.to_owned());
        }
    };
    (@schema file($value:expr), $Type:ty, $name:expr, $schema:ident, $required:ident) => {
        $schema["default"] = $value.into();
    };
}
pub(crate) use section;
