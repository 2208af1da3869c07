//! A statement costs 20 us, of whatever kind it is.

use depal_controller::ControllerEvent;

use crate::harness::*;

/// Microseconds between the two lines that a program writes.
fn between(statements: &str, more: &str) -> f64 {
    let text = format!("TPWrite \"a\";\n{statements}\nTPWrite \"b\";");
    let told = run_with(&text, more, &[]).finished();
    let at: Vec<f64> = told
        .events
        .iter()
        .filter_map(|event| match event {
            ControllerEvent::Log { at, .. } => Some(at.as_nanos() as f64 / 1e3),
            _ => None,
        })
        .collect();
    assert_eq!(at.len(), 2);
    at[1] - at[0]
}

#[test]
fn a_statement_costs_20_us() {
    let more = "VAR num x;\nVAR string s;\nPROC empty()\nENDPROC\nPROC one()\nx := 1;\nENDPROC\nFUNC num two(num a)\nx := x + a;\nRETURN x;\nENDFUNC";
    // The write itself is the first of each.
    for (statements, count) in [
        ("", 1),
        ("x := 1;", 2),
        ("s := \"a\" + s;", 2),
        ("SetDO do1, 1;", 2),
        ("p0 := Offs(p0,1,2,3);", 2),
        ("empty;", 2),
        ("one;", 3),
        ("x := two(1) + two(2);", 6),
        ("%\"one\"%;", 3),
        // The loop begins and looks at its bounds in one; then each round is one with its body and one at its end.
        ("FOR i FROM 1 TO 1000 DO\nx := i;\nENDFOR", 2 + 1000 + 1000),
        ("IF x = 0 THEN\nx := 1;\nENDIF", 3),
    ] {
        let us = between(statements, more);
        assert!(
            (us - 20.0 * f64::from(count)).abs() < 1e-6,
            "{statements}: {us} us"
        );
    }
}
