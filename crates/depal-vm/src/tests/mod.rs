mod plain;

use crate::{Diagnostic, RAW_BYTES_LIMIT, RawBytes, SourceFile, Span};

#[test]
fn lines_and_columns_count_characters_from_1() {
    let file = SourceFile::new("a.mod", "one\nzwö x\n");
    assert_eq!(file.line_column(0).to_string(), "1:1");
    let x = file.text.find('x').expect("there") as u32;
    assert_eq!(file.line_column(x).to_string(), "2:5");
    assert_eq!(file.line_column(9999).to_string(), "3:1");
    assert_eq!(file.line_text(2), "zwö x");
}

#[test]
fn a_diagnostic_has_a_one_line_form() {
    let file = SourceFile::new("a.mod", "PROC\n  x");
    let diagnostic = Diagnostic::error("RAPID0012", Span::new(0, 7, 8), "no x")
        .secondary(Span::new(0, 0, 4), "in this PROC")
        .help("add it");
    let files = [file];
    assert_eq!(
        diagnostic.one_line(&files),
        "a.mod:2:3: error[RAPID0012]: no x"
    );
    assert_eq!(
        diagnostic.plain(&files),
        "a.mod:2:3: error[RAPID0012]: no x\n    a.mod:1:1: in this PROC\n    help: add it"
    );
}

#[test]
fn raw_bytes_grow_with_zeros_up_to_their_limit() {
    let mut raw = RawBytes::default();
    assert!(raw.write(2, &[7]));
    assert_eq!(raw.as_slice(), [0, 0, 7]);
    assert!(raw.write(RAW_BYTES_LIMIT - 1, &[1]));
    assert!(!raw.write(RAW_BYTES_LIMIT - 1, &[1, 2]));
}
