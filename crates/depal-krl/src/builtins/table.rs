//! The table of built-ins. A theme is a list of headings with their code; a new one is one row in [`themes`].

use std::collections::BTreeMap;
use std::sync::LazyLock;

use depal_vm::{Builtin, BuiltinFn, RaisedError};

use super::*;
use crate::compile::types::Type;
use crate::compile::{Compiler, ParameterType, Signature};
use crate::syntax::parser::parse;
use crate::syntax::tree::{Declaration, FileKind, Mode, Name, StatementKind};

/// What a built-in answers.
pub(super) type Ran = Result<depal_vm::Outcome, RaisedError>;

/// A heading and what it runs.
///
/// `RESULT Name(TYPE a, TYPE b:OUT, ?TYPE c, ...)`: a result makes it a function; `:OUT` lends a variable;
/// `?` marks what may be left out (it is absent then); `...` stands for any more values, `...:OUT` for any more
/// variables. Of those, and of parameters of type ANY, the built-in gets a record: the name of the type, and the
/// value or the reference. `!` before the heading: the arm must stand first.
pub(super) type Entry = (&'static str, BuiltinFn);

/// Built-ins without a heading, which the lowering calls.
pub(super) type Operator = (&'static str, BuiltinFn);

/// Data, structures and enumerations that every program knows, as data lists.
/// Their variables lie behind the hidden ones, in this order.
pub(crate) fn predefined_data() -> [&'static str; 2] {
    [
        include_str!("../predefined.dat"),
        include_str!("../eki.dat"),
    ]
}

fn themes() -> [&'static [Entry]; 11] {
    [
        &bas::ENTRIES,
        &bytes::ENTRIES,
        &eki::ENTRIES,
        &geometry::ENTRIES,
        &inline::ENTRIES,
        &interrupts::ENTRIES,
        &io::ENTRIES,
        &maths::ENTRIES,
        &messages::ENTRIES,
        &strings::ENTRIES,
        &swrite::ENTRIES,
    ]
}

fn operators() -> [&'static [Operator]; 7] {
    [
        &eki::OPERATORS,
        &geometry::OPERATORS,
        &internal::OPERATORS,
        &interrupts::OPERATORS,
        &io::OPERATORS,
        &motion::OPERATORS,
        &timing::OPERATORS,
    ]
}

/// Slots of the predefined variables by their name in lower case.
static SLOTS: LazyLock<BTreeMap<String, u32>> = LazyLock::new(|| {
    let mut slots = BTreeMap::new();
    let mut slot = hidden_globals().len() as u32;
    for text in predefined_data() {
        let file = parse(u32::MAX, text, FileKind::Data, &mut Vec::new());
        for statement in &file.data {
            if let StatementKind::Declare(Declaration::Data { items, .. }) = &statement.kind {
                for item in items {
                    slots.insert(item.name.key(), slot);
                    slot += 1;
                }
            }
        }
    }
    slots
});

/// The slot of a predefined variable, `$vel`.
pub(super) fn slot_of(name: &str) -> usize {
    let slot = SLOTS.get(name).copied();
    slot.unwrap_or_else(|| unreachable!("{name} is a predefined variable")) as usize
}

/// Names of all built-in routines.
pub fn built_in_names() -> Vec<&'static str> {
    let entries = themes().concat();
    let mut names: Vec<_> = entries
        .iter()
        .map(|(heading, _)| Heading::read(heading).name)
        .collect();
    names.sort_unstable();
    names
}

/// The heading of a built-in, read.
#[derive(Debug, Clone)]
pub(crate) struct Heading {
    pub(crate) name: &'static str,
    result: Option<&'static str>,
    stops_advance: bool,
    /// Type, name, mode, whether it may be left out.
    parameters: Vec<(&'static str, &'static str, Mode, bool)>,
    more: Option<Mode>,
}

fn moded(text: &'static str) -> (&'static str, Mode) {
    match text.strip_suffix(":OUT") {
        Some(text) => (text, Mode::Out),
        None => (text, Mode::In),
    }
}

impl Heading {
    fn read(heading: &'static str) -> Self {
        let (stops_advance, heading) = match heading.strip_prefix('!') {
            Some(rest) => (true, rest),
            None => (false, heading),
        };
        let (head, tail) = heading.split_once('(').unwrap_or((heading, ")"));
        let (result, name) = match head.split_once(' ') {
            Some((result, name)) => (Some(result), name),
            None => (None, head),
        };
        let mut parameters = Vec::new();
        let mut more = None;
        for parameter in tail.trim_end_matches(')').split(", ") {
            let (text, mode) = moded(parameter);
            if text == "..." {
                more = Some(mode);
                continue;
            }
            let (optional, text) = match text.strip_prefix('?') {
                Some(rest) => (true, rest),
                None => (false, text),
            };
            if let Some((kind, name)) = text.split_once(' ') {
                parameters.push((kind, name, mode, optional));
            }
        }
        Self {
            name,
            result,
            stops_advance,
            parameters,
            more,
        }
    }

    pub(crate) fn signature(&self, compiler: &mut Compiler<'_>) -> Signature {
        let parameters = self.parameters.iter().map(|(kind, name, mode, optional)| {
            let kind = resolve(compiler, kind);
            ParameterType {
                name: (*name).to_owned(),
                kind,
                mode: *mode,
                optional: *optional,
            }
        });
        Signature {
            name: self.name.to_owned(),
            parameters: parameters.collect(),
            more: self.more,
            result: self.result.map(|kind| resolve(compiler, kind)),
            stops_advance: self.stops_advance,
        }
    }
}

fn resolve(compiler: &mut Compiler<'_>, kind: &str) -> Type {
    match kind {
        "ANY" => Type::Any,
        "SIGNAL" => Type::Output,
        _ => match kind.strip_suffix("[]") {
            Some(element) => Type::Array {
                element: Box::new(resolve(compiler, element)),
                sizes: vec![0],
            },
            None => compiler.resolve_type(&Name {
                text: kind.to_owned(),
                span: depal_syntax::Span::new(u32::MAX, 0, 0),
            }),
        },
    }
}

/// All built-ins, with their headings read.
pub(crate) struct Table {
    headings: Vec<Heading>,
    builtins: Vec<Builtin>,
    operators: BTreeMap<&'static str, u32>,
}

impl Table {
    pub(crate) fn new() -> Self {
        let mut table = Self {
            headings: Vec::new(),
            builtins: Vec::new(),
            operators: BTreeMap::new(),
        };
        for (heading, run) in themes().concat() {
            let heading = Heading::read(heading);
            let name = heading.name;
            table.builtins.push(Builtin { name, run });
            table.headings.push(heading);
        }
        for (name, run) in operators().concat() {
            table.operators.insert(name, table.builtins.len() as u32);
            table.builtins.push(Builtin { name, run });
        }
        table
    }

    /// Headings in the order of the built-ins.
    pub(crate) fn headings(&self) -> &[Heading] {
        &self.headings
    }

    pub(crate) fn builtins(&self) -> Vec<Builtin> {
        self.builtins.clone()
    }

    /// A built-in without a heading.
    pub(crate) fn operator(&self, name: &str) -> u32 {
        let found = self.operators.get(name).copied();
        found.unwrap_or_else(|| unreachable!("{name} is in the table"))
    }
}
