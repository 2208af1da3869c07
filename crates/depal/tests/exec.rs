//! `depal exec` and `depal check --json` as a user runs them.

use std::io::{Read, Write};
use std::net::TcpListener;
use std::path::PathBuf;
use std::process::{Command, Output};

/// A folder of this test with these files.
fn folder(test: &str, files: &[(&str, &str)]) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(test);
    std::fs::create_dir_all(&path).expect("a writable target folder");
    for (name, text) in files {
        std::fs::write(path.join(name), text).expect("a writable target folder");
    }
    path
}

fn depal(folder: &PathBuf, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_depal"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the program starts")
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

fn main_of(statements: &str) -> String {
    format!("MODULE m\n  PROC main()\n{statements}\n  ENDPROC\nENDMODULE\n")
}

#[test]
fn the_operators_lines_are_all_of_stdout() {
    let text =
        main_of("TPWrite \"one\";\nErrWrite \"head\", \"reason\";\nTPWrite \"two=\"\\Num:=2;");
    let folder = folder("lines", &[("m.mod", &text)]);
    let output = depal(&folder, &["exec", "m.mod", "--no-kinematics"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stdout(&output), "one\ntwo=2\n");
    assert!(stderr(&output).contains("head"));
}

#[test]
fn an_unhandled_error_names_its_innermost_place() {
    let text = "MODULE m\n  PROC main()\n    inner;\n  ENDPROC\n  PROC inner()\n    VAR num x;\n    x := 1 / x;\n  ENDPROC\nENDMODULE\n";
    let folder = folder("error", &[("m.mod", text)]);
    let output = depal(&folder, &["exec", "m.mod", "--no-kinematics"]);
    assert_eq!(output.status.code(), Some(1));
    let told = stderr(&output);
    assert!(
        told.lines()
            .any(|line| line.starts_with("m/inner:7: ERR_DIVZERO")),
        "{told}"
    );
    let output = depal(&folder, &["exec", "m.mod", "--no-kinematics", "--json"]);
    let document: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(document["end"], "error");
    assert_eq!(document["error"]["routine"], "inner");
    assert_eq!(document["error"]["line"], 7);
}

#[test]
fn nothing_runs_with_an_undefined_signal_unless_it_is_made() {
    let text =
        main_of("TPWrite \"begun\";\nSetDO do_pump, 1;\nWaitDI di_go, 1;\nTPWrite \"gone\";");
    let folder = folder("signals", &[("m.mod", &text)]);
    let output = depal(&folder, &["exec", "m.mod", "--no-kinematics"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(stdout(&output), "");
    // Made, but never set: the program waits for what cannot come.
    let arguments = [
        "exec",
        "m.mod",
        "--no-kinematics",
        "--auto-signals",
        "--json",
    ];
    let document: serde_json::Value =
        serde_json::from_str(&stdout(&depal(&folder, &arguments))).expect("JSON");
    assert_eq!(document["end"], "idle");
    let set = [&arguments[..], &["--set-di", "di_go=1@2.5"]].concat();
    let document: serde_json::Value =
        serde_json::from_str(&stdout(&depal(&folder, &set))).expect("JSON");
    assert_eq!(document["end"], "ended");
    assert_eq!(document["tpwrite"], serde_json::json!(["begun", "gone"]));
    let seconds = document["sim_time_s"].as_f64().expect("a number");
    assert!((2.5..2.52).contains(&seconds), "{seconds}");
}

#[test]
fn signals_and_cross_connections_come_from_the_configuration() {
    let text = main_of("SetDO do_out, 1;\nTPWrite \"in=\"\\Num:=DInput(di_in);\nSetGO go_part, 9;");
    let cfg = "EIO:CFG_1.0:6:1::\n#\nEIO_SIGNAL:\n\n      -Name \"do_out\" -SignalType \"DO\"\\\n      -Device \"b\" -DeviceMap \"0\"\n      -Name \"di_in\" -SignalType \"DI\"\n      -Name \"go_part\" -SignalType \"GO\" -DeviceMap \"0-2\"\n#\nEIO_CROSS:\n\n      -Name \"c\" -Res \"di_in\" -Act1 \"do_out\"\n";
    let folder = folder("eio", &[("m.mod", &text), ("EIO.cfg", cfg)]);
    let output = depal(&folder, &["exec", "m.mod", "--io", "EIO.cfg"]);
    assert_eq!(stdout(&output), "in=1\n");
    // Three bits hold 7 at most.
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("m/main:5:"), "{}", stderr(&output));
}

#[test]
fn a_busy_program_ends_at_its_time_limit() {
    let text = main_of("WHILE TRUE DO\nWaitTime 0.1;\nENDWHILE");
    let folder = folder("limit", &[("m.mod", &text)]);
    let output = depal(&folder, &["exec", "m.mod", "--max-sim-s", "50", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let document: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(document["end"], "time_limit");
    let (sim, wall) = (&document["sim_time_s"], &document["wall_time_s"]);
    assert!(sim.as_f64() > wall.as_f64(), "simulated time runs free");
}

#[test]
fn a_real_server_is_reached_through_a_route() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let port = listener.local_addr().expect("bound").port();
    let server = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a client");
        let mut asked = [0; 4];
        stream.read_exact(&mut asked).expect("four bytes");
        stream.write_all(b"pong").expect("sent");
        asked
    });
    let text = "MODULE m\n  VAR socketdev s;\n  VAR string got;\n  PROC main()\n    SocketCreate s;\n    SocketConnect s, \"192.168.125.5\", 50000;\n    SocketSend s \\Str:=\"ping\";\n    SocketReceive s \\Str:=got \\ReadNoOfBytes:=4;\n    TPWrite got;\n    SocketReceive s \\Str:=got \\Time:=1;\n    ERROR\n    IF ERRNO = ERR_SOCK_CLOSED TPWrite \"closed\";\n  ENDPROC\nENDMODULE\n";
    let folder = folder("socket", &[("m.mod", text)]);
    let route = format!("192.168.125.5:50000=127.0.0.1:{port}");
    let output = depal(&folder, &["exec", "m.mod", "--connect", &route]);
    assert_eq!(&server.join().expect("served"), b"ping");
    assert_eq!(stdout(&output), "pong\nclosed\n", "{}", stderr(&output));
}

#[test]
fn check_gives_a_verdict_for_every_file() {
    let good = main_of("TPWrite \"x\";");
    let bad = "MODULE n\n  PROC p()\n    IF TRUE THEN\n    TPWrite \"x\"\n    TPWrite \"y\";\n  ENDPROC\nENDMODULE\n";
    let folder = folder("check", &[("good.mod", &good), ("bad.mod", bad)]);
    let output = depal(&folder, &["check", "--json", "good.mod", "bad.mod"]);
    assert_eq!(output.status.code(), Some(2));
    let document: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(document["files"][0]["path"], "good.mod");
    assert_eq!(document["files"][0]["ok"], true);
    assert_eq!(document["files"][1]["ok"], false);
    let found = document["files"][1]["diagnostics"]
        .as_array()
        .expect("a list");
    assert_eq!(found.len(), 2, "{found:?}");
    assert_eq!(found[0]["line"], 4);
}

#[test]
fn syntax_only_looks_at_no_names() {
    let text = main_of("no_such_thing 1, x;");
    let folder = folder("syntax", &[("m.mod", &text)]);
    let names = depal(&folder, &["check", "m.mod"]);
    assert_eq!(names.status.code(), Some(2));
    let syntax = depal(&folder, &["check", "--syntax-only", "m.mod"]);
    assert_eq!(syntax.status.code(), Some(0), "{}", stderr(&syntax));
}
