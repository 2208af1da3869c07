//! Strings and bytes.

use crate::fake_system::*;

const DATA: &str = "DECL CHAR s[12], t[12]\nDECL INT n\nDECL BOOL b\nDECL STATE_T st";

#[test]
fn strings_are_arrays_of_characters() {
    assert_eq!(
        shown(DATA, "s[] = \"AB\"\nt[] = s[]\nt[2] = \"x\"", "t[]"),
        "Ax"
    );
    assert_eq!(shown(DATA, "s[] = \"AB\"", "StrLen(s[])"), "2");
    assert_eq!(
        shown(
            DATA,
            "s[] = \"long\"\ns[] = \"x\"",
            "StrLen(s[]) * 100 + StrDeclLen(s[])"
        ),
        "112"
    );
    assert_eq!(
        shown(
            DATA,
            "s[1] = 65\nn = 0\nIF s[1] == \"A\" THEN\nn = 1\nENDIF",
            "n"
        ),
        "1"
    );
}

#[test]
fn string_functions() {
    assert_eq!(
        shown(DATA, "s[] = \"AB\"\nb = StrAdd(s[], \"CD\")", "s[]"),
        "ABCD"
    );
    assert_eq!(
        shown(DATA, "s[] = \"0123456789\"\nb = StrAdd(s[], \"abc\")", "b"),
        "FALSE"
    );
    assert_eq!(
        shown(
            DATA,
            "s[] = \"abcb\"",
            "StrFind(3, s[], \"B\", #NOT_CASE_SENS)"
        ),
        "4"
    );
    assert_eq!(
        shown(DATA, "s[] = \"abcb\"", "StrFind(1, s[], \"B\", #CASE_SENS)"),
        "0"
    );
    assert_eq!(
        shown(DATA, "b = StrComp(\"a\", \"A\", #NOT_CASE_SENS)", "b"),
        "TRUE"
    );
    assert_eq!(
        shown(
            DATA,
            "b = StrCopy(s[], \"q\")\nb = StrClear(s[])",
            "StrLen(s[])"
        ),
        "0"
    );
}

#[test]
fn values_are_written_and_read_by_a_format() {
    let text = "n = 0\nSWRITE(s[], st, n, \"%03d|%5.2f\", 7, 1.5)";
    assert_eq!(shown(DATA, text, "s[]"), "007| 1.50");
    assert_eq!(shown(DATA, text, "n"), "9");
    let data = "DECL CHAR s[40]\nDECL INT n, i\nDECL REAL r\nDECL STATE_T st";
    let read = "s[] = \"x 12;-3.5\"\nn = 1\nSREAD(s[], st, n, \"%d;%f\", i, r)";
    assert_eq!(shown(data, read, "r*10 + i"), "-23");
    assert_eq!(shown(data, read, "st.HITS"), "2");
}

#[test]
fn bytes_carry_integers_and_reals_with_the_lowest_first() {
    let data = "DECL CHAR b[16]\nDECL INT o, i, k\nDECL REAL r";
    let text = "o = 0\nCAST_TO(b[], o, 258, 1.5)\nk = o\no = 0\nCAST_FROM(b[], o, i, r)";
    assert_eq!(shown(data, text, "i*10 + k"), "2588");
    assert_eq!(shown(data, text, "b[1]*1000 + b[2]"), "2001");
    assert_eq!(shown(data, text, "r"), "1.5");
    let over = "o = 14\nCAST_TO(b[], o, 1)";
    assert_eq!(
        output(data, over),
        ["main/main:6: the values reach to byte 18 of a buffer of 16 bytes"]
    );
}

#[test]
fn positions_and_arrays_go_through_bytes() {
    let data = "DECL CHAR b[100]\nDECL INT o\nDECL FRAME f, g\nDECL INT a[3], c[3]";
    let text = "f = {X 1.0, Y 2.0, Z 3.0, A 4.0, B 5.0, C 6.0}\na[1] = 7\na[2] = 8\na[3] = 9\no = 0\nCAST_TO(b[], o, f, a[])\no = 0\nCAST_FROM(b[], o, g, c[])";
    assert_eq!(shown(data, text, "g.C*1000 + c[3]*10 + o"), "6126");
}

#[test]
fn a_dialog_waits_for_the_key() {
    let mut system = FakeSystem::default();
    system.answers.push_back("2".into());
    let source = main_of(
        "DECL INT k",
        "MsgDialog(k, \"which?\")\nMsgNotify(\"%1\", k)",
    );
    let mut machine = machine(&[("main.src", &source)]);
    run(&mut machine, &mut system);
    assert_eq!(system.trace, ["which?", "2"]);
}
