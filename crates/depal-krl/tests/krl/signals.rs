//! Inputs, outputs, timers, waits.

use depal_krl::{check_with_signals, load, load_with_any_signals};
use depal_time::SimTime;

use crate::fake_system::*;

fn at(milliseconds: u64) -> SimTime {
    SimTime::from_nanos(milliseconds * 1_000_000)
}

fn run_with(changes: &[(u64, &str, f64)], source: &str) -> Vec<String> {
    let mut system = FakeSystem::default();
    for (when, name, value) in changes {
        system.changes.push((at(*when), (*name).into(), *value));
    }
    let mut machine = machine(&[("main.src", source)]);
    run(&mut machine, &mut system);
    system.trace
}

#[test]
fn outputs_are_set_and_read_back() {
    let trace = output(
        "DECL BOOL b",
        "$OUT[3] = TRUE\nb = $OUT[3]\nMsgNotify(\"%1\", b)",
    );
    assert_eq!(trace, ["0.000 $OUT[3] = 1", "TRUE"]);
}

#[test]
fn a_signal_names_one_or_several() {
    let data = "SIGNAL pump $OUT[1]\nSIGNAL zone $OUT[2] TO $OUT[5]\nDECL INT n";
    let trace = output(
        data,
        "pump = TRUE\nzone = 10\nn = zone\nMsgNotify(\"%1\", n)",
    );
    assert_eq!(
        trace,
        [
            "0.000 $OUT[1] = 1",
            "0.000 $OUT[2] = 0",
            "0.000 $OUT[3] = 1",
            "0.000 $OUT[4] = 0",
            "0.000 $OUT[5] = 1",
            "10"
        ]
    );
    assert_eq!(
        output(data, "zone = 16"),
        ["main/main:5: 16 does not fit into the 4 outputs $OUT[2] to $OUT[5]: 0 to 15"]
    );
}

#[test]
fn wait_for_asks_until_it_is_so() {
    let source = main_of(
        "",
        "WAIT FOR ($IN[1] == TRUE) AND NOT $IN[2]\n$OUT[1] = TRUE",
    );
    let trace = run_with(&[(50, "$IN[1]", 1.0)], &source);
    assert_eq!(trace, ["0.052 $OUT[1] = 1"]);
    let trace = run_with(
        &[
            (10, "$IN[2]", 1.0),
            (50, "$IN[1]", 1.0),
            (90, "$IN[2]", 0.0),
        ],
        &source,
    );
    assert_eq!(trace, ["0.092 $OUT[1] = 1"]);
}

#[test]
fn wait_sec_takes_its_time() {
    let trace = output("", "WAIT SEC 0.5\n$OUT[1] = TRUE");
    assert_eq!(trace, ["0.500 $OUT[1] = 1"]);
}

#[test]
fn timers_count_milliseconds_while_they_run() {
    let text =
        "$TIMER[1] = -100\n$TIMER_STOP[1] = FALSE\nWAIT SEC 0.2\n$TIMER_STOP[1] = TRUE\nWAIT SEC 1";
    // A wait ends with a tick of 4 ms.
    assert_eq!(shown("", text, "$TIMER[1]"), "104");
    assert_eq!(
        shown("DECL BOOL b", &format!("{text}\nb = $TIMER_FLAG[1]"), "b"),
        "TRUE"
    );
    assert_eq!(
        shown("DECL BOOL b", "$TIMER[2] = -5\nb = $TIMER_FLAG[2]", "b"),
        "FALSE"
    );
}

#[test]
fn flags_are_kept_and_begin_as_false() {
    assert_eq!(shown("DECL BOOL b", "b = $FLAG[7]", "b"), "FALSE");
    assert_eq!(
        shown("DECL BOOL b", "$FLAG[873] = TRUE\nb = $FLAG[873]", "b"),
        "TRUE"
    );
}

#[test]
fn analogue_values() {
    let trace = output(
        "DECL REAL r",
        "$ANOUT[1] = 0.5\nr = $ANOUT[1] * 2\nMsgNotify(\"%1\", r)",
    );
    assert_eq!(trace, ["0.000 $ANOUT[1] = 0.5", "1"]);
}

#[test]
fn a_pulse_ends_by_itself() {
    let mut system = FakeSystem::default();
    let source = main_of("", "PULSE($OUT[4], TRUE, 0.3)\nWAIT SEC 0.2\nWAIT SEC 0.2");
    let mut machine = machine(&[("main.src", &source)]);
    run(&mut machine, &mut system);
    assert_eq!(system.signals["$OUT[4]"], 0.0);
    assert_eq!(system.trace, ["0.000 $OUT[4] = 1"]);
}

#[test]
fn signals_the_cabinet_lacks_are_errors_unless_any_is_there() {
    let files = sources(&[(
        "main.src",
        "DEF main( )\nDECL INT i\n$OUT[99] = TRUE\ni = 7\n$IN[i] = $IN[i]\nEND",
    )]);
    let text: Vec<_> = check_with_signals(&files, &signals())
        .diagnostics
        .iter()
        .map(|d| d.one_line(&files))
        .collect();
    assert_eq!(
        text,
        [
            "main.src:3:6: error[KRL0101]: the cabinet has no signal $OUT[99]",
            "main.src:5:1: error[KRL0109]: $IN can only be read"
        ]
    );
    let files = sources(&[(
        "main.src",
        "DEF main( )\nDECL INT i\nSIGNAL g $OUT[99] TO $OUT[100]\ni = 7\n$ANOUT[2] = 1.0\nIF $IN[i] THEN\ng = 1\nENDIF\nEND",
    )]);
    assert!(load(&files, &signals(), "main").program.is_none());
    let loaded = load_with_any_signals(&files, "main");
    assert!(loaded.program.is_some(), "{:?}", loaded.diagnostics);
}
