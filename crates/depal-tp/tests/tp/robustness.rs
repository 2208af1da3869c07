//! Nothing that is read or run makes it panic; a printed listing is the same program.

use depal_syntax::SourceFile;
use depal_tp::{Options, Tasks, load, normal_form};
use depal_vm::execution::{RobotTask, Step};
use proptest::prelude::*;

use crate::fake_system::*;

const TEXTS: [&str; 2] = [
    include_str!("../../../../assets/tp/MM_ALL.LS"),
    include_str!("../../../../scenes/fanuc.ls"),
];

/// Lines whose normal form is compared, too.
const LINES: [&str; 41] = [
    "RUN SUB(R[1],2)",
    "R[1]=R[2]+3*(R[4]-1) DIV 2",
    "R[R[1]]=(-5)",
    "R[1:c]=-.5",
    "F[1]=(!DI[1] AND (R[1]>2 OR !F[2]))",
    "IF R[1]=1 AND DI[1]=ON,JMP LBL[1]",
    "IF (R[1]<>2),CALL SUB(1,'a',AR[1])",
    "IF (DI[1]) THEN",
    "ELSE",
    "ENDIF",
    "FOR R[1]=1 TO R[2]*2",
    "FOR R[1]=9 DOWNTO (-3)",
    "ENDFOR",
    "SELECT R[1]=1,JMP LBL[1]",
    "       =(R[2]),CALL SR[1]",
    "       =-2,JMP LBL[R[3]]",
    "       ELSE,PAUSE",
    "WAIT   1.50(sec)",
    "WAIT R[3]",
    "WAIT DI[1]=OFF TIMEOUT,LBL[1]",
    "J P[1] 50% FINE",
    "J PR[R[1]] R[2]% CNT50 ACC80",
    "L P[1] 100mm/sec CNT R[1] Offset,PR[2] TB .1sec,DO[1]=ON DB 5mm,CALL SUB",
    "L P[2] 20cm/min FINE Tool_Offset,PR[R[1]] INC Wjnt",
    "L P[2] 2.5sec FINE Skip,LBL[1],PR[3]=LPOS",
    "C P[1]\n   :  P[2] 10deg/sec FINE Offset",
    "DO[1]=PULSE,.2sec",
    "PR[1,R[2]]=PR[2,3]+1.25",
    "PR[1]=UFRAME[1]-PR[2]",
    "UFRAME_NUM=2",
    "OVERRIDE=R[1]%",
    "TIMER[1]=START",
    "TIMER[R[1]]=(-5)",
    "SR[1]=SUBSTR SR[2],R[1],(R[2]+1)",
    "R[1]=ATAN2[R[1],STRLEN SR[1]]",
    "$WAITTMOUT=R[1]*100",
    "R[1]=$MCR.$GENOVERRIDE MOD 7",
    "SKIP CONDITION DI[1]=ON OR R[1]>5",
    "OFFSET CONDITION PR[1],UFRAME[2]",
    "MESSAGE[Any text]",
    "!a comment",
];

/// Loads and, if it can be run, runs a while.
fn survive(text: &str) {
    let source = SourceFile::new("ANY.LS", text);
    let options = Options::default();
    let loaded = load(std::slice::from_ref(&source), &options, "MAIN");
    for diagnostic in &loaded.diagnostics {
        let _ = diagnostic.plain(std::slice::from_ref(&source));
    }
    let Some(program) = loaded.program else {
        return;
    };
    let mut machine = Tasks::new(program, "TP");
    let mut system = FakeSystem::default();
    for _ in 0..300 {
        match machine.step(&mut system) {
            Step::Ran => system.now += depal_time::SimDuration::from_micros(20),
            Step::Blocked => system.now += depal_time::SimDuration::from_millis(200),
            _ => return,
        }
    }
}

fn text_of(lines: &[usize]) -> String {
    let lines: Vec<&str> = lines.iter().map(|i| LINES[*i]).collect();
    let mut all = vec!["LBL[1]"];
    all.extend(lines);
    let positions =
        taught(1, [1.0, 2.0, 3.0, 0.0, 0.0, 0.0]) + &taught(2, [5.0, 2.5, 3.0, 10.0, 0.0, 90.0]);
    let sub = program("SUB", &["R[7]=AR[1]", "WAIT .10(sec)", "RUN MAIN"], "");
    listing(&all, &positions) + &sub
}

#[test]
fn the_shipped_programs_are_their_own_normal_form_twice() {
    for text in TEXTS {
        let first = normal_form(&SourceFile::new("A.LS", text)).expect("reads");
        let second = normal_form(&SourceFile::new("B.LS", first.clone())).expect("reads");
        assert_eq!(first, second);
    }
    let sources = [SourceFile::new("fanuc.ls", TEXTS[1])];
    let loaded = load(&sources, &Options::default(), "FANUC");
    assert!(loaded.diagnostics.is_empty(), "{:?}", loaded.diagnostics);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// What is printed reads as what was printed, line by line.
    #[test]
    fn print_and_parse(lines in prop::collection::vec(0..LINES.len(), 0..25)) {
        let text = text_of(&lines);
        let first = normal_form(&SourceFile::new("A.LS", text));
        prop_assert!(first.is_ok(), "{:?}", first);
        let first = first.unwrap_or_default();
        let second = normal_form(&SourceFile::new("B.LS", first.clone()));
        prop_assert_eq!(Ok(first), second);
    }

    /// The normal form runs as the listing does.
    #[test]
    fn the_normal_form_does_the_same(a in -20i32..20, b in 1i32..9, c in -50i32..50) {
        let first = format!("R[1]={a}");
        let second = format!("R[2]={b}");
        let third = format!("R[3]=R[1]-(R[2]-{c}.5)*2/R[2]+R[1] MOD R[2]");
        let text = listing(&[&first, &second, &third, "R[4]=(!(R[1]>R[2] AND R[3]<R[1]) OR R[2]=1)"], "");
        let printed = normal_form(&SourceFile::new("A.LS", text.clone())).unwrap_or_default();
        let runs = |text: &str| run_text(text).registers;
        prop_assert_eq!(runs(&text), runs(&printed));
    }

    #[test]
    fn random_programs_run(lines in prop::collection::vec(0..LINES.len(), 0..20)) {
        survive(&text_of(&lines));
    }

    #[test]
    fn random_text_is_read(text in "(/PROG MAIN\n/MN\n)?[ -~\n]{0,300}") {
        survive(&text);
    }

    #[test]
    fn mutated_programs_are_read_and_run(
        which in 0..TEXTS.len(),
        edits in prop::collection::vec((0usize..8000, 0usize..12, "[ -~\näß]{0,6}"), 1..6),
    ) {
        let mut text: Vec<char> = TEXTS[which].replace("MM_ALL", "MAIN").replace("/PROG  FANUC", "/PROG  MAIN").chars().collect();
        for (at, length, put) in edits {
            let at = at % text.len().max(1);
            let end = (at + length).min(text.len());
            text.splice(at.min(end)..end, put.chars());
        }
        survive(&text.into_iter().collect::<String>());
    }
}

/// A line as long as one likes is refused, not read to the end of the stack.
#[test]
fn very_many_signs_are_refused() {
    for line in [
        "SELECT {}R[1]=1,JMP LBL[1]",
        "R[1]={}1",
        "IF R[1]=(!{}1),JMP LBL[1]",
    ] {
        let line = line.replace("{}", &"-".repeat(200_000));
        survive(&crate::fake_system::listing(&[&line], ""));
    }
}
