use std::collections::BTreeSet;

use depal_vm::{Diagnostic, Loaded, SourceFile, in_order};

use crate::SignalKind;
use crate::builtins::{Table, predefined_data};
use crate::compile::{Compiled, Signals, Unit, compile};
use crate::syntax::parser::parse;
use crate::syntax::print::print;
use crate::syntax::tree::{File, FileKind};

/// How many signals of an array are added where a program computes their numbers.
const COMPUTED_SIGNALS: i64 = 1024;

/// A signal that programs may use.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SignalDefinition {
    /// As programs write it, `$OUT[5]`.
    pub name: String,
    /// Direction and width.
    pub kind: SignalKind,
}

/// Loads the files of one task, in any order, to start at the program `entry`.
/// An input or output that is not in `known_signals` is an error where its number is written in the program.
pub fn load(sources: &[SourceFile], known_signals: &[SignalDefinition], entry: &str) -> Loaded {
    load_with(sources, Some(keyed(known_signals)), Some(entry)).0
}

/// As [`load`], but inputs and outputs that the program uses are added: those whose numbers it writes, and the
/// first 1024 where it computes them. Gives back the signals so added.
pub fn load_with_auto_signals(
    sources: &[SourceFile],
    known_signals: &[SignalDefinition],
    entry: &str,
) -> (Loaded, Vec<SignalDefinition>) {
    let (loaded, compiled) = load_with(sources, None, Some(entry));
    let known = keyed(known_signals);
    let mut used = compiled.used_signals;
    for array in compiled.computed_signals {
        used.extend((1..=COMPUTED_SIGNALS).map(|number| (array, number)));
    }
    let added = used.into_iter().filter_map(|(array, number)| {
        let name = format!("{array}[{number}]");
        let kind = match array {
            "$IN" => SignalKind::Di,
            "$OUT" => SignalKind::Do,
            "$ANIN" => SignalKind::Ai,
            _ => SignalKind::Ao,
        };
        (!known.contains(&name.to_lowercase())).then_some(SignalDefinition { name, kind })
    });
    (loaded, added.collect())
}

/// Reads files without looking at names and types, each for itself.
pub fn check_syntax(sources: &[SourceFile]) -> Vec<Diagnostic> {
    let mut diagnostics = Vec::new();
    parse_all(sources, &mut diagnostics);
    in_order(diagnostics)
}

/// A file in one normal form: layout and numbers as we write them, without comments. It reads as the same program.
/// What is wrong with the text, if it does not read.
pub fn normal_form(source: &SourceFile) -> Result<String, Vec<Diagnostic>> {
    let mut diagnostics = Vec::new();
    let file = parse(0, &source.text, kind_of(source), &mut diagnostics);
    if diagnostics.is_empty() {
        Ok(print(&file))
    } else {
        Err(in_order(diagnostics))
    }
}

/// Checks files without a cabinet: any input and output is taken as there, and no entry is needed.
pub fn check(sources: &[SourceFile]) -> Loaded {
    load_with(sources, None, None).0
}

/// As [`check`], but the signals of the cabinet are known.
pub fn check_with_signals(sources: &[SourceFile], known_signals: &[SignalDefinition]) -> Loaded {
    load_with(sources, Some(keyed(known_signals)), None).0
}

fn keyed(signals: &[SignalDefinition]) -> BTreeSet<String> {
    signals.iter().map(|s| s.name.to_lowercase()).collect()
}

/// The last part of a path without its extension, and the extension.
fn stem(name: &str) -> (&str, &str) {
    let base = name.rsplit(['/', '\\']).next().unwrap_or(name);
    base.rsplit_once('.').unwrap_or((base, ""))
}

fn kind_of(source: &SourceFile) -> FileKind {
    match stem(&source.name).1.to_ascii_lowercase().as_str() {
        "dat" => FileKind::Data,
        "sub" => FileKind::Submit,
        _ => FileKind::Source,
    }
}

fn predefined(diagnostics: &mut Vec<Diagnostic>) -> Unit {
    let texts = predefined_data().into_iter();
    let files: Vec<(u32, File)> = texts
        .map(|text| (u32::MAX, parse(u32::MAX, text, FileKind::Data, diagnostics)))
        .collect();
    Unit {
        name: "predefined".into(),
        files,
    }
}

/// Modules by name, after the predefined one, in the order in which their first file is given.
fn parse_all(sources: &[SourceFile], diagnostics: &mut Vec<Diagnostic>) -> Vec<Unit> {
    let mut units = vec![predefined(diagnostics)];
    for (index, source) in sources.iter().enumerate() {
        let index = index as u32;
        let file = parse(index, &source.text, kind_of(source), diagnostics);
        let name = stem(&source.name).0;
        let same = units[1..]
            .iter_mut()
            .find(|unit| unit.name.eq_ignore_ascii_case(name));
        match same {
            Some(unit) => unit.files.push((index, file)),
            None => units.push(Unit {
                name: name.to_owned(),
                files: vec![(index, file)],
            }),
        }
    }
    units
}

fn load_with(sources: &[SourceFile], signals: Signals, entry: Option<&str>) -> (Loaded, Compiled) {
    let mut diagnostics = Vec::new();
    let units = parse_all(sources, &mut diagnostics);
    let table = Table::new();
    let mut compiled = compile(sources, &units, signals, entry, &table);
    diagnostics.append(&mut compiled.diagnostics);
    let program = std::mem::take(&mut compiled.program);
    (Loaded::new(program, diagnostics, "KRL0999"), compiled)
}
