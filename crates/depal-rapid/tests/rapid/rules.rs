//! Rules of numbers, data, parameters and handlers, one micro-program each, with the case against it.

use depal_rapid::load;
use depal_syntax::SourceFile;

use crate::fake_system::*;

#[track_caller]
fn check(data: &str, statements: &str, expected: &[&str]) {
    assert_eq!(output(data, statements), expected, "{data}\n{statements}");
}

/// Codes of the errors that a program has before it runs.
fn refused(data: &str, statements: &str) -> Vec<&'static str> {
    let text = format!("MODULE m\n{data}\nPROC main()\n{statements}\nENDPROC\nENDMODULE");
    let loaded = load(&[SourceFile::new("m.mod", text)], &signals(), "main");
    loaded.diagnostics.iter().map(|d| d.code).collect()
}

#[test]
fn whole_numbers_of_a_num_are_exact_up_to_2_to_the_24() {
    check(
        "VAR num a;",
        "a := 8388607; a := a + 1; TPWrite NumToStr(a, 0);",
        &["8388608"],
    );
    check(
        "VAR num a;",
        "a := 16777215; a := a + 1; a := a + 1; TPWrite NumToStr(a, 0);",
        &["16777216"],
    );
    // A literal takes the width of the other side; data are not converted by themselves.
    check(
        "VAR num a;",
        "a := a + 16777217; TPWrite NumToStr(a, 0);",
        &["16777216"],
    );
    assert_eq!(
        refused(
            "VAR num a;
VAR dnum d;",
            "a := d;"
        ),
        ["RAPID0104"]
    );
    check(
        "VAR num a;\nVAR dnum d := 3;",
        "a := DnumToNum(d) + 1; d := NumToDnum(a) + 0.5; TPWrite \"\" \\Dnum:=d;",
        &["4.5"],
    );
}

#[test]
fn each_operation_rounds_to_32_bits() {
    check(
        "VAR num a;",
        "a := 1 / 3; TPWrite NumToStr(a, 10); a := a * 3; TPWrite NumToStr(a, 10); a := 0.1; a := a + 0.7; TPWrite NumToStr(a, 10);",
        &["0.3333333433", "1.0000000000", "0.8000000119"],
    );
    check(
        "VAR dnum a;",
        "a := 1; a := a / 3; TPWrite DnumToStr(a, 15);",
        &["0.333333333333333"],
    );
}

#[test]
fn div_and_mod_cut_towards_zero() {
    check(
        "",
        "TPWrite ValToStr(7 DIV 2) + ValToStr(-7 DIV 2) + ValToStr(7 MOD 4) + ValToStr(-7 MOD 4);",
        &["3-33-3"],
    );
    check(
        "",
        "TPWrite ValToStr(1 DIV 0);\nERROR\nIF ERRNO = ERR_DIVZERO TPWrite \"zero\";\nTRYNEXT;",
        &["zero"],
    );
}

#[test]
fn numbers_become_text_with_6_digits() {
    for (value, text) in [
        ("1/3", "0.333333"),
        ("100000", "100000"),
        ("1000000", "1E+06"),
        ("123456.7", "123457"),
        ("-0.5", "-0.5"),
        ("0", "0"),
    ] {
        check("", &format!("TPWrite ValToStr({value});"), &[text]);
    }
    for (call, text) in [
        ("NumToStr(1.005, 2)", "1.00"),
        ("NumToStr(0.125, 2)", "0.12"),
        ("NumToStr(0.375, 2)", "0.38"),
        ("NumToStr(2.5, 0)", "2"),
        ("NumToStr(3.5, 0)", "4"),
        ("NumToStr(-0.04, 1)", "-0.0"),
        ("NumToStr(12, 3)", "12.000"),
    ] {
        check("", &format!("TPWrite {call};"), &[text]);
    }
}

#[test]
fn data_without_a_value_begin_with_zeros() {
    let data = "RECORD part num n; string s; bool b; pos p; ENDRECORD\nVAR part a;\nVAR num l{2,2};\nVAR robtarget t;";
    check(
        data,
        "TPWrite ValToStr(a); TPWrite ValToStr(l); TPWrite ValToStr(t.rot);",
        &["[0,\"\",FALSE,[0,0,0]]", "[[0,0],[0,0]]", "[0,0,0,0]"],
    );
}

#[test]
fn records_and_arrays_are_copied_whole() {
    let data = "RECORD part num n; pos p; ENDRECORD\nVAR part a := [1,[2,3,4]];\nVAR part b;\nVAR num l{3} := [1,2,3];\nVAR num k{3};";
    check(
        data,
        "b := a; b.p.y := 30; a.n := 9; k := l; k{1} := 100; l := [7,8,9]; TPWrite ValToStr(a) + ValToStr(b) + ValToStr(k) + ValToStr(l);",
        &["[9,[2,3,4]][1,[2,30,4]][100,2,3][7,8,9]"],
    );
    check(
        data,
        "b := a; IF a = b TPWrite \"equal\"; b.p.z := 0; IF a <> b TPWrite \"not equal\";",
        &["equal", "not equal"],
    );
    assert_eq!(
        refused("VAR num a{2};\nVAR num b{3};", "a := b;"),
        ["RAPID0104"]
    );
}

#[test]
fn arrays_begin_at_1_and_are_checked_in_each_dimension() {
    let data = "VAR num a{2,3} := [[1,2,3],[4,5,6]];\nVAR num i;\nVAR num j;";
    check(
        data,
        "i := 2; j := 3; TPWrite ValToStr(a{i,j}) + ValToStr(a{1,1}) + ValToStr(Dim(a,1)) + ValToStr(Dim(a,2));",
        &["6123"],
    );
    for (i, j) in [(0, 1), (3, 1), (1, 0), (1, 4), (-1, 2)] {
        check(
            data,
            &format!(
                "i := {i}; j := {j}; a{{i,j}} := 1; TPWrite \"in\";\nERROR\nIF ERRNO = ERR_OUTOFBND TPWrite \"out\";\nRETURN;"
            ),
            &["out"],
        );
    }
    assert_eq!(refused(data, "a{1} := 1;"), ["RAPID0114"]);
    assert_eq!(refused(data, "a{1,4} := 1;"), ["RAPID0114"]);
}

#[test]
fn a_value_parameter_is_the_routines_own() {
    let data = "VAR num n := 1;\nVAR pos p := [1,2,3];\nPROC change(num a, pos b)\na := a + 1; b.x := 9; TPWrite ValToStr(a) + ValToStr(b);\nENDPROC";
    check(
        data,
        "change n, p; TPWrite ValToStr(n) + ValToStr(p);",
        &["2[9,2,3]", "1[1,2,3]"],
    );
}

#[test]
fn var_inout_and_pers_parameters_take_what_they_name() {
    let data = "VAR num v;\nPERS num p := 0;\nCONST num c := 1;\nPROC tv(VAR num x)\nx := 1;\nENDPROC\nPROC ti(INOUT num x)\nx := 2;\nENDPROC\nPROC tp(PERS num x)\nx := 3;\nENDPROC";
    check(
        data,
        "tv v; ti p; TPWrite ValToStr(v) + ValToStr(p); ti v; tp p; TPWrite ValToStr(v) + ValToStr(p);",
        &["12", "23"],
    );
    for wrong in [
        "tv p;",
        "tv c;",
        "tp v;",
        "ti c;",
        "FOR i FROM 1 TO 2 DO tv i; ENDFOR",
    ] {
        assert_eq!(refused(data, wrong), ["RAPID0109"], "{wrong}");
    }
    for wrong in ["tv 1;", "ti v + 1;"] {
        assert_eq!(refused(data, wrong), ["RAPID0108"], "{wrong}");
    }
}

#[test]
fn alternatives_exclude_each_other_and_one_may_be_needed() {
    let data = "PROC p(\\num a | \\string b)\nENDPROC\nPROC q(\\switch on | switch off)\nIF Present(on) TPWrite \"on\";\nIF Present(off) TPWrite \"off\";\nENDPROC";
    check(data, "q; q \\on; q \\off;", &["on", "off"]);
    assert_eq!(refused(data, "q \\on \\off;"), ["RAPID0128"]);
}

#[test]
fn the_loop_variable_is_the_loops_own() {
    let data = "VAR num i := 100;";
    check(
        data,
        "FOR i FROM 1 TO 2 DO TPWrite ValToStr(i); ENDFOR TPWrite ValToStr(i);",
        &["1", "2", "100"],
    );
    assert_eq!(
        refused("", "FOR i FROM 1 TO 2 DO i := 5; ENDFOR"),
        ["RAPID0109"]
    );
    check(
        "",
        "FOR i FROM 1 TO 2 STEP 0.5 DO TPWrite ValToStr(i); ENDFOR",
        &["1", "1.5", "2"],
    );
    check(
        "VAR num s;",
        "FOR i FROM 1 TO 3 STEP s DO TPWrite \"never\"; ENDFOR\nERROR\nTPWrite \"step\";\nRETURN;",
        &["step"],
    );
}

#[test]
fn test_compares_any_kind_and_may_find_nothing() {
    check(
        "VAR string s := \"b\";\nVAR bool t := TRUE;",
        "TEST s CASE \"a\": TPWrite \"1\"; CASE \"b\", \"c\": TPWrite \"2\"; ENDTEST TEST t CASE FALSE: TPWrite \"3\"; ENDTEST TEST 5 CASE 2 + 3: TPWrite \"4\"; DEFAULT: TPWrite \"5\"; ENDTEST",
        &["2", "4"],
    );
}

/// Left open by the manuals; `rules` says what is done here.
#[test]
fn and_and_or_leave_out_what_cannot_matter() {
    let data = "FUNC bool told(bool value, string name)\nTPWrite name;\nRETURN value;\nENDFUNC";
    check(
        data,
        "IF told(FALSE, \"a\") AND told(TRUE, \"b\") TPWrite \"x\"; IF told(TRUE, \"c\") OR told(TRUE, \"d\") TPWrite \"y\"; IF told(TRUE, \"e\") XOR told(TRUE, \"f\") TPWrite \"z\";",
        &["a", "c", "y", "e", "f"],
    );
}

#[test]
fn an_error_inside_a_handler_ends_the_program() {
    let data = "PROC p()\nRAISE 5;\nERROR\nRAISE 6;\nENDPROC\nPROC q()\nVAR num z;\nRAISE 5;\nERROR\nz := 1 / z;\nENDPROC";
    // RAISE with a number in a handler goes to the caller; a fault has nowhere to go.
    check(
        data,
        "p;\nERROR\nTPWrite \"main\" \\Num:=ERRNO;\nTRYNEXT;",
        &["main6"],
    );
    let out = output(data, "q;\nERROR\nTPWrite \"never\";\nTRYNEXT;");
    assert!(out.len() == 1 && out[0].contains("ERR_DIVZERO"), "{out:?}");
}

#[test]
fn retry_counts_for_each_statement_anew() {
    let data = "VAR num n;\nPROC flaky()\nn := n + 1;\nIF n MOD 4 <> 0 RAISE 7;\nENDPROC";
    check(
        data,
        "flaky; flaky; flaky; TPWrite \"\" \\Num:=n;\nERROR\nRETRY;",
        &["12"],
    );
    let never = "PROC never()\nRAISE 8;\nENDPROC";
    let out = output(never, "never;\nERROR\nTPWrite \"again\";\nRETRY;");
    assert_eq!(out.iter().filter(|l| *l == "again").count(), 5);
    assert!(out[5].contains("ERR_EXCRTYMAX"), "{out:?}");
}

#[test]
fn errors_of_the_users_own_are_booked_or_1_to_90() {
    let data =
        "VAR errnum ERR_MINE := -1;\nPROC p()\nBookErrNo ERR_MINE;\nRAISE ERR_MINE;\nENDPROC";
    check(
        data,
        "p;\nERROR\nIF ERRNO = ERR_MINE TPWrite \"mine\";\nTRYNEXT;",
        &["mine"],
    );
}

#[test]
fn a_clause_may_name_the_errors_it_takes_by_data() {
    let data = "VAR errnum ERR_MINE := -1;\nVAR errnum ERR_OTHER := -1;\nCONST errnum FIVE := 5;\nPROC p(num which)\nRAISE which;\nERROR (ERR_MINE, FIVE, ERR_DIVZERO)\nTPWrite \"taken\";\nRETURN;\nENDPROC";
    check(
        data,
        "BookErrNo ERR_MINE; BookErrNo ERR_OTHER; p ERR_MINE; p 5; p ERR_DIVZERO; p ERR_OTHER; TPWrite \"end\";\nERROR\nTPWrite \"passed on\";\nTRYNEXT;",
        &["taken", "taken", "taken", "passed on", "end"],
    );
    assert_eq!(
        refused(
            "VAR string s;\nPROC p()\nRAISE 1;\nERROR (s)\nTRYNEXT;\nENDPROC",
            "p;"
        ),
        ["RAPID0116"]
    );
}

#[test]
fn exit_leaves_all_and_return_leaves_one() {
    let data = "PROC a()\nb;\nTPWrite \"a\";\nENDPROC\nPROC b()\nIF TRUE RETURN;\nTPWrite \"b\";\nENDPROC\nPROC c()\nEXIT;\nENDPROC";
    let out = output(data, "a; c; TPWrite \"never\";");
    assert_eq!(out[0], "a");
    assert!(out[1].contains("EXIT"), "{out:?}");
}

#[test]
fn strings_are_compared_joined_and_limited() {
    check(
        "VAR string s := \"a\";",
        "IF s = \"A\" TPWrite \"same\"; IF s <> \"A\" TPWrite \"case matters\"; s := s + \"b\" + ValToStr(1); TPWrite s;",
        &["case matters", "ab1"],
    );
    for (call, error) in [
        ("StrPart(\"abc\", 3, 2)", "ERR"),
        ("StrPart(\"abc\", 0, 1)", "ERR"),
    ] {
        let out = output("", &format!("TPWrite {call};"));
        assert!(out[0].contains(error), "{out:?}");
    }
}

#[test]
fn rawbytes_are_checked_and_copied_by_bytes_from_1() {
    let data = "VAR rawbytes a;\nVAR rawbytes b;\nVAR num n;\nVAR string s;";
    check(
        data,
        "PackRawBytes \"ABCD\", a, 1 \\ASCII; CopyRawBytes a, 2, b, 3 \\NoOfBytes:=2; UnpackRawBytes b, 3, s \\ASCII:=2; TPWrite s + ValToStr(RawBytesLen(b)); UnpackRawBytes b, 1, n \\IntX:=USINT; TPWrite \"\" \\Num:=n; ClearRawBytes b \\FromIndex:=4; TPWrite \"\" \\Num:=RawBytesLen(b); ClearRawBytes b; TPWrite \"\" \\Num:=RawBytesLen(b);",
        &["BC4", "0", "3", "0"],
    );
    for (value, kind, bytes) in [
        ("-1", "SINT", "[255]"),
        ("-2", "INT", "[254, 255]"),
        ("65535", "UINT", "[255, 255]"),
        ("200", "USINT", "[200]"),
        ("-3", "DINT", "[253, 255, 255, 255]"),
    ] {
        let text = format!(
            "MODULE m\n{data}\nPROC main()\nPackRawBytes {value}, a, 1 \\IntX:={kind};\nUnpackRawBytes a, 1, n \\IntX:={kind};\nENDPROC\nENDMODULE"
        );
        let mut machine = machine(&text);
        run(&mut machine, &mut FakeSystem::default());
        let depal_vm::Value::Raw(raw) = global(&machine, "a") else {
            panic!("rawbytes")
        };
        assert_eq!(format!("{:?}", raw.as_slice()), bytes);
        assert_eq!(global(&machine, "n").as_number(), value.parse().ok());
    }
    for wrong in [
        "PackRawBytes 256, a, 1 \\IntX:=USINT;",
        "PackRawBytes -1, a, 1 \\IntX:=UINT;",
        "PackRawBytes 1, a, 0 \\IntX:=UINT;",
        "PackRawBytes 1, a, 1025 \\IntX:=USINT;",
        "UnpackRawBytes a, 5, n \\Float4;",
    ] {
        let out = output(data, &format!("{wrong}\nTPWrite \"done\";"));
        assert!(!out.contains(&"done".to_owned()), "{wrong} {out:?}");
    }
}

#[test]
fn a_traps_own_number_and_errors_by_name() {
    check(
        "",
        "IF ERR_DIVZERO <> ERR_OUTOFBND TPWrite \"\" \\Num:=0; IF SOCKET_CLOSED <> SOCKET_CONNECTED TPWrite \"two\"; TPWrite NumToStr(pi, 5); TPWrite \"\" \\Bool:=TRUE;",
        &["0", "two", "3.14159", "TRUE"],
    );
}

#[test]
fn rules_that_the_manuals_leave_open_are_as_the_page_says() {
    let data = "VAR num list{3};\nVAR dnum d;\nVAR num n;\nPROC given()\nRAISE 5;\nERROR\nTPWrite \"given\";\nENDPROC\nVAR intnum i;\nTRAP t\nTPWrite ValToStr(AOutput(ao_flow));\nENDTRAP";
    for rule in &depal_rapid::OPEN_RULES {
        let mut written = output(data, rule.example);
        // What the cabinet notes of outputs is not written by the program.
        written.retain(|line| !line.contains("ao_flow ="));
        assert_eq!(written, rule.output, "{}", rule.question);
    }
}

#[test]
fn an_input_is_not_set_by_the_program() {
    assert_eq!(refused("", "SetDO di_part, 1;"), ["RAPID0104"]);
    assert_eq!(refused("", "SetGO gi_count, 1;"), ["RAPID0104"]);
    assert!(refused("", "SetDO do_pump, 1;").is_empty());
}

#[test]
fn a_quaternion_must_have_length_1() {
    let go = "MoveL [[0,0,0],[LENGTH,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v100, fine, tool0; TPWrite \"gone\";\nERROR\nIF ERRNO = ERR_ORIENT_VALUE TPWrite \"length\";\nRETURN;";
    let lines = |length: &str| {
        let mut lines = output("", &go.replace("LENGTH", length));
        lines.retain(|line| !line.contains("tcp"));
        lines
    };
    assert_eq!(lines("1.05"), ["length"]);
    assert_eq!(lines("1.005"), ["gone"]);
}
