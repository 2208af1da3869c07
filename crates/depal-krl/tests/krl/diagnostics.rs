//! What a program is told about its mistakes.

use depal_krl::{check, check_syntax, load};
use depal_syntax::Severity;

use crate::fake_system::*;

fn told(files: &[(&str, &str)]) -> String {
    let files = sources(files);
    let loaded = load(&files, &signals(), "main");
    let lines: Vec<_> = loaded.diagnostics.iter().map(|d| d.plain(&files)).collect();
    lines.join("\n")
}

fn in_main(declarations: &str, statements: &str) -> String {
    told(&[("main.src", &main_of(declarations, statements))])
}

#[test]
fn names() {
    insta::assert_snapshot!(in_main(
        "DECL INT counter\nDECL E6POS p\nDECL INTT x",
        "cuonter = 1\ncounter = p.Q\ncounter = nowhere\nwaitt( )\nBSA(#INITMOV, 0)\nBAS(#INITMOVE, 0)\n$VLE.CP = 1\ncounter = $DATE\nGOTO top"
    ));
}

#[test]
fn types() {
    insta::assert_snapshot!(in_main(
        "DECL INT i\nDECL BOOL b\nDECL CHAR s[5]\nDECL FRAME f\nDECL INT a[3]",
        "i = TRUE\nIF i THEN\nENDIF\nb = i\ns[] = i\nf = i\ni = a\ni = a[1,2]\ni = a[7]\nLIN {A1 5}\nb = s[] == \"x\"\ni = 5 + b"
    ));
}

#[test]
fn calls() {
    insta::assert_snapshot!(told(&[(
        "main.src",
        "DEF main( )\nDECL INT i\nsub(1)\nsub(1, i, 2)\nsub(1, 5)\ni = sub(1, i)\ni = fct()\nfct(2)\nPULSE(i, TRUE, 0.1)\nEND\nDEF sub(a:IN, b:OUT)\nDECL INT a, b\nEND\nDEFFCT INT fct(n:IN)\nDECL INT n\nRETURN n\nENDFCT\nDEF notype(a)\nEND"
    )]));
}

#[test]
fn blocks() {
    insta::assert_snapshot!(told(&[(
        "main.src",
        "DEF main( )\nDECL INT i\nIF i == 1 THEN\nWHILE i < 3\ni = i + 1\nENDIF\nFOR i = 1 TO 3\nEND\nDEF second( )\nENDIF\nEXIT\nLOOP\nEND"
    )]));
}

#[test]
fn syntax() {
    insta::assert_snapshot!(in_main(
        "DECL INT i",
        "i == 1\ni = (1 + 2\nsub\nWAIT 5\ni = 'HXY'\ni = \"open\nPTP {X 1, Y 2\ni = 99999999999\ni = 1 2\nIF i == 1\nENDIF\ni = ?\nTRIGGER WHEN PLACE=1 DELAY=0 DO i = 1"
    ));
}

#[test]
fn what_is_not_simulated() {
    insta::assert_snapshot!(in_main(
        "DECL INT i",
        "SPLINE\nSPL {X 1}\nENDSPLINE\nANOUT ON x = 1\nON_ERROR_PROCEED\nLIN {X 1.0} #WORLD"
    ));
}

#[test]
fn warnings() {
    let text = in_main(
        "DECL INT i",
        "i = 1\nIF i == 1 AND i < 3 THEN\nRETURN\ni = 2\nENDIF\n$CYCFLAG[1] = $IN[1]",
    );
    assert!(!text.contains("error["), "{text}");
    insta::assert_snapshot!(text);
}

#[test]
fn constants() {
    insta::assert_snapshot!(told(&[
        (
            "main.src",
            "DEF main( )\nlimit = 4\nup(limit)\nEND\nDEF up(x:OUT)\nDECL INT x\nEND"
        ),
        (
            "main.dat",
            "DEFDAT main\nDECL CONST INT limit=3\nDECL INT a[limit]\na[4]=1\nDECL INT b=a\nDECL INT b\nDECL CHAR s[2]=\"abc\"\nWAIT SEC 1\nENDDAT"
        ),
    ]));
}

#[test]
fn structures_that_contain_themselves() {
    let text = told(&[(
        "main.src",
        "DEF main( )\nSTRUC A B x\nSTRUC B A y\nDECL A z\nEND",
    )]);
    assert!(text.contains("contains itself"), "{text}");
}

#[test]
fn arrays_that_are_too_large() {
    let text = in_main("DECL E6POS a[1000,1000,1000]", "");
    assert!(text.contains("at most 100000"), "{text}");
}

#[test]
fn an_interrupt_does_not_see_local_data() {
    let text = in_main(
        "DECL INT k",
        "k = 1\nINTERRUPT DECL 3 WHEN k == 2 DO main( )",
    );
    assert!(text.contains("k is local to this routine"), "{text}");
}

#[test]
fn all_errors_of_all_files_come_at_once() {
    let files = sources(&[
        ("main.src", "DEF main( )\nx = 1\ny = 2\nEND"),
        ("other.src", "DEF other( )\nz = 1\nIF TRUE THEN\nEND"),
    ]);
    let loaded = check(&files);
    let errors = loaded.diagnostics.iter();
    let errors = errors.filter(|d| d.severity == Severity::Error);
    assert_eq!(errors.count(), 4, "{:#?}", loaded.diagnostics);
    assert_eq!(check_syntax(&files).len(), 1);
}
