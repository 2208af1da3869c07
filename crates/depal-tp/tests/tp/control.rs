//! Jumps, loops, calls, waits: one rule each.

use crate::fake_system::*;
use depal_time::SimTime;

#[test]
fn labels_and_jumps() {
    assert_eq!(
        registers(&[
            "R[1]=0",
            "LBL[1:loop]",
            "R[1]=R[1]+1",
            "IF R[1]<5,JMP LBL[1]",
            "R[2]=R[1]"
        ]),
        "R[1]=5 R[2]=5"
    );
    assert_eq!(
        registers(&[
            "R[1]=3",
            "JMP LBL[R[1]]",
            "LBL[2]",
            "R[9]=2",
            "LBL[3]",
            "R[8]=1"
        ]),
        "R[1]=3 R[8]=1"
    );
    let end = lines(&["R[1]=4", "JMP LBL[R[1]]", "LBL[2]"]).end;
    assert_eq!(
        end,
        "MAIN/MAIN:2: INTP: Label not found: there is no LBL[4] in this program"
    );
}

#[test]
fn if_then_else() {
    for (value, expected) in [(1, "R[1]=1 R[2]=10"), (2, "R[1]=2 R[2]=20")] {
        let first = format!("R[1]={value}");
        let text = [
            first.as_str(),
            "IF (R[1]=1) THEN",
            "R[2]=10",
            "ELSE",
            "IF R[1]=2 THEN",
            "R[2]=20",
            "ENDIF",
            "ENDIF",
        ];
        assert_eq!(registers(&text), expected);
    }
}

#[test]
fn if_with_an_assignment() {
    assert_eq!(
        registers(&[
            "R[1]=3",
            "IF (R[1]>2 AND !DI[1]),R[2]=(R[1]*2)",
            "IF (R[1]>9),R[3]=1"
        ]),
        "R[1]=3 R[2]=6"
    );
}

#[test]
fn for_keeps_its_last_value_and_may_not_run_at_all() {
    assert_eq!(
        registers(&[
            "R[9]=0",
            "FOR R[1]=1 TO 3",
            "R[9]=R[9]+R[1]",
            "ENDFOR",
            "FOR R[2]=3 DOWNTO 1",
            "R[9]=R[9]+10",
            "ENDFOR",
            "FOR R[3]=2 TO 1",
            "R[9]=1000",
            "ENDFOR",
        ]),
        "R[1]=3 R[2]=1 R[3]=2 R[9]=36"
    );
}

#[test]
fn select_takes_the_first_case_that_fits() {
    for (value, expected) in [(1, "11"), (2, "22"), (7, "99")] {
        let first = format!("R[1]={value}");
        let left = lines(&[
            first.as_str(),
            "SELECT R[1]=1,CALL ONE",
            "       =2,JMP LBL[2]",
            "       ELSE,JMP LBL[9]",
            "R[2]=11",
            "END",
            "LBL[2]",
            "R[2]=22",
            "END",
            "LBL[9]",
            "R[2]=99",
        ]);
        if value == 1 {
            assert_eq!(left.end, "MAIN/MAIN:2: MEMO: Program does not exist: ONE");
        } else {
            assert_eq!(left.registers[1], format!("R[2]={expected}"));
        }
    }
}

#[test]
fn calls_with_arguments_by_name_and_by_string() {
    let main = program(
        "MAIN",
        &[
            "CALL SUB(2,3.5,'x')",
            "SR[1]='sub'",
            "CALL SR[1](40,2)",
            "R[5]=1",
        ],
        "",
    );
    let sub = program(
        "SUB",
        &[
            "R[AR[1]]=AR[1]*AR[2]",
            "IF R[40]=80,JMP LBL[1]",
            "END",
            "LBL[1]",
            "R[6]=1",
        ],
        "",
    );
    let left = run_all(
        &[main, sub],
        &depal_tp::Options::default(),
        FakeSystem::default(),
    );
    assert_eq!(
        (left.end.as_str(), left.registers.join(" ").as_str()),
        ("", "R[2]=7 R[5]=1 R[6]=1 R[40]=80")
    );
}

#[test]
fn an_argument_that_was_not_given_has_no_value() {
    let main = program("MAIN", &["CALL SUB(1)"], "");
    let sub = program("SUB", &["R[1]=AR[2]"], "");
    let left = run_all(
        &[main, sub],
        &depal_tp::Options::default(),
        FakeSystem::default(),
    );
    assert!(
        left.end
            .starts_with("SUB/SUB:1: INTP: Uninitialized data: AR[2]"),
        "{}",
        left.end
    );
}

#[test]
fn endless_recursion_ends() {
    let left = run_text(&listing(&["CALL MAIN"], ""));
    assert!(left.end.contains("INTP: Stack overflow"), "{}", left.end);
}

#[test]
fn wait_for_a_time_and_for_a_signal() {
    let mut system = FakeSystem::default();
    system
        .changes
        .push((SimTime::from_nanos(3_000_000_000), "DI[1]".into(), 1.0));
    let text = listing(
        &[
            "TIMER[1]=START",
            "WAIT   1.00(sec)",
            "R[1]=TIMER[1]",
            "WAIT DI[1]=ON",
            "R[2]=TIMER[1]",
            "WAIT (DI[1] AND !DI[2])",
        ],
        "",
    );
    let left = run_all(&[text], &depal_tp::Options::default(), system);
    assert_eq!(left.end, "");
    let seconds = |i: usize| left.registers[i][5..].parse::<f64>().unwrap();
    assert!((seconds(0) - 1.0).abs() < 0.01, "{:?}", left.registers);
    assert!((seconds(1) - 3.0).abs() < 0.01, "{:?}", left.registers);
}

#[test]
fn a_wait_gives_up_after_waittmout_hundredths() {
    let left = lines(&[
        "$WAITTMOUT=50",
        "TIMER[1]=START",
        "WAIT DI[1]=ON TIMEOUT,LBL[1]",
        "R[1]=1",
        "END",
        "LBL[1]",
        "R[2]=TIMER[1]",
    ]);
    let seconds: f64 = left.registers[0]
        .strip_prefix("R[2]=")
        .unwrap()
        .parse()
        .unwrap();
    assert!((seconds - 0.5).abs() < 0.01, "{seconds}");
}

#[test]
fn pause_abort_and_end() {
    assert_eq!(lines(&["R[1]=1", "PAUSE", "R[2]=1"]).end, "stopped: PAUSE");
    let left = lines(&["R[1]=1", "ABORT", "R[2]=1"]);
    assert_eq!(
        (left.end.as_str(), left.registers.join(" ").as_str()),
        ("stopped: ABORT", "R[1]=1")
    );
    assert_eq!(lines(&["END", "R[1]=1"]).end, "");
}

#[test]
fn messages_and_alarms() {
    let left = lines(&["MESSAGE[Part 7: not [there]]", "UALM[3]"]);
    assert_eq!(left.trace, ["Part 7: not [there]"]);
    assert_eq!(left.end, "MAIN/MAIN:2: INTP: User alarm UALM[3]");
}

fn two(main: &[&str], sub: &[&str]) -> Left {
    let texts = [program("MAIN", main, ""), program("SUB", sub, "")];
    run_all(&texts, &depal_tp::Options::default(), FakeSystem::default())
}

#[test]
fn programs_that_run_side_by_side_share_the_registers() {
    let left = two(
        &[
            "RUN SUB(7)",
            "WAIT R[2]",
            "WAIT (R[3]=1) TIMEOUT,LBL[1]",
            "R[4]=R[5]",
            "F[1]=(ON)",
            "END",
            "LBL[1]",
            "R[9]=1",
        ],
        &[
            "WAIT .50(sec)",
            "R[5]=AR[1]",
            "R[3]=1",
            "WAIT (F[1])",
            "R[6]=1",
        ],
    );
    assert_eq!(
        (left.end.as_str(), left.registers.join(" ").as_str()),
        ("", "R[3]=1 R[4]=7 R[5]=7 R[6]=1")
    );
    // One that asks the clock all the time does not stop the other.
    let left = two(
        &["RUN SUB", "LBL[1]", "IF R[1]<5,JMP LBL[1]"],
        &["FOR R[1]=1 TO 5", "WAIT .10(sec)", "ENDFOR"],
    );
    assert_eq!(
        (left.end.as_str(), left.registers.join(" ").as_str()),
        ("", "R[1]=5")
    );
}

#[test]
fn a_started_program_ends_alone_unless_it_fails() {
    let left = two(
        &["RUN SUB", "WAIT .10(sec)", "R[1]=1"],
        &["R[2]=1", "ABORT"],
    );
    assert_eq!(
        (left.end.as_str(), left.registers.join(" ").as_str()),
        ("", "R[1]=1 R[2]=1")
    );
    let left = two(&["RUN SUB", "WAIT .10(sec)", "R[1]=1"], &["R[2]=1/0"]);
    assert_eq!(
        (left.end.as_str(), left.registers.len()),
        ("SUB/SUB:1: INTP: Divide by zero: 1 / 0", 0)
    );
    let left = two(&["RUN SUB", "ABORT"], &["WAIT .10(sec)", "R[1]=1"]);
    assert_eq!(
        (left.end.as_str(), left.registers.len()),
        ("stopped: ABORT", 0)
    );
    let left = two(&["RUN SUB", "RUN SUB"], &["WAIT .10(sec)"]);
    assert_eq!(
        left.end,
        "MAIN/MAIN:2: INTP: Program is already running: RUN SUB"
    );
    assert_eq!(
        lines(&["RUN OTHER"]).end,
        "MAIN/MAIN:1: MEMO: Program does not exist: OTHER"
    );
}

#[test]
fn comments_and_empty_lines_do_nothing() {
    assert_eq!(
        registers(&[
            "!R[1]=1 ; and more",
            "//R[2]=2",
            "",
            "--eg:R[3]=3",
            "R[4]=4"
        ]),
        "R[4]=4"
    );
}

#[test]
fn lines_without_numbers() {
    let text = "/PROG MAIN\n/ATTR\n/APPL\n\nAUTO_SINGULARITY_HEADER;\n  ENABLE_SINGULARITY_AVOIDANCE   : FALSE;\n/MN\n : R[1:foo]=1 ;\n :  ;\n : IF (R[1]=1 AND\n :  !DI[1]),R[2]=5 ;\nR[3]=6 ;\n/POS\n/END\n";
    assert_eq!(run_text(text).registers.join(" "), "R[1]=1 R[2]=5 R[3]=6");
    let left = run_text("/PROG MAIN\n/MN\n : R[1]=1 ;\n : R[1]=1/0 ;\n/POS\n/END\n");
    assert_eq!(left.end, "MAIN/MAIN:2: INTP: Divide by zero: 1 / 0");
}

#[test]
fn german_keywords() {
    let main = program(
        "MAIN",
        &[
            "i[1]=5",
            "A[1]=(AN)",
            "WENN (i[1]>4 [&] !E[1]),SPRUNG LABEL[1]",
            "i[2]=1",
            "LABEL[1]",
            "WARTE   .50(sek)",
            "WARTE (A[1] [+] E[1])",
            "AUFRUF UP(3)",
            "A[1]=AUS",
            "BENUTZER_NUM=0",
            "WKZ_NUM=1",
        ],
        "",
    );
    let sub = program("UP", &["i[3]=AR[1]*2"], "");
    let left = run_all(
        &[main, sub],
        &depal_tp::Options::default(),
        FakeSystem::default(),
    );
    assert_eq!(
        (left.end.as_str(), left.registers.join(" ").as_str()),
        ("", "R[1]=5 R[3]=6")
    );
}

#[test]
fn german_moves_with_a_block_of_lines() {
    let text = "/PROG  MAIN\n/ATTR\nKOMMENTAR\t= \"Tomar\";\nPROG_GRÖßE\t= 7800;\n/MN\n   1:  BENUTZER_NUM=0 ;\n   2:  TRAGLST[2] ;\n   3:J P[1] 100% CNT0 ACC100 ZEIT VOR    .10sek,P-SPS    ;\n      1:  FB-PSPS (AN) ;\n      2:  A[1]=(AUS) ;\n      3:  i[1]=7 ;\n       ------ ;\n   4:L P[1] 400mm/sek FINE ;\n/POS\n".to_owned()
        + &taught(1, [1.0, 2.0, 3.0, 0.0, 0.0, 0.0])
        + "/END\n";
    let left = run_text(&text);
    assert_eq!(
        (left.end.as_str(), left.registers.join(" ").as_str()),
        ("", "R[1]=7")
    );
    assert_eq!(left.trace.len(), 3);
}
