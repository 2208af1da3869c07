//! One rule of the language each.

use depal_vm::Value;
use depal_vm::execution::{RobotTask, Step};

use crate::fake_system::*;

#[track_caller]
fn check(data: &str, statements: &str, expected: &[&str]) {
    assert_eq!(output(data, statements), expected);
}

#[test]
fn num_is_a_32_bit_float() {
    check(
        "VAR num a;",
        "a := 16777216; a := a + 1; TPWrite NumToStr(a, 0);",
        &["16777216"],
    );
    check(
        "VAR dnum a;",
        "a := 16777216; a := a + 1; TPWrite DnumToStr(a, 0);",
        &["16777217"],
    );
    check("", "TPWrite NumToStr(0.1 + 0.2, 10);", &["0.3000000119"]);
}

#[test]
fn for_counts_down_without_step_and_evaluates_bounds_once() {
    check(
        "",
        "FOR i FROM 1 TO 0 DO TPWrite ValToStr(i); ENDFOR",
        &["1", "0"],
    );
    check(
        "VAR num n := 2;",
        "FOR i FROM 1 TO n DO n := 9; TPWrite ValToStr(i); ENDFOR",
        &["1", "2"],
    );
    check(
        "",
        "FOR i FROM 10 TO 1 STEP -4 DO TPWrite ValToStr(i); ENDFOR",
        &["10", "6", "2"],
    );
    check(
        "",
        "FOR i FROM 5 TO 1 STEP 1 DO TPWrite \"never\"; ENDFOR TPWrite \"end\";",
        &["end"],
    );
}

#[test]
fn test_takes_the_first_case_and_does_not_fall_through() {
    let data = "PROC t(num n)\nTEST n\nCASE 1, 2: TPWrite \"low\";\nCASE 2, 3: TPWrite \"three\";\nDEFAULT: TPWrite \"other\";\nENDTEST\nENDPROC";
    check(data, "t 2; t 3; t 4;", &["low", "three", "other"]);
}

#[test]
fn while_and_goto_and_compact_if() {
    check(
        "VAR num n := 3;",
        "WHILE n > 0 DO n := n - 1; IF n = 1 TPWrite \"one\"; ENDWHILE\nagain:\nn := n + 1;\nIF n < 3 GOTO again;\nTPWrite ValToStr(n);",
        &["one", "3"],
    );
}

#[test]
fn not_binds_weaker_than_and() {
    check(
        "",
        "IF NOT FALSE AND FALSE TPWrite \"not of both\";\nIF (NOT FALSE) AND FALSE TPWrite \"wrong\";",
        &["not of both"],
    );
}

#[test]
fn references_reach_the_callers_data() {
    let data = "VAR num a{3} := [1,2,3];\nVAR robtarget p;\nPROC inc(VAR num x)\nx := x + 10;\nENDPROC\nPROC deep(INOUT num x)\ninc x;\nENDPROC\nPROC copy(num x)\nx := 99;\nENDPROC\nPROC fill(VAR num v{*})\nFOR i FROM 1 TO Dim(v,1) DO v{i} := i * i; ENDFOR\nENDPROC";
    check(
        data,
        "inc a{2}; deep p.trans.y; copy a{1}; TPWrite ValToStr(a); TPWrite \"\" \\Pos:=p.trans;",
        &["[1,12,3]", "[0,10,0]"],
    );
    check(data, "fill a; TPWrite ValToStr(a);", &["[1,4,9]"]);
}

#[test]
fn optional_arguments_in_every_spelling() {
    let data = "PROC o(num a \\num b, \\switch c)\nIF Present(b) THEN TPWrite \"b\" \\Num:=b; ENDIF\nIF Present(c) TPWrite \"c\";\nTPWrite \"a\" \\Num:=a;\nENDPROC\nPROC pass(\\num b \\switch c)\no 7 \\b?b \\c?c;\nENDPROC";
    check(
        data,
        "o 1; o 2\\b:=3; o 4,\\b:=5,\\c; pass \\c; pass \\b:=1;",
        &["a1", "b3", "a2", "b5", "c", "a4", "c", "a7", "b1", "a7"],
    );
}

#[test]
fn using_an_absent_parameter_is_an_error_with_a_number() {
    let data = "PROC o(\\num b)\nTPWrite ValToStr(b);\nERROR\nIF ERRNO = ERR_NOTPRES THEN TPWrite \"absent\"; TRYNEXT; ENDIF\nENDPROC";
    check(data, "o; o \\b:=2;", &["absent", "2"]);
}

#[test]
fn routine_data_start_anew_and_module_data_stay() {
    let data = "VAR num m;\nPROC p()\nVAR num l := 5;\nm := m + 1; l := l + 1;\nTPWrite ValToStr(m) + \" \" + ValToStr(l);\nENDPROC";
    check(data, "p; p;", &["1 6", "2 6"]);
}

#[test]
fn constants_may_use_what_is_declared_later() {
    check(
        "CONST num a := b * 2;\nCONST num b := c + 1;\nCONST num c := 3;\nVAR num list{c};",
        "TPWrite ValToStr(a) + \",\" + ValToStr(Dim(list, 1));",
        &["8,3"],
    );
}

#[test]
fn functions_recurse_and_nest_in_expressions() {
    let data = "FUNC num fact(num n)\nIF n <= 1 RETURN 1;\nRETURN n * fact(n - 1);\nENDFUNC";
    check(data, "TPWrite ValToStr(fact(5) + fact(3));", &["126"]);
}

#[test]
fn endless_recursion_is_an_error_of_the_program() {
    let out = output(
        "PROC r()\nr;\nENDPROC",
        "r;\nERROR\nIF ERRNO = ERR_RECURSION TPWrite \"caught\";\nTRYNEXT;",
    );
    assert_eq!(out, ["caught"]);
}

#[test]
fn retry_repeats_and_is_limited() {
    let data = "VAR num tries;\nPROC work()\ntries := tries + 1;\nIF tries < 4 RAISE 7;\nTPWrite \"done\" \\Num:=tries;\nENDPROC\nPROC never()\nRAISE 8;\nENDPROC";
    check(data, "work;\nERROR\nIF ERRNO = 7 RETRY;", &["done4"]);
    let out = output(data, "never;\nERROR\nRETRY;");
    assert!(
        out[0].contains("ERR_EXCRTYMAX") && out[0].contains("retried 4 times"),
        "{out:?}"
    );
}

#[test]
fn trynext_goes_on_behind_the_whole_statement() {
    check(
        "VAR num a{2};\nVAR num i := 5;",
        "IF a{i} = 0 THEN\nTPWrite \"inside\";\nENDIF\nTPWrite \"behind\";\nERROR\nIF ERRNO = ERR_OUTOFBND TRYNEXT;",
        &["behind"],
    );
}

#[test]
fn raise_and_the_end_of_a_handler_go_to_the_caller() {
    let data = "PROC inner()\nRAISE 5;\nERROR\nTPWrite \"inner\";\nRAISE;\nENDPROC\nPROC silent()\nRAISE 6;\nERROR\nTPWrite \"silent\";\nENDPROC\nPROC outer()\ninner;\nENDPROC";
    check(
        data,
        "outer; silent; TPWrite \"end\";\nERROR\nTPWrite \"main\" \\Num:=ERRNO;\nTRYNEXT;",
        &["inner", "main5", "silent", "main6", "end"],
    );
}

#[test]
fn return_in_a_handler_gives_the_function_value() {
    let data = "FUNC num ratio(num a, num b)\nRETURN a / b;\nERROR\nIF ERRNO = ERR_DIVZERO RETURN -1;\nENDFUNC";
    check(
        data,
        "TPWrite ValToStr(ratio(6, 3)) + ValToStr(ratio(1, 0));",
        &["2-1"],
    );
}

#[test]
fn handler_with_numbers_takes_only_these() {
    let data =
        "PROC a(num n)\nRAISE n;\nERROR (3, ERR_DIVZERO)\nTPWrite \"three\";\nRETURN;\nENDPROC";
    check(
        data,
        "a 3; a 4;\nERROR\nTPWrite \"other\" \\Num:=ERRNO;\nTRYNEXT;",
        &["three", "other4"],
    );
}

#[test]
fn an_unhandled_error_names_the_places() {
    let mut system = FakeSystem::default();
    let mut machine = machine(
        "MODULE cell\nPROC p()\n  VAR num z;\n  z := 1 / z;\nENDPROC\nPROC main()\n  p;\nENDPROC\nENDMODULE",
    );
    let Step::Failed(error) = run(&mut machine, &mut system) else {
        panic!("it fails")
    };
    assert_eq!(error.name, "ERR_DIVZERO");
    let places: Vec<_> = error
        .call_stack
        .iter()
        .map(|l| format!("{}/{}:{}", l.module, l.routine, l.line))
        .collect();
    assert_eq!(places, ["cell/p:4", "cell/main:7"]);
}

#[test]
fn strings_hold_80_characters() {
    let data = "VAR string s := \"0123456789012345678901234567890123456789\";";
    check(
        data,
        "s := s + s; TPWrite ValToStr(StrLen(s)); s := s + \"x\";\nERROR\nIF ERRNO = ERR_STRTOOLNG TPWrite \"too long\";\nTRYNEXT;",
        &["80", "too long"],
    );
}

#[test]
fn string_functions() {
    check(
        "",
        "TPWrite StrPart(\"Robotics\",1,5); TPWrite ValToStr(StrFind(\"Robotics\",1,\"aeiou\")); TPWrite ValToStr(StrMatch(\"Robotics\",1,\"bo\")); TPWrite ValToStr(StrMatch(\"Robotics\",1,\"x\"));",
        &["Robot", "2", "3", "9"],
    );
    check(
        "VAR num n;\nVAR pos p;\nVAR bool ok;",
        "ok := StrToVal(\" 3.5 \", n); TPWrite \"\" \\Num:=n; ok := StrToVal(\"[1,2,3]\", p); TPWrite \"\" \\Pos:=p; ok := StrToVal(\"x\", n); TPWrite \"\" \\Bool:=ok;",
        &["3.5", "[1,2,3]", "FALSE"],
    );
    check(
        "",
        "TPWrite NumToStr(0.38521, 3); TPWrite NumToStr(0.38521,2\\Exp); TPWrite ValToStr(1234567.0); TPWrite ValToStr(0.000001);",
        &["0.385", "3.85E-01", "1.23457E+06", "1E-06"],
    );
    check(
        "",
        "TPWrite \"a \"\"quote\"\" \\\\ \\41\";",
        &["a \"quote\" \\ A"],
    );
}

#[test]
fn rawbytes_in_both_orders() {
    let data = "VAR rawbytes r;\nVAR num a;\nVAR num b;\nVAR num f;\nVAR string s;";
    let pack = "PackRawBytes 258, r, 1 \\IntX:=UINT;\nPackRawBytes 258, r \\Network, 3 \\IntX:=UINT;\nPackRawBytes -2, r, RawBytesLen(r)+1 \\IntX:=DINT;\nPackRawBytes 1.5, r \\Network, RawBytesLen(r)+1 \\Float4;\nPackRawBytes \"Hi\", r, RawBytesLen(r)+1 \\ASCII;";
    let mut system = FakeSystem::default();
    let text = format!(
        "MODULE m\n{data}\nPROC main()\n{pack}\nUnpackRawBytes r, 1, a \\IntX:=UINT;\nUnpackRawBytes r, 5, b \\IntX:=DINT;\nUnpackRawBytes r \\Network, 9, f \\Float4;\nUnpackRawBytes r, 13, s \\ASCII:=2;\nENDPROC\nENDMODULE"
    );
    let mut machine = machine(&text);
    assert_eq!(run(&mut machine, &mut system), Step::Finished);
    let Value::Raw(raw) = global(&machine, "r") else {
        panic!("rawbytes")
    };
    assert_eq!(
        raw.as_slice(),
        [
            2, 1, 1, 2, 0xFE, 0xFF, 0xFF, 0xFF, 0x3F, 0xC0, 0, 0, b'H', b'i'
        ]
    );
    assert_eq!(global(&machine, "a"), Value::Num(258.0));
    assert_eq!(global(&machine, "b"), Value::Num(-2.0));
    assert_eq!(global(&machine, "f"), Value::Num(1.5));
    assert_eq!(global(&machine, "s"), Value::Str("Hi".into()));
}

#[test]
fn dnum_literals_and_large_integers() {
    check(
        "VAR rawbytes r;\nVAR dnum d;",
        "PackRawBytes 4294967295, r, 1 \\IntX:=UDINT; UnpackRawBytes r, 1, d \\IntX:=UDINT; TPWrite \"\" \\Dnum:=d;",
        &["4294967295"],
    );
}

#[test]
fn orientations_agree_with_nalgebra() {
    use depal_frames::nalgebra::UnitQuaternion;
    for [z, y, x] in [[30.0, -20.0, 110.0], [-170.0, 60.0, 5.0], [0.0, 0.0, 180.0]] {
        let text = format!(
            "MODULE m\nVAR orient o;\nVAR num a{{3}};\nVAR pose p;\nVAR robtarget t;\nPROC main()\nVAR orient o2;\no := OrientZYX({z}, {y}, {x});\na := [EulerZYX(\\Z,o), EulerZYX(\\Y,o), EulerZYX(\\X,o)];\np := PoseMult([[1,2,3],o], PoseInv([[1,2,3],o]));\nt.trans := [10,20,30]; t.rot := o;\nt := RelTool(t, 1, 2, 3 \\Rz:=90);\nENDPROC\nENDMODULE"
        );
        let mut machine = machine(&text);
        assert_eq!(
            run(&mut machine, &mut FakeSystem::default()),
            Step::Finished
        );
        let numbers = |value: &Value| -> Vec<f64> {
            match value {
                Value::Record(v) | Value::Array(v) => {
                    v.iter().filter_map(Value::as_number).collect()
                }
                _ => panic!("numbers"),
            }
        };
        let expected = UnitQuaternion::from_euler_angles(
            f64::to_radians(x),
            f64::to_radians(y),
            f64::to_radians(z),
        );
        let q = numbers(&global(&machine, "o"));
        let sign = expected.w.signum();
        let wanted = [expected.w, expected.i, expected.j, expected.k].map(|v| v * sign);
        for (a, b) in q.iter().zip(wanted) {
            assert!(
                (a - b).abs() < 1e-6 || (a + b).abs() < 1e-6,
                "{q:?} {wanted:?}"
            );
        }
        let angles = numbers(&global(&machine, "a"));
        for (a, b) in angles.iter().zip([z, y, x]) {
            let difference = (a - b + 540.0).rem_euclid(360.0) - 180.0;
            assert!(difference.abs() < 1e-3, "{angles:?}");
        }
        let Value::Record(pose) = global(&machine, "p") else {
            panic!("pose")
        };
        assert!(numbers(&pose[0]).iter().all(|v| v.abs() < 1e-4));
        let Value::Record(target) = global(&machine, "t") else {
            panic!("robtarget")
        };
        let moved = expected * depal_frames::Vector::new(1.0, 2.0, 3.0)
            + depal_frames::Vector::new(10.0, 20.0, 30.0);
        for (a, b) in numbers(&target[0]).iter().zip(moved.iter()) {
            assert!((a - b).abs() < 1e-4);
        }
    }
}

#[test]
fn arrays_of_records_and_three_dimensions() {
    check(
        "VAR num c{2,2,2} := [[[1,2],[3,4]],[[5,6],[7,8]]];\nVAR robtarget way{2};\nVAR pos one := [1,1,1];",
        "c{2,1,2} := 60; way{2}.trans := [1,2,3]; way{1} := Offs(way{2}, 0, 0, 5);\nTPWrite ValToStr(c); TPWrite ValToStr(way{1}.trans + one * 2);",
        &["[[[1,2],[3,4]],[[5,60],[7,8]]]", "[3,4,10]"],
    );
}

#[test]
fn a_machine_cloned_in_a_wait_ends_as_the_original() {
    let text = "MODULE m\nVAR num n;\nPROC main()\nFOR i FROM 1 TO 5 DO WaitTime 0.5; n := n + i; ENDFOR\nTPWrite ValToStr(n);\nENDPROC\nENDMODULE";
    let mut original = machine(text);
    let mut system = FakeSystem::default();
    for _ in 0..300 {
        if original.step(&mut system) == Step::Blocked {
            system.now += depal_time::TICK;
        }
    }
    let mut copy = original.clone();
    let mut second = FakeSystem {
        now: system.now,
        ..FakeSystem::default()
    };
    assert_eq!(run(&mut original, &mut system), run(&mut copy, &mut second));
    assert_eq!((system.trace, system.now), (second.trace, second.now));
}

#[test]
fn exit_cycle_begins_anew_and_keeps_module_data() {
    check(
        "VAR num n;",
        "n := n + 1; TPWrite ValToStr(n); IF n < 3 ExitCycle; TPWrite \"end\";",
        &["1", "2", "3", "end"],
    );
}
