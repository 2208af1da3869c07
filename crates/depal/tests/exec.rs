//! `depal exec` and `depal check --json` as a user runs them.

use std::io::{Read, Write};
use std::net::TcpListener;

use robot_program::{depal, folder, json, stderr, stdout};

mod robot_program;

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
    let arguments = [
        "exec",
        "m.mod",
        "--connect",
        &route,
        "--record-sockets",
        "sockets.txt",
    ];
    let output = depal(&folder, &arguments);
    assert_eq!(&server.join().expect("served"), b"ping");
    assert_eq!(stdout(&output), "pong\nclosed\n", "{}", stderr(&output));
    // The same without the server, from what was written down.
    let output = depal(
        &folder,
        &["exec", "m.mod", "--replay-sockets", "sockets.txt"],
    );
    assert_eq!(stdout(&output), "pong\nclosed\n", "{}", stderr(&output));
    assert!(
        !stderr(&output).contains("transcript"),
        "{}",
        stderr(&output)
    );
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

/// Files are written below --home and nowhere else.
#[test]
fn files_live_below_home() {
    let text = "MODULE m\n  VAR iodev f;\n  PROC main()\n    Open \"HOME:/out/log.txt\", f;\n    Write f, \"line\";\n    Close f;\n    RemoveFile \"HOME:/old.txt\";\n    Open \"HOME:/../escaped.txt\", f;\n    ERROR\n    IF ERRNO = ERR_FILEOPEN TPWrite \"refused\";\n  ENDPROC\nENDMODULE\n";
    let folder = folder("home", &[("m.mod", text)]);
    let home = folder.join("files");
    std::fs::create_dir_all(&home).expect("made");
    std::fs::write(home.join("old.txt"), "old").expect("written");
    let output = depal(&folder, &["exec", "m.mod", "--home", "files"]);
    assert_eq!(stdout(&output), "refused\n", "{}", stderr(&output));
    assert_eq!(
        std::fs::read_to_string(home.join("out/log.txt")).expect("written"),
        "line\n"
    );
    assert!(!home.join("old.txt").exists() && !folder.join("escaped.txt").exists());
}

/// A question waits for ever; answers come from a file, in order.
#[test]
fn questions_are_answered_from_a_file_or_wait() {
    let text = main_of("VAR num n;\nTPReadNum n, \"how many\";\nTPWrite \"n=\"\\Num:=n;");
    let folder = folder(
        "answers",
        &[("m.mod", &text), ("answers.txt", "# how many\n7\n")],
    );
    let output = depal(&folder, &["exec", "m.mod", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(json(&output)["end"], "idle");
    let output = depal(&folder, &["exec", "m.mod", "--ui-answers", "answers.txt"]);
    assert_eq!(stdout(&output), "n=7\n", "{}", stderr(&output));
}

/// EXIT, Stop and ExitCycle end a run well; --entry starts elsewhere; several files are one task in any order.
#[test]
fn ends_and_entries() {
    let text = "MODULE m\n  PROC main()\n    go;\n  ENDPROC\n  PROC by_exit()\n    EXIT;\n  ENDPROC\n  PROC by_stop()\n    Stop;\n  ENDPROC\n  PROC by_cycle()\n    ExitCycle;\n  ENDPROC\nENDMODULE\n";
    let other = "MODULE n\n  PROC go()\n    TPWrite \"went\";\n  ENDPROC\nENDMODULE\n";
    let folder = folder("ends", &[("m.mod", text), ("n.mod", other)]);
    for (entry, end) in [
        ("main", "ended"),
        ("by_exit", "stopped"),
        ("by_stop", "stopped"),
        ("by_cycle", "stopped"),
    ] {
        for files in [["m.mod", "n.mod"], ["n.mod", "m.mod"]] {
            let output = depal(
                &folder,
                &["exec", files[0], files[1], "--entry", entry, "--json"],
            );
            assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
            assert_eq!(json(&output)["end"], end, "{entry}");
        }
    }
    let output = depal(&folder, &["exec", "m.mod", "n.mod", "--entry", "nowhere"]);
    assert_eq!(output.status.code(), Some(2));
}

/// A SocketReceive that times out unhandled is exit code 1, at its own line, after its own time.
#[test]
fn a_receive_time_out_is_a_run_time_error() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let port = listener.local_addr().expect("bound").port();
    let text = format!(
        "MODULE m\n  VAR socketdev s;\n  VAR string got;\n  PROC main()\n    SocketCreate s;\n    SocketConnect s, \"127.0.0.1\", {port};\n    SocketReceive s \\Str:=got \\Time:=0.5;\n  ENDPROC\nENDMODULE\n"
    );
    let folder = folder("timeout", &[("m.mod", &text)]);
    let output = depal(&folder, &["exec", "m.mod", "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let document = json(&output);
    assert_eq!(document["end"], "error");
    assert_eq!(document["error"]["line"], 7);
    let seconds = document["sim_time_s"].as_f64().expect("a number");
    assert!((0.5..1.5).contains(&seconds), "{seconds}");
    drop(listener);
}

/// The flange of wobj0 and tool0 is the pose of the link tool0 in the root link, in mm.
#[test]
fn a_robot_reads_its_flange() {
    let urdf = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../urdf/abb_irb6700_150_320.urdf"
    );
    let text = main_of(
        "MoveAbsJ [[0,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v1000, fine, tool0;\nTPWrite ValToStr(CRobT(\\Tool:=tool0\\WObj:=wobj0).trans);",
    );
    let text = text.replace("TPWrite ValToStr(CRobT(\\Tool:=tool0\\WObj:=wobj0).trans)", "p := CRobT(\\Tool:=tool0\\WObj:=wobj0);\nTPWrite NumToStr(p.trans.x,0)+\" \"+NumToStr(p.trans.y,0)+\" \"+NumToStr(p.trans.z,0)");
    let text = text.replace("MODULE m\n", "MODULE m\n  VAR robtarget p;\n");
    let folder = folder("flange", &[("m.mod", &text)]);
    let output = depal(&folder, &["exec", "m.mod", "--robot", urdf]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let found: Vec<f64> = stdout(&output)
        .split_whitespace()
        .map(|n| n.parse().expect("a number"))
        .collect();
    let kinematics = depal(
        &folder,
        &[
            "kinematics",
            urdf,
            "--samples",
            "1",
            "--seed",
            "1",
            "--json",
        ],
    );
    assert_eq!(kinematics.status.code(), Some(0));
    // Arm straight up, forearm level: in front of the base, above two metres.
    assert!(
        found[0] > 1500.0 && found[1].abs() < 1.0 && found[2] > 1800.0,
        "{found:?}"
    );
}

/// 1,500 moves without physics: at least 500 times as fast as the robot would be, with an arm and without.
#[test]
fn many_moves_run_much_faster_than_the_robot() {
    let urdf = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../urdf/abb_irb6700_150_320.urdf"
    );
    let text = main_of(
        "VAR robtarget p;\nMoveAbsJ [[0,0,0,0,80,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v1000, fine, tool0;\np := CRobT(\\Tool:=tool0);\nFOR i FROM 1 TO 375 DO\nMoveL Offs(p,0,200,0), v500, z20, tool0;\nMoveL Offs(p,0,200,200), v500, z20, tool0;\nMoveJ Offs(p,0,-200,200), v500, z20, tool0;\nMoveL p, v500, fine, tool0;\nENDFOR",
    );
    let folder = folder("many", &[("m.mod", &text)]);
    for arm in [vec!["--no-kinematics"], vec!["--robot", urdf]] {
        let arguments = [vec!["exec", "m.mod", "--json"], arm.clone()].concat();
        let output = depal(&folder, &arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let document = json(&output);
        assert_eq!(document["moves"], 1501);
        let number = |key: &str| document[key].as_f64().expect("a number");
        let factor = number("sim_time_s") / number("wall_time_s");
        eprintln!(
            "{arm:?}: {:.1} s in {:.3} s, {factor:.0} x real time",
            number("sim_time_s"),
            number("wall_time_s")
        );
        // The promise is 500; a test build on a busy machine is given some room.
        assert!(factor > 100.0, "{arm:?}: {factor}");
    }
}

/// What `init` writes passes the check, as it is and sample by sample.
#[test]
fn init_writes_samples_that_pass() {
    let folder = folder("init", &[]);
    let written = folder.join("cell");
    let _ = std::fs::remove_dir_all(&written);
    let output = depal(&folder, &["init", "--lang", "rapid", "cell"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for sample in [
        "s01_vision_points",
        "s02_viz_path",
        "s03_do_list",
        "s04_branch_and_index",
        "s05_lite_commands",
        "s06_error_handling",
        "s07_plan_ahead",
    ] {
        let name = format!("{sample}.mod");
        let output = depal(&written, &["check", "MM_Module.mod", "cell.mod", &name]);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{sample}: {}",
            stderr(&output)
        );
    }
    let output = depal(&written, &["check", "sample.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    // What is there is kept.
    std::fs::write(written.join("cell.mod"), "mine").expect("written");
    depal(&folder, &["init", "cell"]);
    assert_eq!(
        std::fs::read_to_string(written.join("cell.mod")).expect("there"),
        "mine"
    );
}
