use std::sync::Arc;

use depal_vm::{Diagnostic, Program, Severity, SourceFile};

use crate::Options;
use crate::compile::compile;
use crate::syntax::{parse, print, tree::Listing};

/// Most messages that are worth reading at once.
const DIAGNOSTIC_LIMIT: usize = 200;

/// What came of loading listings.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The program, unless there are errors.
    pub program: Option<Arc<Program>>,
    /// Errors and warnings, by file and place.
    pub diagnostics: Vec<Diagnostic>,
}

impl Loaded {
    /// Whether there is an error.
    pub fn has_errors(&self) -> bool {
        self.program.is_none()
    }
}

/// Loads the listings of a controller, in any order, to start at the program `entry`.
/// A program that is called and not there is a warning: the call is an error when it comes.
pub fn load(sources: &[SourceFile], options: &Options, entry: &str) -> Loaded {
    load_with(sources, options, Some(entry))
}

/// Checks listings; no entry is needed.
pub fn check(sources: &[SourceFile]) -> Loaded {
    load_with(sources, &Options::default(), None)
}

/// Reads files without looking at labels and programs, each for itself.
pub fn check_syntax(sources: &[SourceFile]) -> Vec<Diagnostic> {
    let mut diagnostics = Vec::new();
    parse_all(sources, &mut diagnostics);
    sorted(diagnostics)
}

/// The listings of a text in one normal form, with English keywords and without comments in brackets.
/// It reads as the same program. What is wrong with the text, if it does not read.
pub fn normal_form(source: &SourceFile) -> Result<String, Vec<Diagnostic>> {
    let mut diagnostics = Vec::new();
    let listings = parse(0, &source.text, &mut diagnostics);
    if diagnostics.is_empty() {
        Ok(listings.iter().map(print).collect())
    } else {
        Err(sorted(diagnostics))
    }
}

/// The text of a listing file: UTF-8, with or without a byte order mark, else ISO-8859-1.
pub fn decode(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    }
}

fn parse_all(sources: &[SourceFile], diagnostics: &mut Vec<Diagnostic>) -> Vec<Listing> {
    let mut listings = Vec::new();
    for (index, source) in sources.iter().enumerate() {
        listings.extend(parse(index as u32, &source.text, diagnostics));
    }
    listings
}

fn sorted(mut diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    diagnostics.sort_by_key(|d| (d.primary.span.file, d.primary.span.start, d.severity));
    diagnostics.dedup();
    diagnostics
}

fn load_with(sources: &[SourceFile], options: &Options, entry: Option<&str>) -> Loaded {
    let mut diagnostics = Vec::new();
    let listings = parse_all(sources, &mut diagnostics);
    let program = compile(&listings, options, entry, &mut diagnostics);
    let mut diagnostics = sorted(diagnostics);
    let failed = diagnostics.iter().any(|d| d.severity == Severity::Error);
    if diagnostics.len() > DIAGNOSTIC_LIMIT {
        let more = diagnostics.len() - DIAGNOSTIC_LIMIT;
        let last = diagnostics[DIAGNOSTIC_LIMIT].primary.span;
        diagnostics.truncate(DIAGNOSTIC_LIMIT);
        diagnostics.push(Diagnostic::error(
            "TP0999",
            last,
            format!("{more} more messages from here on are not shown"),
        ));
    }
    Loaded {
        program: (!failed).then(|| Arc::new(program)),
        diagnostics,
    }
}
