//! Interrupts: when they come, which goes first, and what becomes of the path.

use depal_time::SimTime;

use crate::fake_system::*;

fn run_with(changes: &[(u64, &str, f64)], source: &str) -> Vec<String> {
    let mut system = FakeSystem::default();
    for (when, name, value) in changes {
        let at = SimTime::from_nanos(when * 1_000_000);
        system.changes.push((at, (*name).into(), *value));
    }
    let mut machine = machine(&[("main.src", source), ("main.dat", DATA)]);
    let end = run(&mut machine, &mut system);
    if end != depal_vm::execution::Step::Finished {
        system.trace.push(format!("{end:?}"));
    }
    system.trace
}

const DATA: &str = "DEFDAT main\nDECL INT n=0\nENDDAT";

/// A program that waits, with a routine for an interrupt.
fn waiting(before: &str, routine: &str) -> String {
    format!(
        "DEF main( )\nINTERRUPT DECL 5 WHEN $IN[1] DO react( )\n{before}\nWAIT SEC 0.2\nMsgNotify(\"end %1\", n)\nEND\nDEF react( )\n{routine}\nEND\n"
    )
}

#[test]
fn the_routine_runs_when_the_condition_comes_true() {
    let source = waiting("INTERRUPT ON 5", "n = n + 1");
    assert_eq!(run_with(&[(50, "$IN[1]", 1.0)], &source), ["end 1"]);
    // Again only after it was false.
    let changes = [
        (50, "$IN[1]", 1.0),
        (90, "$IN[1]", 0.0),
        (120, "$IN[1]", 1.0),
    ];
    assert_eq!(run_with(&changes, &source), ["end 2"]);
}

#[test]
fn what_is_true_already_is_no_change() {
    let source = waiting("WAIT SEC 0.1\nINTERRUPT ON 5", "n = n + 1");
    assert_eq!(run_with(&[(50, "$IN[1]", 1.0)], &source), ["end 0"]);
}

#[test]
fn off_forgets_and_disable_keeps() {
    let off = waiting(
        "INTERRUPT ON 5\nINTERRUPT OFF 5\nWAIT SEC 0.1\nINTERRUPT ON 5",
        "n = n + 1",
    );
    let changes = [(50, "$IN[1]", 1.0)];
    assert_eq!(run_with(&changes, &off), ["end 0"]);
    let held = waiting(
        "INTERRUPT ON 5\nINTERRUPT DISABLE 5\nWAIT SEC 0.1\nMsgNotify(\"%1\", n)\nINTERRUPT ENABLE 5",
        "n = n + 1",
    );
    assert_eq!(run_with(&changes, &held), ["0", "end 1"]);
}

#[test]
fn the_smaller_number_goes_first_and_interrupts_the_greater() {
    let source = "DEF main( )\nINTERRUPT DECL 5 WHEN $IN[1] DO slow( )\nINTERRUPT DECL 3 WHEN $IN[2] DO fast( )\nINTERRUPT DECL 9 WHEN $IN[3] DO later( )\nINTERRUPT ON\nWAIT SEC 0.3\nEND\nDEF slow( )\nMsgNotify(\"slow\")\nWAIT SEC 0.1\nMsgNotify(\"slow ends\")\nEND\nDEF fast( )\nMsgNotify(\"fast\")\nEND\nDEF later( )\nMsgNotify(\"later\")\nEND";
    let changes = [
        (20, "$IN[1]", 1.0),
        (50, "$IN[2]", 1.0),
        (60, "$IN[3]", 1.0),
    ];
    assert_eq!(
        run_with(&changes, source),
        ["slow", "fast", "slow ends", "later"]
    );
}

#[test]
fn an_interrupt_is_forgotten_with_the_routine_that_declared_it() {
    let source = "DEF main( )\nsub( )\nWAIT SEC 0.2\nMsgNotify(\"end %1\", n)\nEND\nDEF sub( )\nINTERRUPT DECL 5 WHEN $IN[1] DO react( )\nINTERRUPT ON 5\nEND\nDEF react( )\nn = n + 1\nEND";
    let changes = [(50, "$IN[1]", 1.0)];
    assert_eq!(run_with(&changes, source), ["end 0"]);
    let global = source.replace("INTERRUPT DECL", "GLOBAL INTERRUPT DECL");
    assert_eq!(run_with(&changes, &global), ["end 1"]);
}

#[test]
fn brake_holds_the_arm_until_the_routine_ends() {
    let source = "DEF main( )\nINTERRUPT DECL 5 WHEN $IN[1] DO react( )\nINTERRUPT ON 5\nPTP {A1 1}\nEND\nDEF react( )\nBRAKE\nWAIT SEC 0.1\nEND";
    let trace = run_with(&[(50, "$IN[1]", 1.0)], source);
    assert!(
        trace[1].starts_with("0.05") && trace[1].ends_with("hold"),
        "{trace:?}"
    );
    assert!(
        trace[2].starts_with("0.15") && trace[2].ends_with("go on"),
        "{trace:?}"
    );
}

#[test]
fn moves_of_the_routine_put_the_path_aside() {
    let source = "DEF main( )\nINTERRUPT DECL 5 WHEN $IN[1] DO react( )\nINTERRUPT ON 5\nPTP {A1 1}\nEND\nDEF react( )\nBRAKE\nPTP {A1 5}\nEND";
    let trace = run_with(&[(50, "$IN[1]", 1.0)], source);
    let words: Vec<_> = trace
        .iter()
        .map(|l| l.split(' ').nth(1).unwrap_or(""))
        .collect();
    assert_eq!(
        words,
        ["line", "hold", "store", "line", "restore", "go"],
        "{trace:?}"
    );
}

#[test]
fn resume_leaves_the_routine_that_was_called_and_drops_its_path() {
    let source = "DEF main( )\nINTERRUPT DECL 5 WHEN $IN[1] DO found( )\nINTERRUPT ON 5\nsearch( )\nINTERRUPT OFF 5\nMsgNotify(\"after %1\", n)\nPTP {A1 9}\nEND\nDEF search( )\nPTP {A1 1}\nPTP {A1 2}\nWAIT SEC 0\nMsgNotify(\"not found\")\nEND\nDEF found( )\nBRAKE\nn = 1\nRESUME\nn = 2\nEND";
    let trace = run_with(&[(50, "$IN[1]", 1.0)], source);
    let short: Vec<_> = trace
        .iter()
        .map(|l| l.split(' ').nth(1).unwrap_or(""))
        .collect();
    assert_eq!(
        short,
        ["line", "line", "hold", "clear", "go", "1", "line"],
        "{trace:?}"
    );
    assert_eq!(trace[5], "after 1");
    assert_eq!(
        run_with(&[], source)
            .iter()
            .filter(|l| *l == "not found")
            .count(),
        1
    );
}

#[test]
fn a_condition_that_cannot_be_computed_stops_the_program_at_its_declaration() {
    let source = "DEF main( )\nINTERRUPT DECL 5 WHEN k == 1 DO react( )\nINTERRUPT ON 5\nWAIT SEC 0.1\nEND\nDEF react( )\nEND";
    let files = [
        ("main.src", source),
        ("main.dat", "DEFDAT main\nDECL INT k\nENDDAT"),
    ];
    let trace = run_files(&files);
    assert_eq!(trace, ["main/react:2: k has no value yet"]);
}

#[test]
fn an_error_in_the_routine_stops_the_program() {
    let source = waiting("INTERRUPT ON 5", "n = 1 / n");
    let trace = run_with(&[(50, "$IN[1]", 1.0)], &source);
    assert!(trace[0].contains("division by zero"), "{trace:?}");
}

#[test]
fn a_condition_without_an_end_is_told() {
    let source = "DEF main( )\nINTERRUPT DECL 5 WHEN ever( ) DO main( )\nINTERRUPT ON 5\nWAIT SEC 0.1\nEND\nDEFFCT BOOL ever( )\nLOOP\nENDLOOP\nRETURN TRUE\nENDFCT";
    let trace = run_files(&[("main.src", source)]);
    assert!(trace[0].contains("takes too long"), "{trace:?}");
}
