//! Interrupts, UNDO, calls by name, pulses: one rule each.

use depal_time::SimTime;
use depal_vm::execution::Step;

use crate::fake_system::{FakeSystem, machine, run};

fn seconds(at: f64) -> SimTime {
    SimTime::from_nanos((at * 1e9) as u64)
}

/// What the operator read, with inputs that change at these times.
fn shown(text: &str, changes: &[(f64, f64)]) -> (Vec<String>, Step) {
    let mut system = FakeSystem {
        changes: changes
            .iter()
            .map(|(at, value)| (seconds(*at), "di_part".to_owned(), *value))
            .collect(),
        ..FakeSystem::default()
    };
    let mut machine = machine(text);
    let end = run(&mut machine, &mut system);
    (system.trace, end)
}

const SIGNAL: &str = "MODULE m\n VAR intnum i;\n PROC main()\n  CONNECT i WITH t;\n  ISignalDI di_part, 1, i;\n  MARK\n  WaitTime 2;\n  TPWrite \"over\";\n ENDPROC\n TRAP t\n  TPWrite \"trap\";\n ENDTRAP\nENDMODULE\n";

#[test]
fn a_trap_runs_inside_a_wait_at_each_rising_edge() {
    let text = SIGNAL.replace("MARK", "");
    let edges = [(0.5, 1.0), (0.6, 0.0), (0.7, 1.0)];
    assert_eq!(shown(&text, &edges).0, ["trap", "trap", "over"]);
    // The counterfactual: no edge, no trap.
    assert_eq!(shown(&text, &[]).0, ["over"]);
    let single = text.replace("ISignalDI ", "ISignalDI \\Single, ");
    assert_eq!(shown(&single, &edges).0, ["trap", "over"]);
}

#[test]
fn a_sleeping_interrupt_is_lost_and_a_disabled_one_is_late() {
    let edges = [(0.5, 1.0)];
    let asleep = SIGNAL.replace("MARK", "ISleep i; WaitTime 1; IWatch i;");
    assert_eq!(shown(&asleep, &edges).0, ["over"]);
    let disabled = SIGNAL.replace("MARK", "IDisable; WaitTime 1; TPWrite \"late\"; IEnable;");
    assert_eq!(shown(&disabled, &edges).0, ["late", "trap", "over"]);
    let deleted = SIGNAL.replace("MARK", "IDelete i;");
    assert_eq!(shown(&deleted, &edges).0, ["over"]);
}

#[test]
fn traps_queue_and_do_not_nest() {
    let text = "MODULE m\n VAR intnum a;\n VAR intnum b;\n PERS num p := 0;\n PROC main()\n  CONNECT a WITH ta;\n  IPers p, a;\n  CONNECT b WITH tb;\n  ITimer \\Single, 0.1, b;\n  WaitTime 0.05;\n  p := 1;\n  WaitTime 1;\n ENDPROC\n TRAP ta\n  TPWrite \"a begins\";\n  WaitTime 0.3;\n  TPWrite \"a ends\";\n ENDTRAP\n TRAP tb\n  TPWrite \"b\";\n ENDTRAP\nENDMODULE\n";
    assert_eq!(shown(text, &[]).0, ["a begins", "a ends", "b"]);
}

#[test]
fn an_error_that_a_trap_does_not_handle_is_fatal() {
    let text = SIGNAL
        .replace("MARK", "")
        .replace("TPWrite \"trap\";", "RAISE 5;")
        .replace("TPWrite \"over\";", "TPWrite \"over\";\n ERROR\n  TRYNEXT;");
    let (lines, end) = shown(&text, &[(0.5, 1.0)]);
    assert!(lines.is_empty(), "{lines:?}");
    let Step::Failed(error) = end else {
        panic!("{end:?}")
    };
    assert_eq!(error.call_stack[0].routine, "t");
}

#[test]
fn undo_runs_on_the_way_to_a_handler_and_only_then() {
    let text = "MODULE m\n PROC main()\n  outer;\n  TPWrite \"end\";\n ENDPROC\n PROC outer()\n  inner;\n ERROR (LONG_JMP_ALL_ERR)\n  TPWrite \"caught\";\n  TRYNEXT;\n ENDPROC\n PROC inner()\n  MARK\n UNDO\n  TPWrite \"undo\";\n BACKWARD\n  TPWrite \"never\";\n ENDPROC\nENDMODULE\n";
    let raised = text.replace("MARK", "RAISE 7;");
    assert_eq!(shown(&raised, &[]).0, ["undo", "caught", "end"]);
    let quiet = text.replace("MARK", "TPWrite \"quiet\";");
    assert_eq!(shown(&quiet, &[]).0, ["quiet", "end"]);
}

#[test]
fn a_procedure_is_called_by_a_name_in_a_string() {
    let text = "MODULE m\n VAR num n;\n PROC main()\n  %\"W\" + \"orker\"% n, 4;\n  TPWrite \"n=\" \\Num:=n;\n  %\"nobody\"%;\n ERROR\n  IF ERRNO = ERR_REFUNKPRC THEN\n   TPWrite \"unknown\";\n   TRYNEXT;\n  ENDIF\n ENDPROC\n PROC worker(INOUT num a, num b \\num c)\n  IF NOT Present(c) a := b + 1;\n ENDPROC\nENDMODULE\n";
    assert_eq!(shown(text, &[]).0, ["n=5", "unknown"]);
}
