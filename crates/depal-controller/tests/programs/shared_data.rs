//! Persistent data of several tasks: what is one datum, and with which value it begins.

use crate::tasks::{module, run, warnings};

#[test]
fn a_persistent_of_one_name_and_type_is_one_datum() {
    let told = run(
        module(
            "a",
            "PERS num count := 0;\nPERS bool ready := FALSE;",
            "count := 5;\nWaitUntil ready;\nTPWrite \"got \"\\Num:=count;",
        ),
        module(
            "b",
            "PERS num COUNT;\nPERS bool ready;",
            "WaitUntil count = 5;\nWaitTime 0.1;\ncount := count * 2;\nready := TRUE;",
        ),
    )
    .finished();
    assert_eq!(told.lines, ["got 10"]);
    assert!(warnings(&told).is_empty());
}

#[test]
fn records_and_arrays_are_shared_whole_and_by_parts() {
    let data = "RECORD part num id; pos at; ENDRECORD\nPERS part parts{2} := [[1,[0,0,0]],[2,[0,0,0]]];\nPERS num phase := 0;";
    let told = run(
        module(
            "a",
            data,
            "parts{2}.at.y := 7;\nphase := 1;\nWaitUntil phase = 2;\nTPWrite ValToStr(parts{1});",
        ),
        module(
            "b",
            data,
            "WaitUntil phase = 1;\nparts{1} := parts{2};\nIncr phase;",
        ),
    )
    .finished();
    assert_eq!(told.lines, ["[2,[0,7,0]]"]);
}

/// The counterpart of the first test: what is not common stays with its task.
#[test]
fn local_and_task_persistents_and_variables_are_not_shared() {
    for (first, second) in [
        ("LOCAL PERS num x := 1;", "PERS num x := 2;"),
        ("TASK PERS num x := 1;", "TASK PERS num x := 2;"),
        ("VAR num x := 1;", "PERS num x := 2;"),
    ] {
        let told = run(
            module("a", first, "WaitTime 0.5;\nTPWrite \"x \"\\Num:=x;"),
            module("b", second, "x := 7;"),
        )
        .finished();
        assert_eq!(told.lines, ["x 1"], "{first}");
        assert!(warnings(&told).is_empty());
    }
}

#[test]
fn the_initial_value_loaded_first_counts() {
    let read = "WaitTime 0.1;\nTPWrite GetTaskName()+\" \"\\Num:=x;";
    let told = run(
        module("a", "PERS num x := 3;", read),
        module("b", "PERS num x := 4;", read),
    )
    .finished();
    assert_eq!(told.lines, ["T_ROB1 3", "T_SIDE 3"]);
    let told_warnings = warnings(&told);
    assert_eq!(told_warnings.len(), 1, "{told_warnings:?}");
    assert!(told_warnings[0].contains("x has another initial value in task T_SIDE"));
    // Without a value in the first task that of the second counts, and nothing is odd about it.
    let told = run(
        module("a", "PERS num x;", read),
        module("b", "PERS num x := 4;", read),
    )
    .finished();
    assert_eq!(told.lines, ["T_ROB1 4", "T_SIDE 4"]);
    assert!(warnings(&told).is_empty());
    // Two types are two data.
    let told = run(
        module("a", "PERS num x := 3;", read),
        module("b", "PERS bool x := TRUE;", "x := FALSE;"),
    )
    .finished();
    assert_eq!(told.lines, ["T_ROB1 3"]);
    assert!(warnings(&told)[0].contains("x is bool in task T_SIDE and num in task T_ROB1"));
}
