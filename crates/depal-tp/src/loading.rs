use depal_syntax::{Diagnostic, SourceFile, in_order};
use depal_vm::Loaded;

use crate::Options;
use crate::compile::compile;
use crate::syntax::{parse, print, tree::Listing};

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
    in_order(diagnostics)
}

/// The listings of a text in one normal form, with English keywords and without comments in brackets.
/// It reads as the same program. What is wrong with the text, if it does not read.
pub fn normal_form(source: &SourceFile) -> Result<String, Vec<Diagnostic>> {
    let mut diagnostics = Vec::new();
    let listings = parse(0, &source.text, &mut diagnostics);
    if diagnostics.is_empty() {
        Ok(listings.iter().map(print).collect())
    } else {
        Err(in_order(diagnostics))
    }
}

fn parse_all(sources: &[SourceFile], diagnostics: &mut Vec<Diagnostic>) -> Vec<Listing> {
    let mut listings = Vec::new();
    for (index, source) in sources.iter().enumerate() {
        listings.extend(parse(index as u32, &source.text, diagnostics));
    }
    listings
}

fn load_with(sources: &[SourceFile], options: &Options, entry: Option<&str>) -> Loaded {
    let mut diagnostics = Vec::new();
    let listings = parse_all(sources, &mut diagnostics);
    let program = compile(&listings, options, entry, &mut diagnostics);
    Loaded::new(program, diagnostics, "TP0999")
}
