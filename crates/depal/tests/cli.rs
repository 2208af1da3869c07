//! The command line as a user meets it: exit codes, messages, and what is left behind.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn depal(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_depal"))
        .args(args)
        .current_dir(root())
        .output()
        .expect("the binary starts")
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&path);
    path
}

fn file(name: &str, text: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, text).expect("a writable folder");
    path.to_string_lossy().into_owned()
}

/// Exit code and stderr; fails on a panic of the program.
#[track_caller]
fn check(output: &Output, code: i32, needles: &[&str]) {
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(!text.contains("panicked"), "{text}");
    assert_eq!(output.status.code(), Some(code), "{text}");
    for needle in needles {
        assert!(text.contains(needle), "expected {needle:?} in:\n{text}");
    }
}

/// The demo's scene with some lines changed, as a file whose relative paths still lead to the demo's files.
fn scene(name: &str, from: &str, to: &str) -> String {
    let text = fs::read_to_string(root().join("scenes/demo.toml")).expect("the demo scene");
    assert!(text.contains(from), "the demo scene has no {from:?}");
    let scenes = root()
        .join("scenes")
        .canonicalize()
        .expect("scenes/ is there");
    let absolute = |file: &str| scenes.join(file).to_string_lossy().into_owned();
    let text = text
        .replace(from, to)
        .replace("\"demo.mod\"", &format!("\"{}\"", absolute("demo.mod")))
        .replace(
            "\"../urdf/abb_irb6700_150_320.urdf\"",
            &format!("\"{}\"", absolute("../urdf/abb_irb6700_150_320.urdf")),
        );
    file(name, &text)
}

#[test]
fn a_short_run_prints_one_document_and_leaves_its_files() {
    let out = folder("short");
    let output = depal(&[
        "run",
        "--json",
        "--seed",
        "5",
        "--out",
        &out.to_string_lossy(),
        "--set",
        "run.max_sim_s=14",
        "--set",
        "accept.delivered_min=0",
    ]);
    check(&output, 4, &[]);
    let report: serde_json::Value =
        serde_json::from_slice(&output.stdout).expect("one JSON document");
    assert_eq!(report["schema"], 1);
    assert_eq!(report["seed"], 5);
    assert_eq!(report["boxes"]["total"], 48);
    for name in ["report.json", "events.jsonl", "run.rrd"] {
        let size = fs::metadata(out.join(name)).map_or(0, |meta| meta.len());
        assert!(size > 500, "{name} has {size} bytes");
    }
    let leftovers = fs::read_dir(&out).expect("the folder").count();
    assert_eq!(leftovers, 3, "something else was left in the folder");
}

#[test]
fn missed_thresholds_are_exit_code_1() {
    let out = folder("missed");
    let output = depal(&[
        "run",
        "--out",
        &out.to_string_lossy(),
        "--set",
        "camera.blackout=true",
    ]);
    check(&output, 1, &["no_detection", "0 of 48 delivered"]);
}

#[test]
fn a_missing_scene_is_named() {
    check(&depal(&["run", "nowhere.toml"]), 2, &["nowhere.toml"]);
}

#[test]
fn an_unknown_key_is_named_with_line_and_the_nearest_one() {
    let path = scene("unknown.toml", "noise_mm = 0.5", "nose_mm = 0.5");
    check(
        &depal(&["run", &path]),
        2,
        &["unknown.toml:", "nose_mm", "noise_mm"],
    );
    let output = depal(&["run", "--set", "camera.nose_mm=1"]);
    check(&output, 2, &["camera.nose_mm", "noise_mm"]);
    check(
        &depal(&["run", "--set", "camera.noise_mm"]),
        2,
        &["KEY=VALUE"],
    );
}

#[test]
fn a_wrong_urdf_is_named_with_file_and_element() {
    let good = fs::read_to_string(root().join("urdf/abb_irb6700_150_320.urdf")).expect("our URDF");
    let cycle = good.replacen("<parent link=\"base_link\"", "<parent link=\"link_3\"", 1);
    assert_ne!(cycle, good);
    let path = file("cycle.urdf", &cycle);
    let output = depal(&["run", "--set", &format!("robot.urdf={path}")]);
    check(&output, 2, &["cycle.urdf"]);
    check(&depal(&["check", &path]), 2, &["cycle.urdf"]);

    let limit = good.find("upper=\"").expect("a limit") + "upper=\"".len();
    let end = limit + good[limit..].find('"').expect("its end");
    let nan = format!("{}NaN{}", &good[..limit], &good[end..]);
    let path = file("nan.urdf", &nan);
    check(&depal(&["check", &path]), 2, &["nan.urdf", "limit"]);
}

#[test]
fn a_missing_endif_is_shown_with_its_line() {
    let program =
        "MODULE m\n  PROC main()\n    IF TRUE THEN\n      TPWrite \"x\";\n  ENDPROC\nENDMODULE\n";
    let path = file("endif.mod", program);
    let output = depal(&["run", "--set", &format!("robot.program={path}")]);
    check(&output, 2, &["endif.mod:", "ENDIF", "IF TRUE THEN"]);
    check(&depal(&["check", &path]), 2, &["endif.mod:", "ENDIF"]);
}

#[test]
fn good_files_pass_the_check() {
    let output = depal(&[
        "check",
        "scenes/demo.toml",
        "urdf/abb_irb6700_150_320.urdf",
        "scenes/demo.mod",
        "assets/rapid/MM_Module.mod",
    ]);
    check(&output, 0, &[]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(text.matches(": good").count(), 4, "{text}");
}

#[test]
fn an_unwritable_folder_is_exit_code_3() {
    let blocker = file("blocker", "a file where a folder should be");
    let output = depal(&["run", "--out", &format!("{blocker}/run")]);
    check(&output, 3, &["blocker", "--out"]);
}

#[test]
fn a_missing_recording_is_named() {
    check(
        &depal(&["replay", "nowhere.rrd"]),
        2,
        &["nowhere.rrd", "depal run"],
    );
}

#[test]
fn faults_on_demand_change_a_run() {
    let run = |name: &str, faults: &[&str]| {
        let out = folder(name).to_string_lossy().into_owned();
        let fixed = [
            "run",
            "scenes/interface.toml",
            "--no-recording",
            "--out",
            &out,
        ];
        depal(&[&fixed, faults].concat())
    };
    check(&run("faultless", &[]), 0, &[]);
    let fault = "status=1019@command=102,n=1";
    check(&run("faulty", &["--inject", fault]), 1, &["status 1019"]);
    check(
        &run("misspelt", &["--inject", "split_reply"]),
        2,
        &[
            "--inject: fault \"split_reply\"",
            "did you mean \"split_replies\"?",
        ],
    );
}

/// As in `depal run 2>&1 | head -1`: the results are there although nobody listens any more.
#[test]
fn who_closes_the_pipe_loses_lines_and_no_results() {
    let out = folder("closed-pipe");
    let (reading, writing) = std::io::pipe().expect("a pipe");
    drop(reading);
    let status = Command::new(env!("CARGO_BIN_EXE_depal"))
        .args(["run", "scenes/interface.toml", "--out"])
        .arg(&out)
        .current_dir(root())
        .stdout(writing.try_clone().expect("a second end"))
        .stderr(writing)
        .status()
        .expect("the binary starts");
    assert_eq!(status.code(), Some(0));
    let report = fs::read_to_string(out.join("report.json")).expect("the report");
    assert!(report.contains("\"interface\""));
}

/// Slips of the hand, and what the answer must name: what is wrong, where, and what to do.
#[test]
fn slips_are_answered_with_what_to_do() {
    let told = |args: &[&str], needles: &[&str]| check(&depal(args), 2, needles);
    let cannot = "cannot read the scene: No such file or directory";
    told(
        &["run", "demo"],
        &[
            cannot,
            "did you mean \"scenes/demo.toml\"?",
            "help: without a file",
        ],
    );
    told(
        &["run", "nope.toml"],
        &[cannot, "there are ", "scenes/kuka.toml", "`depal init DIR`"],
    );
    told(
        &["serve", "scenes/demp.toml"],
        &["did you mean \"scenes/demo.toml\"?"],
    );
    told(
        &["run", "scenes/demo.mod"],
        &["expected a scene (.toml), found a RAPID program"],
    );
    told(
        &["exec", "scenes/demo.toml"],
        &["a scene runs with `depal run`"],
    );
    told(
        &["exec", "demo.mod"],
        &["did you mean \"scenes/demo.mod\"?"],
    );
    told(
        &["exec", "scenes/demo.mod"],
        &[
            "named MM_",
            "help: the MM_ procedures stand in MM_Module.mod",
        ],
    );
    told(
        &["check", "scenes/kuka.src", "scenes/kuka.dat"],
        &["assets/krl/mm_module.src"],
    );
    told(
        &["run", "--seed", "abc"],
        &["'abc' for '--seed <N>'", "a whole number of 0 to"],
    );
    told(
        &["run", "--seed", "-1"],
        &["'-1' for '--seed <N>'", "a whole number of 0 to"],
    );
    told(
        &["run", "--set", "cartons.size_mm=[0,0,0]"],
        &[
            "error: --set cartons.size_mm=[0,0,0]: cartons.size_mm[0]",
            "error: --set cartons.size_mm=[0,0,0]: cartons.size_mm[2]",
        ],
    );
    told(
        &["run", "--set", "robot.program=scenes/demmo.mod"],
        &["did you mean \"scenes/demo.mod\"?"],
    );
    told(
        &["run", "--set", "robot.urdf=urdfs/arm.urdf"],
        &["there is no folder urdfs"],
    );
    told(
        &["serve", "--listen", "ascii=127.0.0.1:99999"],
        &["expected a port of 0 to 65535, found 99999"],
    );
    let listing = file(
        "copy.ls",
        &fs::read_to_string(root().join("scenes/fanuc.ls")).expect("a listing"),
    );
    told(
        &["exec", &listing],
        &[
            "there is no program COPY to start",
            "the first program here is FANUC",
        ],
    );
}
