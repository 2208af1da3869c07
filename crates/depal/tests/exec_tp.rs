//! `depal exec` with TP listings as a user runs it, alone and against a served vision system.
#![allow(missing_docs, clippy::disallowed_methods)]

mod robot_program;

use robot_program::{depal, folder, route, serve, told};

const ALL: &str = include_str!("robot_program/ALL.LS");
/// Status registers of [`ALL`] with the code of success.
const CODES: [(u32, u32); 16] = [
    (70, 1101),
    (71, 1107),
    (72, 1108),
    (73, 1102),
    (74, 1100),
    (75, 1103),
    (76, 1100),
    (77, 2109),
    (78, 2108),
    (79, 2103),
    (80, 2106),
    (81, 2105),
    (82, 2100),
    (83, 2104),
    (84, 2100),
    (85, 2102),
];

fn listing(name: &str, lines: &[&str]) -> String {
    let numbered = lines.iter().enumerate();
    let lines: Vec<String> = numbered
        .map(|(index, line)| format!("{:4}:  {line} ;\n", index + 1))
        .collect();
    let body = lines.concat();
    format!("/PROG  {name}\n/MN\n{body}/POS\n/END\n")
}

fn all_succeed(stdout: &str) {
    for (register, code) in CODES {
        let line = format!("R[{register}]={code}");
        assert!(stdout.lines().any(|l| l == line), "{line} in\n{stdout}");
    }
}

#[test]
fn every_vision_call_succeeds_in_both_byte_orders() {
    let folder = folder("tp_all", &[("ALL.LS", ALL)]);
    for (kind, flag) in [("hex-be", None), ("hex-le", Some("--little-endian"))] {
        let served = serve(kind, "fanuc", &[]);
        let route = route(&served);
        let mut arguments = vec!["exec", "ALL.LS", "--print-registers", "--connect", &route];
        arguments.extend(flag);
        let output = depal(&folder, &arguments);
        let (stdout, stderr) = told(&output);
        assert_eq!(output.status.code(), Some(0), "{stderr}");
        all_succeed(&stdout);
        // The outputs of the list, and no others.
        for n in 1..=8 {
            let line = format!("R[{}]={}", 190 + n, u8::from(n == 3 || n == 5));
            assert!(stdout.lines().any(|l| l == line), "{line} in\n{stdout}");
        }
    }
}

#[test]
fn a_wrong_byte_order_is_told_and_a_lost_connection_needs_no_new_server() {
    let folder = folder("tp_lost", &[("ALL.LS", ALL)]);
    let served = serve("hex-be", "fanuc", &["--inject", "drop_connection@reply=8"]);
    let route = route(&served);
    let arguments = ["exec", "ALL.LS", "--print-registers", "--connect", &route];
    let wrong = depal(&folder, &[&arguments[..], &["--little-endian"]].concat());
    assert!(told(&wrong).0.contains("R[70]=3096\n"), "{wrong:?}");
    assert_eq!(wrong.status.code(), Some(1));
    let mut broken = false;
    for _ in 0..3 {
        let output = depal(&folder, &arguments);
        let (stdout, stderr) = told(&output);
        if output.status.code() == Some(0) {
            assert!(broken, "the connection was never lost");
            all_succeed(&stdout);
            return;
        }
        broken = true;
        let is_told = stdout.contains("=3097\n") || stderr.contains("closed the connection");
        assert!(is_told, "{stdout}{stderr}");
    }
    panic!("no run came through");
}

#[test]
fn registers_are_printed_and_errors_have_the_listings_line() {
    let main = listing(
        "MAIN",
        &[
            "R[2]=R[1]/2",
            "R[3]=7 DIV 2",
            "R[4]=7 MOD 2",
            "CALL SUB(4,R[2])",
            "R[6]=1/0",
        ],
    );
    let sub = listing("SUB", &["R[5]=AR[1]*AR[2]"]);
    let abort = listing("AB", &["R[1]=1", "ABORT", "R[1]=2"]);
    let folder = folder(
        "tp_registers",
        &[("MAIN.LS", &main), ("SUB.LS", &sub), ("AB.LS", &abort)],
    );
    let arguments = [
        "exec", "MAIN.LS", "SUB.LS", "--entry", "MAIN", "--set-r", "1=7",
    ];
    let output = depal(&folder, &[&arguments[..], &["--print-registers"]].concat());
    let (stdout, stderr) = told(&output);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(
        stdout.ends_with("R[2]=3.5\nR[3]=3\nR[4]=1\nR[5]=14\n"),
        "{stdout}"
    );
    assert!(stderr.starts_with("MAIN/MAIN:5: "), "{stderr}");
    let output = depal(&folder, &["exec", "AB.LS", "--print-registers"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(told(&output).0, "R[1]=1\n");
}

#[test]
fn german_words_and_time_outs() {
    let main = listing(
        "DE",
        &[
            "i[1]=5",
            "WENN i[1]=5,SPRUNG LABEL[2]",
            "i[2]=1",
            "LABEL[2]",
            "DO[1]=(AN)",
            "i[3]=DO[1]",
            "$WAITTMOUT=150",
            "WAIT DI[1]=ON TIMEOUT,LABEL[3]",
            "i[4]=1",
            "LABEL[3]",
        ],
    );
    let folder = folder("tp_german", &[("DE.LS", &main)]);
    let arguments = ["exec", "DE.LS", "--print-registers"];
    let late = depal(&folder, &arguments);
    assert_eq!(told(&late).0, "R[1]=5\nR[3]=1\n", "{late:?}");
    let came = depal(
        &folder,
        &[&arguments[..], &["--set-di", "DI[1]=1@0.5"]].concat(),
    );
    assert_eq!(told(&came).0, "R[1]=5\nR[3]=1\nR[4]=1\n", "{came:?}");
}

#[test]
fn bad_input_starts_nothing() {
    let syntax = listing("BAD", &["R[1]==3"]);
    let no_label = listing("NOLBL", &["JMP LBL[3]"]);
    let no_program = listing("NOPROG", &["CALL NOWHERE"]);
    let files = [
        ("BAD.LS", syntax.as_str()),
        ("NOLBL.LS", &no_label),
        ("NOPROG.LS", &no_program),
        ("m.src", "DEF m( )\nEND\n"),
    ];
    let folder = folder("tp_bad", &files);
    let code = |arguments: &[&str]| depal(&folder, arguments).status.code();
    assert_eq!(code(&["exec", "BAD.LS"]), Some(2));
    assert_eq!(code(&["exec", "NOLBL.LS"]), Some(2));
    assert_eq!(code(&["exec", "NOPROG.LS"]), Some(1));
    assert_eq!(code(&["exec", "GONE.LS"]), Some(2));
    assert_eq!(code(&["exec", "NOPROG.LS", "m.src"]), Some(2));
    assert_eq!(code(&["exec", "NOPROG.LS", "--eki", "x.xml"]), Some(2));
    assert_eq!(code(&["check", "NOPROG.LS", "m.src"]), Some(0));
}
