use std::collections::BTreeSet;

use depal_syntax::{Diagnostic, SourceFile, in_order};
use depal_vm::Loaded;

use crate::builtins::{Table, predefined_data};
use crate::compile::{Signals, Unit, compile};
use crate::syntax::parser::parse;
use crate::syntax::print::print;
use crate::syntax::tree::{File, FileKind};

/// Loads the files of one task, in any order, to start at the program `entry`.
/// An input or output that is not among `signals`, as programs write them (`$OUT[5]`), is an error where its number is
/// written in the program.
pub fn load(sources: &[SourceFile], signals: &[String], entry: &str) -> Loaded {
    load_with(sources, Some(keyed(signals)), Some(entry))
}

/// As [`load`], but any input and output is taken as there.
pub fn load_with_any_signals(sources: &[SourceFile], entry: &str) -> Loaded {
    load_with(sources, None, Some(entry))
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
    load_with(sources, None, None)
}

/// As [`check`], but the signals of the cabinet are known.
pub fn check_with_signals(sources: &[SourceFile], signals: &[String]) -> Loaded {
    load_with(sources, Some(keyed(signals)), None)
}

fn keyed(signals: &[String]) -> BTreeSet<String> {
    signals.iter().map(|name| name.to_lowercase()).collect()
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

fn load_with(sources: &[SourceFile], signals: Signals, entry: Option<&str>) -> Loaded {
    let mut diagnostics = Vec::new();
    let units = parse_all(sources, &mut diagnostics);
    let table = Table::new();
    let (program, found) = compile(sources, &units, signals, entry, &table);
    diagnostics.extend(found);
    Loaded::new(program, diagnostics, "KRL0999")
}
