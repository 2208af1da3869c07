//! No text may make the front end panic or hang, and what it accepts may not make the machine panic.

use std::collections::BTreeMap;

use depal_krl::{check, load_with_any_signals, normal_form};
use depal_syntax::SourceFile;
use depal_time::{SimDuration, SimTime, TICK};
use depal_vm::Machine;
use depal_vm::execution::{RobotTask, Step};
use proptest::prelude::*;

use crate::fake_system::FakeSystem;

const WORDS: [&str; 92] = [
    "DEF",
    "END",
    "DEFFCT",
    "ENDFCT",
    "DEFDAT",
    "ENDDAT",
    "PUBLIC",
    "GLOBAL",
    "DECL",
    "INT",
    "REAL",
    "BOOL",
    "CHAR",
    "E6POS",
    "FRAME",
    "STRUC",
    "ENUM",
    "SIGNAL",
    "CONST",
    "IF",
    "THEN",
    "ELSE",
    "ENDIF",
    "FOR",
    "TO",
    "STEP",
    "ENDFOR",
    "WHILE",
    "ENDWHILE",
    "REPEAT",
    "UNTIL",
    "LOOP",
    "ENDLOOP",
    "EXIT",
    "SWITCH",
    "CASE",
    "DEFAULT",
    "ENDSWITCH",
    "GOTO",
    "RETURN",
    "WAIT",
    "SEC",
    "HALT",
    "CONTINUE",
    "INTERRUPT",
    "WHEN",
    "DO",
    "ON",
    "BRAKE",
    "RESUME",
    "TRIGGER",
    "DISTANCE",
    "DELAY",
    "PRIO",
    "PTP",
    "LIN",
    "CIRC",
    "LIN_REL",
    "C_DIS",
    "WITH",
    "CA",
    "SPLINE",
    "main",
    "main( )",
    "a",
    "b",
    "p",
    "$IN",
    "$OUT",
    "$VEL",
    ".CP",
    "$ADVANCE",
    "=",
    "==",
    "<",
    "+",
    "-",
    "*",
    "/",
    ":",
    "(",
    ")",
    "[",
    "]",
    "{X 1}",
    "{",
    "}",
    ",",
    "1",
    "2.5",
    "\"t\"",
    "#RED",
];

/// The first 1024 of each array.
fn all_signals() -> BTreeMap<String, f64> {
    let arrays = ["$IN", "$OUT", "$ANIN", "$ANOUT"].into_iter();
    let numbered = |array| (1..=1024).map(move |number| format!("{array}[{number}]"));
    arrays.flat_map(numbered).map(|name| (name, 0.0)).collect()
}

/// Checks a text, and runs it a little if it is right.
fn throw(text: &str) {
    for name in ["main.src", "main.dat", "x"] {
        let source = SourceFile::new(name, text);
        let loaded = check(std::slice::from_ref(&source));
        for diagnostic in &loaded.diagnostics {
            let _ = diagnostic.plain(std::slice::from_ref(&source));
        }
        if let Ok(printed) = normal_form(&source) {
            assert!(normal_form(&SourceFile::new(name, printed)).is_ok());
        }
    }
    let source = SourceFile::new("main.src", text);
    let loaded = load_with_any_signals(&[source], "main");
    let Some(program) = loaded.program else {
        return;
    };
    let mut system = FakeSystem {
        signals: all_signals(),
        ..FakeSystem::default()
    };
    let mut machine = Machine::new(program, "T_ROB1");
    for _ in 0..2000 {
        match machine.step(&mut system) {
            Step::Ran => system.now += SimDuration::from_micros(20),
            Step::Blocked => system.now += TICK,
            _ => return,
        }
        system.catch_up();
        if system.now > SimTime::from_nanos(5_000_000_000) {
            return;
        }
    }
}

fn lines() -> impl Strategy<Value = String> {
    let line = prop::collection::vec(prop::sample::select(WORDS.to_vec()), 0..8);
    prop::collection::vec(line.prop_map(|words| words.join(" ")), 0..30)
        .prop_map(|lines| lines.join("\n"))
}

const WHOLE: &str = "DEF main( )\nENUM COLOUR RED, GREEN\nSTRUC PART INT n, CHAR name[4], REAL w[2]\nDECL INT a, i, k[3]\nDECL REAL r\nDECL COLOUR c\nDECL PART q\nDECL FRAME f\nSIGNAL s $OUT[1] TO $OUT[4]\nINTERRUPT DECL 5 WHEN $IN[1] DO sub(2, g)\nINTERRUPT ON 5\nc = #RED\nFOR i = 1 TO 3\nk[i] = i * 2\nENDFOR\nq = {n 1, name[] \"ab\"}\nf = {X 1.0, Y 2.0, Z 3.0, A 0.0, B 0.0, C 0.0}\nTRIGGER WHEN DISTANCE = 1 DELAY = 0 DO $OUT[5] = TRUE\nPTP {A1 10, A2 -20} C_PTP\nLIN f : f C_DIS\nLIN_REL {Z 5.0} #TOOL\nCIRC {X 50.0, Y 70.0}, {X 90.0, Y 20.0}, CA 90\nSLIN f WITH $VEL.CP = 0.5\nWAIT FOR ($IN[2] == FALSE) OR $IN[3]\ns = 5\nIF fct(2) > 3 THEN\na = 1 / k[1]\nELSE\na = 'HFF' B_AND 15\nENDIF\nSWITCH a\nCASE 1, 2\nHALT\nDEFAULT\nWAIT SEC 0.1\nENDSWITCH\nREPEAT\na = a + 1\nUNTIL a > 5\nLOOP\nEXIT\nENDLOOP\ntop:\na = a + 1\nIF a < 9 THEN\nGOTO top\nENDIF\nCONTINUE\n$OUT[2] = TRUE\nEND\nDEF sub(x:IN, y:OUT)\nDECL INT x\nDECL INT y\nBRAKE\ny = x\nRESUME\nEND\nDEFFCT INT fct(n:IN)\nDECL INT n\nRETURN n + 1\nENDFCT\n";

#[test]
fn the_whole_program_is_right() {
    let source = SourceFile::new("main.src", format!("DECL INT g\n{WHOLE}"));
    let loaded = check(std::slice::from_ref(&source));
    assert!(loaded.diagnostics.is_empty(), "{:#?}", loaded.diagnostics);
    throw(&source.text);
}

/// Replaces, drops or doubles a line, or changes a character.
fn mutated() -> impl Strategy<Value = String> {
    let whole = format!("DECL INT g\n{WHOLE}");
    let change = (
        0..4usize,
        any::<prop::sample::Index>(),
        prop::sample::select(WORDS.to_vec()),
    );
    prop::collection::vec(change, 1..6).prop_map(move |changes| {
        let mut lines: Vec<String> = whole.lines().map(str::to_owned).collect();
        for (kind, at, word) in changes {
            if lines.is_empty() {
                break;
            }
            let at = at.index(lines.len());
            match kind {
                0 => {
                    lines.remove(at);
                }
                1 => {
                    let line = lines[at].clone();
                    lines.insert(at, line);
                }
                2 => word.clone_into(&mut lines[at]),
                _ => {
                    let mut words: Vec<_> = lines[at].split(' ').map(str::to_owned).collect();
                    let place = word.len() % words.len();
                    word.clone_into(&mut words[place]);
                    lines[at] = words.join(" ");
                }
            }
        }
        lines.join("\n")
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        throw(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn any_words(text in lines()) {
        throw(&text);
        throw(&format!("DEF main( )\nDECL INT a, b[3]\nDECL E6POS p\n{text}\nEND"));
    }

    #[test]
    fn mutated_programs(text in mutated()) {
        throw(&text);
    }
}

#[test]
fn deep_and_long_texts() {
    throw(&"(".repeat(20_000));
    throw(&format!(
        "DEF main( )\nDECL INT a\na = {}1{}\nEND",
        "(".repeat(500),
        ")".repeat(500)
    ));
    throw(&format!(
        "DEF main( )\nDECL INT a\na = 1{}\nEND",
        " + 1".repeat(5000)
    ));
    throw(&format!(
        "DEF main( )\n{}\nEND",
        "IF TRUE THEN\n".repeat(5000)
    ));
    throw(&format!(
        "DEF main( )\nDECL INT a\na = {}1\nEND",
        "-".repeat(5000)
    ));
    throw(&format!("DEF main( )\na{} = 1\nEND", ".b".repeat(5000)));
    let structures: Vec<_> = (1..60)
        .map(|i| format!("STRUC S{i} S{} a, S{} b", i - 1, i - 1))
        .collect();
    let structures = structures.join("\n");
    throw(&format!(
        "DEF main( )\nSTRUC S0 INT x\n{structures}\nDECL S59 q\nEND"
    ));
}
