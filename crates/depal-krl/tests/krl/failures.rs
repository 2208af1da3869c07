//! Errors that stop a program: what they say and where.

use depal_vm::execution::Step;

use crate::fake_system::*;

#[track_caller]
fn fails(declarations: &str, statements: &str, expected: &str) {
    let trace = output(declarations, statements);
    assert_eq!(trace, [expected]);
}

#[test]
fn a_variable_without_a_value() {
    fails(
        "DECL INT i, k",
        "i = k + 1",
        "main/main:3: k has no value yet",
    );
    fails(
        "DECL INT a[3]",
        "a[1] = a[2]",
        "main/main:3: a[2] has no value yet",
    );
    fails(
        "DECL E6POS p",
        "p.X = p.Y",
        "main/main:3: p.Y has no value yet",
    );
    fails("DECL E6POS p", "LIN p", "main/main:3: p has no value yet");
}

#[test]
fn an_index_outside_the_array() {
    fails(
        "DECL INT a[10]",
        "a[11] = 1",
        "main/main:3: array index 11 is outside 1..10 (dimension 1)",
    );
    fails(
        "DECL INT a[10], i",
        "i = 0\na[i] = 1",
        "main/main:4: array index 0 is outside 1..10 (dimension 1)",
    );
}

#[test]
fn division_by_zero() {
    fails(
        "DECL INT i",
        "i = 0\ni = 1 / i",
        "main/main:4: division by zero",
    );
    fails(
        "DECL REAL r",
        "r = 0.0\nr = 1.0 / r",
        "main/main:4: division by zero",
    );
}

#[test]
fn integers_have_32_bits() {
    fails(
        "DECL INT i",
        "i = 2147483647\ni = i + 1",
        "main/main:4: the integer result 2147483648 is outside -2147483648..2147483647",
    );
    fails(
        "DECL INT i",
        "i = 3.0e9",
        "main/main:3: the integer result 3000000000 is outside -2147483648..2147483647",
    );
    assert_eq!(shown("DECL INT i", "i = -2147483648", "i"), "-2147483648");
}

#[test]
fn a_step_of_zero() {
    fails(
        "DECL INT i, s",
        "s = 0\nFOR i = 1 TO 2 STEP s\nENDFOR",
        "main/main:4: the step of a FOR loop is 0",
    );
}

#[test]
fn a_function_without_return() {
    let source = "DEF main( )\nDECL INT i\ni = f(0)\nEND\nDEFFCT INT f(a:IN)\nDECL INT a\nIF a == 1 THEN\nRETURN 1\nENDIF\nENDFCT";
    let trace = run_files(&[("main.src", source)]);
    assert!(
        trace[0].contains("function f ended without RETURN"),
        "{trace:?}"
    );
}

#[test]
fn endless_recursion() {
    let source = "DEF main( )\nmain( )\nEND";
    let trace = run_files(&[("main.src", source)]);
    assert_eq!(
        trace,
        ["main/main:2: more than 200 routine calls inside each other"]
    );
}

#[test]
fn a_target_out_of_reach_is_told_at_its_line() {
    let mut system = FakeSystem {
        refuse_move: Some(0),
        ..FakeSystem::default()
    };
    let mut machine = machine(&[("main.src", "DEF main( )\n\nPTP XHOME\nEND")]);
    let Step::Failed(error) = run(&mut machine, &mut system) else {
        panic!("fails");
    };
    assert!(
        error
            .report(system.now)
            .starts_with("main/main:3: out of reach: the wrist"),
        "{error:?}"
    );
}

#[test]
fn halt_stops_and_goes_no_further() {
    let trace = output("", "MsgNotify(\"a\")\nHALT\nMsgNotify(\"b\")");
    assert_eq!(trace, ["a", "Stopped(\"HALT\")"]);
}
