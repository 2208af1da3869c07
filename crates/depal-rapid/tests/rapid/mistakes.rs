//! A task folder with ten mistakes of ten kinds and more, as a new user has it.

use std::collections::BTreeSet;

use depal_rapid::load;
use depal_syntax::{Severity, SourceFile};

use crate::fake_system::signals;

fn folder() -> [SourceFile; 2] {
    [
        SourceFile::new("Main.mod", include_str!("../mistakes/Main.mod")),
        SourceFile::new("Tools.sys", include_str!("../mistakes/Tools.sys")),
    ]
}

/// File, line, code and what must be in the message or the help, one a mistake.
const EXPECTED: [(&str, u32, &str, &str); 11] = [
    ("Main.mod", 14, "RAPID0100", "did you mean count?"),
    ("Main.mod", 17, "RAPID0109", "rows is a constant"),
    ("Main.mod", 20, "RAPID0100", "did you mean do_pump?"),
    ("Main.mod", 22, "RAPID0104", "NumToStr"),
    ("Main.mod", 23, "RAPID0106", "needs its argument Tool"),
    ("Main.mod", 24, "RAPID0105", "usage: WaitTime"),
    (
        "Main.mod",
        25,
        "RAPID0107",
        "usage: report text [\\Quietly]",
    ),
    ("Main.mod", 29, "RAPID0010", "`;` is missing here"),
    ("Main.mod", 31, "RAPID0101", "did you mean WaitTime?"),
    ("Main.mod", 32, "RAPID0111", "x := Strength(..)"),
    ("Tools.sys", 9, "RAPID0114", "outside 1..3"),
];

#[test]
fn every_mistake_is_told_at_its_line_with_its_mend() {
    let sources = folder();
    let loaded = load(&sources, &signals(), "main");
    assert!(loaded.program.is_none());
    let errors = loaded.diagnostics.iter();
    let errors: Vec<_> = errors.filter(|d| d.severity == Severity::Error).collect();
    let shown: Vec<_> = errors.iter().map(|d| d.plain(&sources)).collect();
    assert_eq!(errors.len(), EXPECTED.len(), "{}", shown.join("\n"));
    let mut kinds = BTreeSet::new();
    for (found, (file, line, code, words)) in errors.iter().zip(&EXPECTED) {
        let source = &sources[found.primary.span.file as usize];
        let text = found.plain(&sources);
        let at = source.line_column(found.primary.span.start).line;
        assert_eq!(
            (source.name.as_str(), at, found.code),
            (*file, *line, *code),
            "{text}"
        );
        assert!(text.contains(words), "{words}: {text}");
        kinds.insert(found.code);
    }
    assert!(kinds.len() >= 10, "{kinds:?}");
    insta::assert_snapshot!(shown.join("\n"));
}

/// The counterfactual: each mistake mended takes its own message away and no other.
#[test]
fn a_mended_mistake_is_silent() {
    let mends = [
        (14, "cuont", "count"),
        (17, "rows := rows - 1", "count := rows - 1"),
        (20, "do_pmup", "do_pump"),
        (22, "TPWrite count", "TPWrite NumToStr(count, 0)"),
        (23, "z10;", "z10, gripper;"),
        (24, "0.5, 1", "0.5"),
        (25, " \\Loudly", ""),
        (29, "pause", "pause;"),
        (31, "WaitTme", "WaitTime"),
        (32, "Strength", "count := Strength()"),
    ];
    for (line, from, to) in mends {
        let mut sources = folder();
        let lines: Vec<_> = sources[0].text.lines().enumerate().collect();
        let text: Vec<_> = lines
            .iter()
            .map(|(i, text)| {
                if i + 1 == line {
                    text.replace(from, to)
                } else {
                    (*text).to_owned()
                }
            })
            .collect();
        sources[0].text = text.join("\n");
        let loaded = load(&sources, &signals(), "main");
        let lines: Vec<_> = loaded
            .diagnostics
            .iter()
            .map(|d| {
                sources[d.primary.span.file as usize]
                    .line_column(d.primary.span.start)
                    .line
            })
            .collect();
        assert_eq!(lines.len(), 10, "line {line}: {lines:?}");
        assert!(!lines.contains(&(line as u32)), "line {line}: {lines:?}");
    }
}
