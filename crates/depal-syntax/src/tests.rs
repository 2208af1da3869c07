use crate::{Diagnostic, Scanner, SourceFile, Span, SpannedToken, Token, Tokens};

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

fn number(text: &str) -> (f64, bool, &str) {
    let mut scanner = Scanner::new(0, text);
    assert!(scanner.is_at_number(), "{text}");
    let (value, integer) = scanner.take_number();
    (value, integer, scanner.rest())
}

#[test]
fn numbers_end_where_they_end() {
    assert_eq!(number("12"), (12.0, true, ""));
    assert_eq!(number("12.mm"), (12.0, false, "mm"));
    assert_eq!(number(".5e-1;"), (0.05, false, ";"));
    assert_eq!(number("3e"), (3.0, true, "e"), "no digits, no exponent");
    assert_eq!(number("3E+x"), (3.0, true, "E+x"));
    for text in [".", ".e1", "e1", ""] {
        assert!(!Scanner::new(0, text).is_at_number(), "{text}");
    }
}

#[test]
fn spans_count_bytes_of_the_whole_text() {
    let mut scanner = Scanner::new(3, "\u{feff}ä b");
    let start = scanner.at();
    assert_eq!((start, scanner.take_while(char::is_alphabetic)), (3, "ä"));
    assert_eq!(scanner.span_from(start), Span::new(3, 3, 5));
    let mut part = Scanner::within(0, "ab;cd", 1, 3);
    assert_eq!(part.take_any(&["b;c", "b"]), Some("b"));
    assert_eq!(part.rest(), ";");
}

fn tokens(list: Vec<Token>) -> Vec<SpannedToken> {
    let placed = list.into_iter().zip(0..);
    placed
        .map(|(token, at)| (token, Span::new(0, at, at + 1)).into())
        .collect()
}

fn messages(diagnostics: &[Diagnostic]) -> Vec<(u32, &str)> {
    let shown = diagnostics.iter();
    shown
        .map(|d| (d.primary.span.start, d.message.as_str()))
        .collect()
}

/// One place is reported once, however many things are missing there; reading never goes past the end.
#[test]
fn a_place_is_reported_once() {
    let mut diagnostics = Vec::new();
    let list = vec![Token::Name("IF".into()), Token::Mark(")"), Token::End];
    let mut tokens = Tokens::new(tokens(list), "T1", &mut diagnostics);
    assert_eq!(tokens.maybe_name(|name| name == "IF"), None);
    tokens.report_no_name("T2", "a name");
    tokens.expect_word("THEN", "here");
    assert!(tokens.maybe_word("if"));
    tokens.expect_mark("(", "before the condition");
    for _ in 0..5 {
        tokens.advance();
    }
    assert!(tokens.is_end());
    assert_eq!(tokens.position(), 2);
    assert_eq!(
        messages(&diagnostics),
        [
            (0, "expected a name, found IF"),
            (1, "expected `(` before the condition, found `)`"),
        ]
    );
    assert_eq!(diagnostics[0].primary.message, "a reserved word");
}
