#![allow(clippy::disallowed_methods)] // The sources and the rendered pages are the tests' data.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use depal_syntax::SourceFile;

use super::{explain, pages};
use crate::{SignalDefinition, SignalKind, check, load};

/// Codes that a program gives, one of them or not. Statements are put into a module.
fn codes(example: &str) -> BTreeSet<&'static str> {
    let text = if example.contains("MODULE") {
        example.to_owned()
    } else {
        format!("MODULE m\n  PROC main()\n    {example}\n  ENDPROC\nENDMODULE\n")
    };
    let signals = [("di_part", SignalKind::Di), ("do_pump", SignalKind::Do)].map(|(name, kind)| {
        SignalDefinition {
            name: name.to_owned(),
            kind,
        }
    });
    let source = [SourceFile::new("example.mod", text)];
    let loaded = load(&source, &signals, "main").diagnostics;
    let checked = check(&source).diagnostics;
    // Without the cell every unknown name is taken as a signal, so do_pump as well.
    let checked = checked
        .iter()
        .filter(|d| d.code == "RAPID0102" && !d.message.contains("do_pump"));
    loaded.iter().chain(checked).map(|d| d.code).collect()
}

#[test]
fn every_example_gives_its_own_code_and_the_mended_one_gives_none() {
    for page in pages() {
        if page.example.is_empty() {
            continue;
        }
        let found = codes(page.example);
        assert!(found.contains(page.code), "{}: {found:?}", page.code);
        let after = codes(page.mended);
        let rest: Vec<_> = after.iter().filter(|c| **c != "RAPID0117").collect();
        assert!(rest.is_empty(), "{}: {rest:?}", page.code);
        if page.code == "RAPID0117" {
            assert!(!after.contains("RAPID0117"));
        }
    }
}

fn sources_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            sources_below(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn every_code_of_the_sources_has_a_page_and_every_page_a_code() {
    let mut paths = Vec::new();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    sources_below(&source, &mut paths);
    let mut used = BTreeSet::new();
    for path in paths {
        if path.starts_with(source.join("catalogue")) {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("just listed");
        for (at, _) in text.match_indices("\"RAPID0") {
            used.insert(
                text[at + 1..]
                    .split('"')
                    .next()
                    .unwrap_or_default()
                    .to_owned(),
            );
        }
    }
    let listed: BTreeSet<String> = pages().iter().map(|p| p.code.to_owned()).collect();
    assert_eq!(listed.len(), pages().len(), "a code has two pages");
    let without_page: Vec<_> = used.difference(&listed).collect();
    let without_use: Vec<_> = listed.difference(&used).collect();
    assert!(
        without_page.is_empty() && without_use.is_empty(),
        "without a page: {without_page:?}, never given: {without_use:?}"
    );
}

#[test]
fn a_code_is_found_however_it_is_written() {
    for code in ["RAPID0104", "rapid0104", "rapid104", "104", " 0104 "] {
        assert_eq!(explain(code).map(|p| p.code), Some("RAPID0104"), "{code}");
    }
    assert_eq!(explain("RAPID9998"), None);
    assert_eq!(explain("what"), None);
}

/// Compares a file of `docs` with what the code says; with `DEPAL_WRITE_DOCS=1` writes it.
#[track_caller]
pub(crate) fn up_to_date(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("docs")
        .join(name);
    if std::env::var_os("DEPAL_WRITE_DOCS").is_some() {
        std::fs::write(&path, text).expect("the folder is there");
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        found == text,
        "docs/{name} is out of date: run the tests once with DEPAL_WRITE_DOCS=1"
    );
}

#[test]
fn the_page_of_diagnostics_is_up_to_date() {
    let mut text = String::from(
        "# Messages about RAPID programs\n\nMade from `src/catalogue` by its tests; do not edit.\n`depal explain CODE` prints one of these pages.\nCodes below 0100 are about what cannot be read, the others about what cannot be meant.\n",
    );
    for page in pages() {
        text.push('\n');
        text.push_str(&page.markdown());
    }
    up_to_date("diagnostics.md", &text);
}

#[test]
fn the_page_of_open_rules_is_up_to_date() {
    let mut text = String::from(
        "# Rules that the manuals leave open\n\nMade from `src/rules.rs` by its tests; do not edit.\nEach example runs in the tests.\n",
    );
    for rule in &crate::OPEN_RULES {
        let _ = write!(
            text,
            "\n## {}\n\n{}\n\n```rapid\n{}\n```\n\nwrites `{}`\n",
            rule.question,
            rule.answer,
            rule.example,
            rule.output.join("`, `")
        );
    }
    up_to_date("open-rules.md", &text);
}
