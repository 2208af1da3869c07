//! Files: which names they know of each other, and the values of data lists.

use depal_krl::load;

use crate::fake_system::*;

#[test]
fn source_and_data_of_one_name_are_one_module() {
    let data = "&ACCESS RVP\nDEFDAT main PUBLIC\n;FOLD EXTERNAL DECLARATIONS;%{PE}%MKUKATPBASIS\nEXT BAS(BAS_COMMAND:IN, REAL:IN)\n;ENDFOLD\nDECL INT n=3\nDECL E6POS XP1={X 1.5,Y 2.0,Z 3.0,A 0.0,B 90.0,C 0.0,S 6,T 27,E1 0.0}\nDECL CHAR name[10]\nname[]=\"abc\"\nDECL REAL w[2,2]\nw[2,1]=-4\nENDDAT";
    let source = "&ACCESS RVP\n&REL 1\nDEF main( )\nMsgNotify(\"%1 %2 %3\", n, name[], w[2,1])\nMsgNotify(\"%1 %2\", XP1.X, XP1.T)\nEND";
    assert_eq!(
        run_files(&[("main.src", source), ("main.dat", data)]),
        ["3 abc -4", "1.5 27"]
    );
}

#[test]
fn data_of_another_module_are_seen_if_they_are_global() {
    let main = "DEF main( )\nMsgNotify(\"%1\", shared)\nEND";
    let global = "DEFDAT other PUBLIC\nDECL GLOBAL INT shared=5\nENDDAT";
    assert_eq!(
        run_files(&[("main.src", main), ("other.dat", global)]),
        ["5"]
    );
    let hidden = global.replace("GLOBAL ", "");
    let files = sources(&[("main.src", main), ("other.dat", &hidden)]);
    let loaded = load(&files, &signals(), "main");
    assert!(
        loaded.diagnostics[0]
            .message
            .contains("shared is not declared")
    );
    let configuration = hidden.replace("other", "$CONFIG");
    assert_eq!(
        run_files(&[("main.src", main), ("$config.dat", &configuration)]),
        ["5"]
    );
}

#[test]
fn the_tool_table_of_the_configuration_is_the_one_bas_uses() {
    let configuration = "DEFDAT $CONFIG\nDECL FRAME TOOL_DATA[16]\nTOOL_DATA[3]={X 0.0,Y 0.0,Z 55.0,A 0.0,B 0.0,C 0.0}\nENDDAT";
    let main = "DEF main( )\nBAS(#TOOL,3)\nMsgNotify(\"%1\", $TOOL.Z)\nEND";
    assert_eq!(
        run_files(&[("main.src", main), ("$config.dat", configuration)]),
        ["55"]
    );
}

#[test]
fn the_first_routine_and_global_ones_are_known_to_other_files() {
    let main = "DEF main( )\nhelp( )\nmore( )\nEND";
    let other = "DEF help( )\nown( )\nEND\nDEF own( )\nMsgNotify(\"own\")\nEND\nGLOBAL DEF more( )\nMsgNotify(\"more\")\nEND";
    assert_eq!(
        run_files(&[("main.src", main), ("help.src", other)]),
        ["own", "more"]
    );
    let hidden = other.replace("GLOBAL ", "");
    let files = sources(&[("main.src", main), ("help.src", &hidden)]);
    let loaded = load(&files, &signals(), "main");
    assert!(
        loaded.diagnostics[0]
            .message
            .contains("no routine named more")
    );
}

#[test]
fn data_keep_their_values_between_calls() {
    let main = "DEF main( )\nsub( )\nsub( )\nMsgNotify(\"%1\", n)\nEND\nDEF sub( )\nn = n + 1\nEND";
    let data = "DEFDAT main\nINT n=0\nENDDAT";
    let files = [("main.src", main), ("main.dat", data)];
    assert_eq!(run_files(&files), ["2"]);
    let mut system = FakeSystem::default();
    let mut machine = machine(&files);
    run(&mut machine, &mut system);
    assert_eq!(global(&machine, "n"), depal_vm::Value::Int(2));
}

#[test]
fn types_of_one_module_are_used_in_another() {
    let types = "DEFDAT types PUBLIC\nGLOBAL ENUM SIDE LEFT, RIGHT\nGLOBAL STRUC JOB INT n, SIDE s\nDECL GLOBAL JOB next={n 4, s #RIGHT}\nENDDAT";
    let main = "DEF main( )\nDECL JOB j\nj = next\nIF j.s == #RIGHT THEN\nMsgNotify(\"%1\", j.n)\nENDIF\nEND";
    assert_eq!(
        run_files(&[("main.src", main), ("types.dat", types)]),
        ["4"]
    );
}

#[test]
fn a_submit_program_does_not_wait_for_the_arm() {
    let text = "DEF main( )\n$OUT[1] = TRUE\nEND";
    for (name, expected) in [("main.sub", "0.000"), ("main.src", "0.100")] {
        let mut system = FakeSystem::default();
        let joints = depal_frames::JointPositions::zeros(6);
        let begin = depal_time::SimTime::ZERO;
        system.moves.push(Motion {
            begin,
            end: begin + depal_time::SimDuration::from_millis(100),
            to: joints,
            events: Vec::new(),
        });
        let mut machine = machine(&[(name, text)]);
        run(&mut machine, &mut system);
        assert_eq!(system.trace, [format!("{expected} $OUT[1] = 1")]);
    }
    let moves = run_files(&[("main.sub", "DEF main( )\nPTP XHOME\nEND")]);
    assert!(moves[0].contains("cannot move the arm"), "{moves:?}");
}

#[test]
fn another_program_can_be_the_entry() {
    let files = sources(&[
        ("a.src", "DEF a( )\nEND"),
        ("b.sub", "DEF b( )\nLOOP\nENDLOOP\nEND"),
    ]);
    assert!(load(&files, &[], "b").program.is_some());
    let missing = load(&files, &[], "c");
    assert!(missing.diagnostics[0].message.contains("no program c"));
}

/// Programs of the same files share their data as soon as one of them is for the submit interpreter.
#[test]
fn a_submit_program_shares_the_data_of_the_robot_program() {
    let data = (
        "main.dat",
        "DEFDAT main PUBLIC\nDECL GLOBAL INT level=3\nENDDAT",
    );
    let main = ("main.src", "DEF main( )\nlevel = 4\nEND");
    let submit = ("watch.sub", "DEF watch( )\nlevel = 5\nEND");
    let shared = |files: &[(&str, &str)], entry: &str| {
        let loaded = load(&sources(files), &[], entry);
        loaded.program.expect("no errors").shared.clone()
    };
    assert!(shared(&[main, data], "main").is_empty());
    let files = [main, data, submit];
    let (robot, watch) = (shared(&files, "main"), shared(&files, "watch"));
    assert_eq!(robot, watch);
    let named = |name: &str| robot.iter().any(|datum| datum.name.starts_with(name));
    assert!(named("level,") && named("flags,") && named("timers,"));
    assert!(!named("moves under way,") && !named("channels,"));
    let slots = robot.iter().map(|datum| datum.global as usize);
    assert_eq!(slots.min(), Some(depal_krl::OWN_GLOBALS));
}
