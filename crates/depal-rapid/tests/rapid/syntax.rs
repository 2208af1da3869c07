//! Every form of the language reads, and what is wrong is told, all of it at once.

use depal_rapid::{check_syntax, decode, normal_form};
use depal_syntax::SourceFile;

use crate::fake_system::*;

fn codes(text: &str) -> Vec<&'static str> {
    let found = check_syntax(&[SourceFile::new("a.mod", text)]);
    found.iter().map(|d| d.code).collect()
}

#[track_caller]
fn reads(text: &str) {
    let source = SourceFile::new("a.mod", text);
    let found = check_syntax(std::slice::from_ref(&source));
    let shown: Vec<_> = found
        .iter()
        .map(|d| d.plain(std::slice::from_ref(&source)))
        .collect();
    assert!(found.is_empty(), "{text}\n{}", shown.join("\n"));
    // And in normal form it says the same.
    let printed = normal_form(&source).expect("it reads");
    assert_eq!(
        normal_form(&SourceFile::new("b.mod", printed.as_str())).as_ref(),
        Ok(&printed)
    );
}

#[track_caller]
fn statement_reads(text: &str) {
    reads(&format!(
        "MODULE m\nPROC main()\n{text}\nENDPROC\nENDMODULE"
    ));
}

#[track_caller]
fn declaration_reads(text: &str) {
    reads(&format!("MODULE m\n{text}\nENDMODULE"));
}

#[test]
fn statements_of_every_form() {
    for text in [
        "IF a b;",
        "IF a = 1 GOTO l; l:",
        "IF a IF b c;",
        "IF a THEN ENDIF",
        "IF a THEN b; ELSEIF c THEN d; ELSEIF e THEN ELSE f; ENDIF",
        "FOR i FROM 1 TO n DO ENDFOR",
        "FOR i FROM n TO 1 STEP -1 DO a{i} := i; ENDFOR",
        "WHILE TRUE DO a; ENDWHILE",
        "TEST a CASE 1, 2: b; CASE \"x\": c; DEFAULT: d; ENDTEST",
        "TEST a DEFAULT: d; ENDTEST",
        "TEST a ENDTEST",
        "again: GOTO again;",
        "RAISE; RAISE 5; RAISE ERR_X; RETRY; TRYNEXT; EXIT;",
        "CONNECT i WITH t; CONNECT a{1} WITH t;",
        "%\"p\"%; %\"p\" + NumToStr(n,0)% a, b; %\"mod:p\"% a \\x:=1;",
        "a := b; a.b.c := d; a{1,2}.b{3} := c;",
        "p; p a, b; p (a), b; p [1,2]; p -1;",
        "p a \\b; p a \\b:=1; p a, \\b:=1; p a \\b \\c:=2, d; p \\b, a; p \\b?c; p b:=1;",
        "p a,\\b:=1,\\c; MoveL p1,v100\\V:=5,z10\\Z:=3,tool0\\WObj:=wobj0;",
        "a := f(); a := f(b\\c); a := f(b,\\c:=1)\n{2}.x;",
        ";;",
        "a := NOT b AND c OR d XOR NOT e;",
        "a := -b * -c - -d; a := +b; a := b DIV c MOD d / e;",
        "a := (b = c) = (d <> e); a := b < c; a := b <= c; a := b > c; a := b >= c;",
        "a := [[1,2],[3,[4,TRUE,\"x\"]],f(1)];",
        "! only a comment\n",
    ] {
        statement_reads(text);
    }
}

#[test]
fn declarations_of_every_form() {
    for text in [
        "VAR num a; VAR num b := 1; CONST num c := 1 + 2; PERS num d := 1; PERS num e;",
        "LOCAL VAR num a; TASK PERS num b := 1; TASK VAR num c; LOCAL PERS num d;",
        "VAR num a{3}; VAR num b{2,3}; VAR num c{2,3,4} := [[[1]]]; CONST num n := 2; VAR num d{n * 2};",
        "RECORD r num a; string b; ENDRECORD LOCAL RECORD s r c; ENDRECORD RECORD t ENDRECORD",
        "ALIAS num level; LOCAL ALIAS string word;",
        "PROC p() ENDPROC LOCAL PROC q() ENDPROC FUNC num f() RETURN 1; ENDFUNC TRAP t ENDTRAP LOCAL TRAP u ENDTRAP",
        "PROC p(num a, VAR num b, INOUT num c, PERS num d, string e{*}, num f{*,*}, num g{*,*,*}) ENDPROC",
        "PROC p(\\num a) ENDPROC PROC q(\\switch a \\num b) ENDPROC PROC r(num a \\switch b | switch c \\VAR num d) ENDPROC",
        "PROC p(num a, \\num b, string c) ENDPROC PROC q(\\switch on | switch off, num a) ENDPROC",
        "PROC p(num a | dnum b, num c) ENDPROC PROC q(\\PERS num a{*}) ENDPROC",
        "PROC p() VAR num a; CONST num b := 1; VAR num c{2} := [1,2]; a := 1; ENDPROC",
        "PROC p() a; ERROR b; RETRY; ENDPROC PROC q() ERROR (1, ERR_X, n) TRYNEXT; ENDPROC",
        "PROC p() a; BACKWARD b; ERROR c; UNDO d; ENDPROC PROC q() UNDO d; ENDPROC",
    ] {
        declaration_reads(text);
    }
}

#[test]
fn modules_and_files_of_every_form() {
    for text in [
        "MODULE m ENDMODULE",
        "module M\nEndModule",
        "MODULE m(SYSMODULE) ENDMODULE",
        "MODULE m(SYSMODULE, NOSTEPIN, READONLY) ENDMODULE",
        "MODULE m(NoView) ENDMODULE MODULE n(VIEWONLY) ENDMODULE",
        "%%%\n  VERSION:1\n  LANGUAGE:ENGLISH\n%%%\n\nMODULE m\nENDMODULE\n",
        "\u{feff}%%%\r\n  VERSION:1\r\n  LANGUAGE:ENGLISH\r\n%%%\r\n\r\nMODULE m\r\n  ! Kommentar\r\n  VAR num a;\r\nENDMODULE\r\n",
        "MODULE m\n! ends without a line end\nENDMODULE ! so",
        "MODULE größe\n VAR num länge_µ; PROC Öffnen() länge_µ := 1; ENDPROC ENDMODULE\u{1a}",
        "",
    ] {
        reads(text);
    }
    assert_eq!(decode(b"! Gr\xf6\xdfe 5 \x80"), "! Größe 5 €");
    assert_eq!(decode("! Größe".as_bytes()), "! Größe");
}

#[test]
fn numbers_of_every_form() {
    let data = "VAR dnum d;";
    for (text, value) in [
        ("7", "7"),
        ("007", "7"),
        ("1.5", "1.5"),
        (".5", "0.5"),
        ("5.", "5"),
        ("1E3", "1000"),
        ("1.5e-1", "0.15"),
        ("2E+2", "200"),
        ("0x1F", "31"),
        ("0Xff", "255"),
        ("0o17", "15"),
        ("0b101", "5"),
        ("0B11", "3"),
        ("-0x10", "-16"),
        ("4294967295", "4294967295"),
    ] {
        let statements = format!("d := {text}; TPWrite \"\" \\Dnum:=d;");
        assert_eq!(output(data, &statements), [value], "{text}");
    }
}

#[test]
fn strings_of_every_form() {
    for (text, value) in [
        ("\"\"", ""),
        ("\"a \"\"b\"\" c\"", "a \"b\" c"),
        ("\"\\\\\"", "\\"),
        ("\"\\41\\62\"", "Ab"),
        ("\"! no comment; no end\"", "! no comment; no end"),
        ("\"grün\"", "grün"),
    ] {
        assert_eq!(output("", &format!("TPWrite {text};")), [value], "{text}");
    }
    let lengths = output("", "TPWrite ValToStr(StrLen(\"\\0D\\0A\"));");
    assert_eq!(lengths, ["2"]);
}

#[test]
fn upper_and_lower_case_do_not_differ() {
    let out = output(
        "var NUM Höhe := 1;\nproc SHOW(string Text)\ntpwrite TEXT;\nendproc",
        "hÖHE := höhe + 1; If HÖHE = 2 Then show valtostr(Höhe); EndIf",
    );
    assert_eq!(out, ["2"]);
}

#[test]
fn everything_wrong_in_a_file_is_told_at_once() {
    let text = "MODULE m(SYSMODUL)
  VAR num to;
  VAR num a
  VAR num b{3;
  nonsense;
  PROC p(num)
    a := ;
    b := (1 + 2;
    IF a THEN
      c = 3;
    ENDWHILE
    q();
    TPWrite \"open;
    <SMT>
    VAR num late;
  ENDPROC
  FUNC num f()
    RETURN [1, 2;
  ERROR
    RETRY;
  ERROR
    TRYNEXT;
  ENDPROC
  PROC last()
    WHILE TRUE DO
  ENDPROC
ENDMODULE
rubbish
";
    let source = [SourceFile::new("wrong.mod", text)];
    let shown: Vec<_> = check_syntax(&source)
        .iter()
        .map(|d| d.plain(&source))
        .collect();
    insta::assert_snapshot!(shown.join("\n"));
}

#[test]
fn what_is_wrong_has_its_code() {
    let in_main = |text: &str| {
        codes(&format!(
            "MODULE m\nPROC main()\n{text}\nENDPROC\nENDMODULE"
        ))
    };
    assert_eq!(in_main("IF a THEN b;"), ["RAPID0014"]);
    assert_eq!(in_main("b; ENDIF"), ["RAPID0016"]);
    assert_eq!(in_main("a := 1"), ["RAPID0010"]);
    assert_eq!(in_main("GOTO 5;"), ["RAPID0011"]);
    assert_eq!(in_main("a := 1 +;"), ["RAPID0017"]);
    assert_eq!(in_main("a := [1,2;"), ["RAPID0010"]);
    assert_eq!(in_main("p \\;"), ["RAPID0011"]);
    assert_eq!(in_main("TPWrite \"\\\";"), ["RAPID0005"]);
    assert_eq!(codes("PROC main() ENDPROC"), ["RAPID0012"]);
    assert_eq!(codes("MODULE m VAR num a; PROC p() ENDPROC"), ["RAPID0014"]);
    // One mistake, one message: what follows is read as it is meant.
    assert_eq!(in_main("a := 1\nb := 2;\nc := 3;"), ["RAPID0010"]);
    assert_eq!(in_main("a = 1; b := 2;"), ["RAPID0021"]);
    assert_eq!(in_main("TPWrite \"open;\nb := 2;"), ["RAPID0002"]);
    assert_eq!(in_main("a := f(\"open);\nb := 2;"), ["RAPID0002"]);
}

#[test]
fn a_block_left_open_is_shown_where_it_was_opened() {
    let text = "MODULE m\nPROC main()\n  FOR i FROM 1 TO 3 DO\n    IF a THEN\n      b;\n    ENDIF\n  IF c THEN\n    d;\n  ENDIF\nENDPROC\nENDMODULE\n";
    let source = [SourceFile::new("a.mod", text)];
    let found = check_syntax(&source);
    assert_eq!(found.len(), 1);
    let label = &found[0].secondary[0];
    assert_eq!(label.message, "this FOR, opened here, has no ENDFOR");
    assert_eq!(source[0].line_column(label.span.start).line, 3);
}
