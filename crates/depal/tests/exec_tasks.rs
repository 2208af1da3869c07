//! `depal exec` and `depal check` with a folder: all modules and configurations of a task, or of a whole backup.
#![allow(missing_docs)]

use robot_program::{depal, folder, json, stderr, stdout};

mod robot_program;

/// A task folder: program list, modules, configurations, and a module that is not in the list.
#[test]
fn a_folder_is_a_task() {
    let list = "<?xml version=\"1.0\"?>\n<Program>\n <Module>main.mod</Module>\n <Module>part.mod</Module>\n</Program>\n";
    let main = "MODULE main_m\n  PROC watch_all()\n    helper;\n    SetDO do_x, 1;\n    SetDO DO_X, 0;\n  ENDPROC\nENDMODULE\n";
    let part = "MODULE part_m\n  PROC helper()\n    TPWrite greeting;\n  ENDPROC\n  PROC at_start()\n    TPWrite \"event\";\n  ENDPROC\nENDMODULE\n";
    let system = "MODULE user_sys(SYSMODULE)\n  CONST string greeting := \"hello\";\nENDMODULE\n";
    let eio = "EIO:CFG_1.0:6:1::\n#\nEIO_SIGNAL:\n -Name \"do_x\" -SignalType \"DO\"\n";
    let sys = "SYS:CFG_1.0:6:0::\n#\nCAB_TASKS:\n -Name \"T_CELL\" -Type \"NORMAL\" -Entry \"watch_all\" -MotionTask\n#\nCAB_EXEC_HOOKS:\n -Routine \"at_start\" -Shelf \"START\"\n";
    let unlisted = "MODULE broken\n  PROC helper()\n    no_such_thing;\n  ENDPROC\nENDMODULE\n";
    let folder = folder(
        "task",
        &[
            ("cell.pgf", list),
            ("main.mod", main),
            ("part.mod", part),
            ("user.sys", system),
            ("unlisted.mod", unlisted),
            ("EIO.cfg", eio),
            ("SYS.cfg", sys),
            ("MOC.cfg", "MOC:CFG_1.0:6:0::\n#\n"),
        ],
    );
    let checked = depal(&folder, &["check", "--json", "."]);
    assert_eq!(checked.status.code(), Some(0), "{}", stderr(&checked));
    let paths: Vec<_> = json(&checked)["files"]
        .as_array()
        .expect("files")
        .iter()
        .map(|file| file["path"].as_str().expect("a path").replace("./", ""))
        .collect();
    for name in [
        "cell.pgf", "main.mod", "part.mod", "user.sys", "EIO.cfg", "SYS.cfg", "MOC.cfg",
    ] {
        assert!(paths.iter().any(|path| path == name), "{name} in {paths:?}");
    }
    assert!(!paths.iter().any(|path| path == "unlisted.mod"));
    let output = depal(&folder, &["exec", "."]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stdout(&output), "event\nhello\n");
    // A signal that the folder's EIO.cfg does not define is an error of the check, with the mend.
    std::fs::write(
        folder.join("part.mod"),
        part.replace("TPWrite greeting", "SetDO do_y, 1"),
    )
    .expect("written");
    let checked = depal(&folder, &["check", "."]);
    assert_eq!(checked.status.code(), Some(2));
    assert!(stderr(&checked).contains("do_x"), "{}", stderr(&checked));
    // A mistake in a configuration is told with its line.
    std::fs::write(folder.join("EIO.cfg"), eio.replace("\"DO\"", "\"DQ\"")).expect("written");
    let document = json(&depal(&folder, &["check", "--json", "EIO.cfg"]));
    assert_eq!(document["files"][0]["diagnostics"][0]["line"], 4);
    assert_eq!(depal(&folder, &["exec", "."]).status.code(), Some(2));
}

/// A controller backup: modules below RAPID, configurations below SYSPAR, files of the program below HOME.
#[test]
fn a_backup_is_a_task() {
    let main = "MODULE m\n  VAR iodev f;\n  PROC main()\n    Open \"HOME:/in.txt\", f\\Read;\n    TPWrite ReadStr(f);\n    Close f;\n  ENDPROC\nENDMODULE\n";
    let folder = folder("backup", &[]);
    for (path, text) in [
        ("RAPID/TASK1/PROGMOD/m.mod", main),
        (
            "RAPID/TASK2/PROGMOD/other.mod",
            "MODULE other\nPROC main()\nENDPROC\nENDMODULE\n",
        ),
        ("HOME/in.txt", "from home\n"),
        ("HOME/stray.mod", "no module"),
        ("SYSPAR/EIO.cfg", "EIO:CFG_1.0:6:1::\n"),
    ] {
        let path = folder.join(path);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::fs::write(path, text).expect("written");
    }
    let output = depal(&folder, &["exec", "."]);
    assert_eq!(stdout(&output), "from home\n", "{}", stderr(&output));
    assert_eq!(depal(&folder, &["check", "."]).status.code(), Some(0));
}

/// A backup of two tasks that share data: both run, and routines of events before them.
#[test]
fn a_backup_runs_all_tasks_of_its_configuration() {
    let main = "MODULE m\n  PERS num level := 1;\n  PROC main()\n    WaitUntil level > 1;\n    TPWrite \"level \"\\Num:=level;\n    Stop;\n  ENDPROC\n  PROC lights()\n    TPWrite \"lights\";\n  ENDPROC\n  PROC halt()\n    TPWrite \"halt\";\n  ENDPROC\nENDMODULE\n";
    let side = "MODULE side\n  PERS num level := 1;\n  PROC watch()\n    WaitTime 0.5;\n    level := 4;\n  ENDPROC\nENDMODULE\n";
    let sys = "SYS:CFG_1.0:6:0::\n#\nCAB_TASKS:\n -Name \"T_WATCH\" -Type \"STATIC\" -Entry \"watch\"\n -Name \"T_ROB1\" -Type \"NORMAL\" -MotionTask\n#\nCAB_EXEC_HOOKS:\n -Routine \"lights\" -Shelf \"POWER_ON\"\n -Routine \"halt\" -Shelf \"STOP\" -Task \"T_ROB1\"\n";
    let folder = folder("two_tasks", &[]);
    let write = |path: &str, text: &str| {
        let path = folder.join(path);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::fs::write(path, text).expect("written");
    };
    write("RAPID/TASK1/PROGMOD/side.mod", side);
    write("RAPID/TASK2/PROGMOD/m.mod", main);
    write("SYSPAR/SYS.cfg", sys);
    let output = depal(&folder, &["exec", "."]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stdout(&output), "lights\nlevel 4\nhalt\n");
    assert_eq!(depal(&folder, &["check", "."]).status.code(), Some(0));
    // One task alone: nobody raises the level.
    let alone = depal(&folder, &["exec", ".", "--task", "2", "--json"]);
    assert_eq!(json(&alone)["end"], "idle", "{}", stderr(&alone));
    // The tasks are named by the list of contents where it is there, and a difference is told.
    write(
        "RAPID/TASK1/PROGMOD/side.mod",
        &side.replace(":= 1", ":= 9"),
    );
    write(
        "BACKINFO/backinfo.txt",
        ">>TASK1: (T_WATCH,,)\nPROGMOD/side.mod\n>>TASK2: (T_ROB1,,)\nPROGMOD/m.mod\n",
    );
    let checked = depal(&folder, &["check", "."]);
    assert_eq!(checked.status.code(), Some(0));
    assert!(
        stderr(&checked).contains("level has another initial value in task T_ROB1"),
        "{}",
        stderr(&checked)
    );
    let output = depal(&folder, &["exec", "."]);
    assert_eq!(stdout(&output), "lights\nlevel 4\nhalt\n");
    assert!(
        stderr(&output).contains("level has another initial value in task T_WATCH"),
        "{}",
        stderr(&output)
    );
}
