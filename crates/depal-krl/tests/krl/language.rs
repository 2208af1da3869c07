//! One rule of the language a test.

use crate::fake_system::*;

#[test]
fn integer_division_cuts_towards_zero() {
    assert_eq!(
        shown("DECL INT a, b", "a = 7 / 2\nb = -7 / 2", "a*100 + b"),
        "297"
    );
}

#[test]
fn a_real_rounds_when_it_becomes_an_integer() {
    let values = [("2.5", "3"), ("-2.5", "-3"), ("2.4", "2"), ("7 / 2.0", "4")];
    for (value, expected) in values {
        assert_eq!(
            shown("DECL INT i", &format!("i = {value}"), "i"),
            expected,
            "{value}"
        );
    }
}

#[test]
fn one_real_operand_makes_the_operation_real() {
    assert_eq!(
        shown("DECL REAL r\nDECL INT i", "i = 1\nr = i / 2.0 + 1 / 2", "r"),
        "0.5"
    );
    assert_eq!(
        shown("DECL REAL r\nDECL INT i", "i = 3\nr = 2.0 * (i + 1)", "r"),
        "8"
    );
}

#[test]
fn multiplication_binds_tighter_than_addition_and_both_go_from_left_to_right() {
    assert_eq!(shown("", "", "2 + 3 * 4 - 10 / 5 - 1"), "11");
    assert_eq!(shown("", "", "-(2 + 3) * 4"), "-20");
}

#[test]
fn bits() {
    assert_eq!(shown("", "", "'HF0' B_AND 60"), "48");
    assert_eq!(shown("", "", "'B1010' B_OR 5"), "15");
    assert_eq!(shown("", "", "12 B_EXOR 10"), "6");
    assert_eq!(shown("", "", "B_NOT 0"), "-1");
}

#[test]
fn not_binds_tighter_than_and() {
    assert_eq!(
        shown("DECL BOOL a", "a = NOT FALSE AND FALSE", "a"),
        "FALSE"
    );
    assert_eq!(
        shown("DECL BOOL a", "a = TRUE EXOR TRUE OR TRUE", "a"),
        "TRUE"
    );
}

#[test]
fn counting_loops() {
    let text = "DECL INT i, n";
    assert_eq!(
        shown(text, "n = 0\nFOR i = 1 TO 4\nn = n + i\nENDFOR", "n*10 + i"),
        "105"
    );
    assert_eq!(
        shown(
            text,
            "n = 0\nFOR i = 5 TO 1 STEP -2\nn = n*10 + i\nENDFOR",
            "n"
        ),
        "531"
    );
    assert_eq!(
        shown(text, "n = 0\nFOR i = 2 TO 1\nn = 9\nENDFOR", "n"),
        "0"
    );
    let computed = "n = 0\nFOR i = 3 TO 1 STEP n - 1\nn = n + 0\nENDFOR";
    assert_eq!(shown(text, computed, "i"), "0");
}

#[test]
fn the_bounds_of_a_counting_loop_are_computed_once() {
    let text = "n = 2\nFOR i = 1 TO n\nn = 9\nk = k + 1\nENDFOR";
    assert_eq!(
        shown("DECL INT i, n, k", &format!("k = 0\n{text}"), "k"),
        "2"
    );
}

#[test]
fn loops_with_conditions() {
    let text = "DECL INT i";
    assert_eq!(
        shown(text, "i = 0\nWHILE i < 3\ni = i + 1\nENDWHILE", "i"),
        "3"
    );
    assert_eq!(
        shown(text, "i = 9\nREPEAT\ni = i + 1\nUNTIL i > 3", "i"),
        "10"
    );
    let text2 = "i = 0\nLOOP\ni = i + 1\nIF i == 5 THEN\nEXIT\nENDIF\nENDLOOP";
    assert_eq!(shown(text, text2, "i"), "5");
}

#[test]
fn switch_takes_the_first_case_without_falling_through() {
    let switch = "SWITCH i\nCASE 1, 2\nn = 12\nCASE 2\nn = 2\nDEFAULT\nn = 0\nENDSWITCH";
    for (i, expected) in [(1, "12"), (2, "12"), (7, "0")] {
        let text = format!("i = {i}\n{switch}");
        assert_eq!(shown("DECL INT i, n", &text, "n"), expected);
    }
}

#[test]
fn enumerations_are_compared_and_switched() {
    let source = "DEF main( )\nENUM COLOUR RED, GREEN\nDECL COLOUR c\nDECL INT n\nc = #GREEN\nSWITCH c\nCASE #RED\nn = 1\nCASE #GREEN\nn = 2\nENDSWITCH\nIF #GREEN == c THEN\nn = n + 10\nENDIF\nMsgNotify(\"%1\", n)\nEND";
    assert_eq!(run_files(&[("main.src", source)]), ["12"]);
}

#[test]
fn goto_leaves_a_loop() {
    let text = "i = 0\nagain:\ni = i + 1\nIF i < 4 THEN\nGOTO again\nENDIF";
    assert_eq!(shown("DECL INT i", text, "i"), "4");
}

#[test]
fn structures_keep_what_an_aggregate_does_not_name() {
    let text = "p = {X 1.0, Y 2.0, Z 3.0, A 4.0, B 5.0, C 6.0}\np = {Y 20.0}";
    assert_eq!(shown("DECL FRAME p", text, "p.X*100 + p.Y + p.Z"), "123");
    let own = "DEF main( )\nSTRUC PART INT n, CHAR name[8], REAL w[2]\nDECL PART p\np = {n 3, name[] \"box\"}\np.w[2] = 1.5\nMsgNotify(\"%1 %2 %3\", p.n, p.name[], p.w[2])\nEND";
    assert_eq!(run_files(&[("main.src", own)]), ["3 box 1.5"]);
}

#[test]
fn arrays_count_from_1_in_up_to_three_dimensions() {
    let text = "a[1,1,1] = 1\na[2,3,4] = 24\na[2,1,4] = 5";
    assert_eq!(
        shown(
            "DECL INT a[2,3,4]",
            text,
            "a[2,3,4]*10 + a[1,1,1] + a[2,1,4]"
        ),
        "246"
    );
}

#[test]
fn values_are_lent_or_copied() {
    let source = "DEF main( )\nDECL INT a, b\na = 1\nb = 1\nchange(a, b)\nMsgNotify(\"%1 %2\", a, b)\nEND\nDEF change(x:IN, y:OUT)\nDECL INT x, y\nx = x + 10\ny = y + x\nEND";
    assert_eq!(run_files(&[("main.src", source)]), ["1 12"]);
    let default = source.replace("x:IN", "x").replace("y:OUT", "y");
    assert_eq!(run_files(&[("main.src", &default)]), ["11 12"]);
}

#[test]
fn a_part_of_a_variable_is_lent() {
    let source = "DEF main( )\nDECL E6POS p[2]\nDECL INT i\ni = 2\nup(p[i].Z)\nup(p[i].Z)\nMsgNotify(\"%1\", p[2].Z)\nEND\nDEF up(z:OUT)\nDECL REAL z\nIF VARSTATE(\"p\") == 0 THEN\nENDIF\nz = 5.0\nEND";
    let source = source.replace("IF VARSTATE(\"p\") == 0 THEN\nENDIF\n", "");
    assert_eq!(run_files(&[("main.src", &source)]), ["5"]);
}

#[test]
fn functions_return_and_call_themselves() {
    let source = "DEF main( )\nMsgNotify(\"%1\", fac(6))\nEND\nDEFFCT INT fac(n:IN)\nDECL INT n\nIF n <= 1 THEN\nRETURN 1\nENDIF\nRETURN n * fac(n - 1)\nENDFCT";
    assert_eq!(run_files(&[("main.src", source)]), ["720"]);
}

#[test]
fn both_sides_of_and_are_computed() {
    let trace = output(
        "DECL INT a[2], i\nDECL BOOL b",
        "i = 3\nb = (i < 3) AND (a[i] == 1)",
    );
    assert_eq!(
        trace,
        ["main/main:5: array index 3 is outside 1..2 (dimension 1)"]
    );
}

#[test]
fn declarations_may_stand_behind_statements() {
    let text = "i = 1\nDECL INT k\nk = 2\nIF i == 1 THEN\nINT m\nm = 3\nENDIF";
    assert_eq!(shown("INT i", text, "i + k + m"), "6");
}

#[test]
fn frames_multiply_and_turn_about_z_y_x() {
    let text = "b = {X 100.0, Y 0.0, Z 0.0, A 90.0, B 0.0, C 0.0}\np = {X 10.0, Y 0.0, Z 5.0, A 0.0, B 0.0, C 0.0}\nr = b : p";
    let data = "DECL FRAME b, r\nDECL FRAME p\nDECL INT x, y, z, a";
    let ints = "x = r.X\ny = r.Y\nz = r.Z\na = r.A";
    let shown_text = output(
        data,
        &format!("{text}\n{ints}\nMsgNotify(\"%1 %2 %3\", x, y, z)\nMsgNotify(\"%1\", a)"),
    );
    assert_eq!(shown_text, ["100 10 5", "90"]);
    let inverse = format!("{text}\nr = INV_POS(b) : b\nx = r.X + r.Y + r.Z + r.A");
    assert_eq!(shown(data, &inverse, "x"), "0");
}

#[test]
fn geometry_functions_use_degrees() {
    assert_eq!(shown("DECL INT i", "i = 1000 * SIN(30)", "i"), "500");
    assert_eq!(
        shown(
            "DECL INT i",
            "i = ACOS(0.5) + ATAN2(1, 1) + SQRT(16) + ABS(-3)",
            "i"
        ),
        "112"
    );
}

#[test]
fn local_data_begin_anew_in_each_call() {
    let source = "DEF main( )\nsub( )\nsub( )\nEND\nDEF sub( )\nDECL INT n\nn = n + 1\nEND";
    assert_eq!(
        run_files(&[("main.src", source)]),
        ["main/sub:7: n has no value yet"]
    );
}

#[test]
fn words_are_read_in_any_case_and_axis_data_convert() {
    let source = "&ACCESS RVO\ndef  main()\n   decl axis j\n   bas(#initmov, 0)  ; begin\n   global interrupt decl 16 when $timer_flag[1]==true do tick()\n   interrupt on 16\n   $timer[1] = -20\n   $timer_stop[1] = false\n   j = $axis_act_meas\n   j.a1 = 3\n   ptp j c_ptp\n   wait sec 0.05\nend\ndef tick()\n   msgnotify(\"tick\")\nend\n";
    let trace = run_files(&[("main.src", source)]);
    assert!(trace[0].contains("joints [3.0, 0.0"), "{trace:?}");
    assert_eq!(trace[1..], ["tick"]);
}
