//! ErrLog, ErrRaise, IError and what a TRAP reads of the message: one rule each.

use crate::fake_system::output;

#[track_caller]
fn check(data: &str, statements: &str, expected: &[&str]) {
    assert_eq!(output(data, statements), expected, "{data}\n{statements}");
}

#[test]
fn a_message_is_its_number_and_its_arguments() {
    check(
        "CONST errstr what := \"battery\";",
        "ErrLog 5210\\W, what, ERRSTR_TASK, ERRSTR_UNUSED, \"low\", ERRSTR_EMPTY; ErrLog 4800, ERRSTR_CONTEXT, \"\", \"\", \"\", \"\";",
        &[
            "log: warning: 115210: battery T_ROB1 low",
            "log: error: 114800: m/main/4",
        ],
    );
    let out = output("", "ErrLog 12, \"\", \"\", \"\", \"\", \"\";");
    assert!(out[0].contains("5000 to 9999"), "{out:?}");
}

const BATTERY: &str = "VAR errnum ERR_BATT := -1;\nPROC p()\nErrRaise \"ERR_BATT\", 7055, \"a\", \"\", \"\", \"\", \"\";\nTPWrite \"never\";\nENDPROC";

#[test]
fn a_raised_error_has_the_booked_number_and_leaves_a_warning() {
    check(
        BATTERY,
        "BookErrNo ERR_BATT; p;\nERROR\nIF ERRNO = ERR_BATT TPWrite \"battery\";\nTRYNEXT;",
        &["log: warning: 117055: a", "battery"],
    );
    // Without a number of its own there is nothing to raise.
    check(
        BATTERY,
        "p;\nERROR\nIF ERRNO = ERR_ARGVALERR TPWrite \"not booked\";\nTRYNEXT;",
        &["not booked"],
    );
    let unknown = BATTERY.replace("\"ERR_BATT\"", "\"ERR_BAT\"");
    let out = output(&unknown, "BookErrNo ERR_BATT; p;");
    assert!(out[0].contains("no module data ERR_BAT"), "{out:?}");
}

#[test]
fn raised_inside_a_handler_it_goes_to_the_caller() {
    let data = format!("{BATTERY}\nPROC q()\nRAISE 5;\nERROR\np;\nENDPROC");
    // A handler that raises by itself, not by a routine it calls.
    let data = data.replace(
        "ERROR\np;",
        "ERROR\nErrRaise \"ERR_BATT\", 7055, \"b\", \"\", \"\", \"\", \"\";",
    );
    check(
        &data,
        "BookErrNo ERR_BATT; q;\nERROR\nIF ERRNO = ERR_BATT TPWrite \"caller\";\nTRYNEXT;",
        &["log: warning: 117055: b", "caller"],
    );
}

#[test]
fn an_unhandled_one_names_the_error_as_the_program_does() {
    let out = output(BATTERY, "BookErrNo ERR_BATT; p;");
    assert!(
        out[1].contains("ERR_BATT") && out[1].contains("117055"),
        "{out:?}"
    );
}

const TRAP: &str = "VAR intnum i;\nVAR trapdata seen;\nVAR errdomain domain;\nVAR num id;\nVAR errtype kind;\nVAR string title;\nVAR string text;\nTRAP t\nGetTrapData seen;\nReadErrData seen, domain, id, kind \\Title:=title \\Str1:=text;\nTPWrite ValToStr(domain) + \" \" + ValToStr(id) + \" \" + ValToStr(kind) + \" \" + title + text;\nENDTRAP";

/// What the trap read.
fn read(order: &str, messages: &str) -> Vec<String> {
    let out = output(
        TRAP,
        &format!("CONNECT i WITH t; {order} {messages} WaitTime 0.1;"),
    );
    out.into_iter().filter(|l| !l.starts_with("log:")).collect()
}

#[test]
fn each_message_orders_the_interrupt_with_its_own_data() {
    let messages = "IDisable; ErrWrite \"head\", \"reason\"; ErrWrite\\W, \"two\", \"!\"; ErrLog 5001\\I, \"five\", \"\", \"\", \"\", \"\"; IEnable;";
    assert_eq!(
        read("IError COMMON_ERR, TYPE_ALL, i;", messages),
        ["8 1 3 headreason", "8 2 2 two!", "11 5001 1 five"]
    );
}

#[test]
fn domain_number_and_type_choose() {
    let messages = "ErrWrite \"head\", \"reason\"; ErrWrite\\W, \"two\", \"!\"; ErrLog 5001\\I, \"five\", \"\", \"\", \"\", \"\";";
    for (order, expected) in [
        (
            "IError USER_DEF_ERR, TYPE_ALL, i;",
            vec!["8 1 3 headreason", "8 2 2 two!"],
        ),
        ("IError COMMON_ERR, TYPE_WARN, i;", vec!["8 2 2 two!"]),
        (
            "IError PROCESS_ERR \\ErrorId:=5001, TYPE_ALL, i;",
            vec!["11 5001 1 five"],
        ),
        ("IError PROCESS_ERR \\ErrorId:=5002, TYPE_ALL, i;", vec![]),
        ("IError MOTION_ERR, TYPE_ALL, i;", vec![]),
        ("IError COMMON_ERR, TYPE_ALL, i; ISleep i;", vec![]),
        ("IError COMMON_ERR, TYPE_ALL, i; IDelete i;", vec![]),
    ] {
        assert_eq!(read(order, messages), expected, "{order}");
    }
}

#[test]
fn trap_data_belong_into_the_trap_and_are_taken_first() {
    let out = output("VAR trapdata seen;", "GetTrapData seen;");
    assert!(
        out[0].contains("TRAP of an interrupt that IError"),
        "{out:?}"
    );
    let out = output(TRAP, "ReadErrData seen, domain, id, kind;");
    assert!(out[0].contains("GetTrapData"), "{out:?}");
}
