//! Several tasks in one cabinet: shared data, meeting points, event routines, what belongs to the motion task alone.

use depal_controller::{
    Controller, ControllerEvent, ControllerSpec, ControllerState, NoNetwork, TaskRole,
};
use depal_rapid::{TaskEntry, TaskEvent};
use depal_time::SimTime;
use depal_vm::system::LogKind;

use crate::harness::{Told, drive, machine_of, signals};

/// A module with data and a main.
pub(crate) fn module(name: &str, data: &str, main: &str) -> String {
    format!("MODULE {name}\n{data}\nPROC main()\n{main}\nENDPROC\nENDMODULE\n")
}

/// A cabinet with a task that moves the arm and one that does not.
fn cabinet(tasks: &[(TaskRole, String)]) -> Controller {
    let mut spec = ControllerSpec::without_arm("rob1");
    spec.signals = signals();
    let mut controller = Controller::without_arm(spec).expect("a cabinet");
    for (role, text) in tasks {
        let machine = machine_of(&role.name, text, &TaskEntry::new("main"));
        let machine = if role.is_background {
            machine.cyclic()
        } else {
            machine.single_cycle()
        };
        controller.add_task(role.clone(), Box::new(machine));
    }
    controller
}

fn two(first: String, second: String) -> Controller {
    cabinet(&[
        (TaskRole::motion("T_ROB1"), first),
        (
            TaskRole {
                moves_arm: false,
                ..TaskRole::motion("T_SIDE")
            },
            second,
        ),
    ])
}

pub(crate) fn run(first: String, second: String) -> Told {
    drive(two(first, second), &[])
}

pub(crate) fn warnings(told: &Told) -> Vec<String> {
    let text = |event: &ControllerEvent| match event {
        ControllerEvent::Log {
            kind: LogKind::EventLog,
            text,
            ..
        } => Some(text.clone()),
        _ => None,
    };
    told.events.iter().filter_map(text).collect()
}

#[test]
fn a_lock_lets_one_task_in_at_a_time() {
    let data = "PERS bool taken := FALSE;\nPERS num inside := 0;\nPERS num done := 0;";
    let body = "FOR i FROM 1 TO 20 DO\n{lock}\nIncr inside;\nIF inside > 1 TPWrite \"both\";\nWaitTime 0.01;\nDecr inside;\nIncr done;\ntaken := FALSE;\nENDFOR\nWaitUntil done = 40;\nTPWrite \"all\";";
    for lock in [
        "WaitUntil TestAndSet(taken);",
        "WaitTestAndSet taken;",
        "WHILE TestAndSet(taken) = FALSE DO\nENDWHILE",
    ] {
        let text = |name: &str| module(name, data, &body.replace("{lock}", lock));
        let told = run(text("a"), text("b")).finished();
        assert_eq!(told.lines, ["all", "all"], "{lock}");
    }
    // Without the lock both are inside: the test can fail.
    let text = |name: &str| module(name, data, &body.replace("{lock}", ""));
    assert!(run(text("a"), text("b")).lines.contains(&"both".to_owned()));
}

#[test]
fn tasks_wait_for_each_other_at_a_meeting_point() {
    let data = "PERS tasks all{2} := [[\"T_ROB1\"],[\"T_SIDE\"]];\nVAR syncident here;\nVAR syncident there;";
    let told = run(
        module(
            "a",
            data,
            "TPWrite \"a1\";\nWaitSyncTask here, all;\nTPWrite \"a2\";\nWaitSyncTask there, all;\nTPWrite \"a3\";",
        ),
        module(
            "b",
            data,
            "WaitTime 1;\nTPWrite \"b1\";\nWaitSyncTask here, all;\nTPWrite \"b2\";\nWaitTime 1;\nTPWrite \"b3\";\nWaitSyncTask there, all;",
        ),
    )
    .finished();
    assert_eq!(told.lines, ["a1", "b1", "b2", "a2", "b3", "a3"]);
}

#[test]
fn a_meeting_that_does_not_come_about_is_an_error() {
    let data = "PERS tasks all{2} := [[\"T_ROB1\"],[\"T_SIDE\"]];\nVAR syncident here;";
    let told = run(
        module("a", data, "WaitSyncTask here, all \\TimeOut:=0.5;"),
        module("b", data, "WaitTime 2;"),
    );
    assert_eq!(told.failure(), ("ERR_WAITSYNCTASK".to_owned(), 5));
    let told = run(
        module(
            "a",
            &data.replace("T_SIDE", "T_SIDO"),
            "WaitSyncTask here, all;",
        ),
        module("b", "", "WaitTime 1;"),
    );
    let ControllerState::Failed(error) = &told.state else {
        panic!("{:?}", told.state)
    };
    assert!(error.message.contains("T_SIDO"), "{}", error.message);
}

#[test]
fn a_change_by_another_task_is_an_interrupt() {
    let told = run(
        "MODULE a\nPERS num level := 0;\nVAR intnum i;\nPROC main()\nCONNECT i WITH changed;\nIPers level, i;\nWaitTime 1;\nENDPROC\nTRAP changed\nTPWrite \"level \"\\Num:=level;\nENDTRAP\nENDMODULE\n".to_owned(),
        module(
            "b",
            "PERS num level := 0;",
            "WaitTime 0.2;\nlevel := 4;\nWaitTime 0.2;\nlevel := 4;\nWaitTime 0.2;\nlevel := 5;",
        ),
    )
    .finished();
    assert_eq!(told.lines, ["level 4", "level 5"]);
}

#[test]
fn only_the_motion_task_moves() {
    let told = run(
        module("a", "", "WaitTime 1;"),
        module(
            "b",
            "",
            "TPWrite \"b\";\nMoveAbsJ [[10,0,0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v100, fine, tool0;",
        ),
    );
    let ControllerState::Failed(error) = &told.state else {
        panic!("{:?}", told.state)
    };
    assert!(error.message.contains("task T_SIDE"), "{}", error.message);
    assert_eq!(error.call_stack[0].line, 5);
    let ask = "VAR num n;\nPROC main()\nVAR string s;\ns := GetTaskName(\\TaskNo:=n);\nIF TaskRunMec() TPWrite \"mec\";\nTPWrite s+\" \"\\Num:=n;";
    let text = |name: &str| format!("MODULE {name}\n{ask}\nENDPROC\nENDMODULE\n");
    let told = run(text("a"), text("b")).finished();
    // The task that says less is ready sooner: lines come in the order of their times.
    assert_eq!(told.lines, ["mec", "T_SIDE 2", "T_ROB1 1"]);
}

#[test]
fn a_failure_in_the_background_stops_all_unless_it_is_said_otherwise() {
    let main = module("a", "", "WaitTime 0.5;\nTPWrite \"done\";");
    let bad = module("b", "VAR num x;", "WaitTime 0.1;\nx := 1 / x;");
    let tasks = |stops_all| {
        [
            (TaskRole::motion("T_ROB1"), main.clone()),
            (
                TaskRole {
                    stops_all,
                    ..TaskRole::background("T_BACK")
                },
                bad.clone(),
            ),
        ]
    };
    let told = drive(cabinet(&tasks(true)), &[]);
    assert_eq!(told.failure().0, "ERR_DIVZERO");
    assert!(told.lines.is_empty());
    let told = drive(cabinet(&tasks(false)), &[]).finished();
    assert_eq!(told.lines, ["done"]);
}

#[test]
fn the_background_begins_anew_and_holds_nobody_up() {
    let back = module("b", "PERS num rounds := 0;", "Incr rounds;\nWaitTime 0.1;");
    let main = module(
        "a",
        "PERS num rounds := 0;",
        "WaitTime 1;\nIF rounds > 5 TPWrite \"many\";",
    );
    let told = drive(
        cabinet(&[
            (TaskRole::motion("T_ROB1"), main),
            (TaskRole::background("T_BACK"), back),
        ]),
        &[],
    )
    .finished();
    assert_eq!(told.lines, ["many"]);
}

#[test]
fn two_tasks_that_wait_for_each_other_wait_for_ever() {
    let text = |name: &str| module(name, "PERS bool x := FALSE;", "WaitUntil x;");
    let told = run(text("a"), text("b"));
    assert!(told.waits_for_ever);
    // One that changes what the other waits for, and then waits itself, does not keep it waiting.
    let told = run(
        module(
            "a",
            "PERS bool x := FALSE;",
            "WaitUntil x;\nTPWrite \"on\";",
        ),
        module(
            "b",
            "PERS bool x := FALSE;",
            "x := TRUE;\nWaitUntil x = FALSE;",
        ),
    );
    assert_eq!(told.lines, ["on"]);
}

#[test]
fn two_runs_of_several_tasks_are_equal() {
    let data = "PERS num a{3} := [1,2,3];\nPERS bool taken := FALSE;";
    let body = "FOR i FROM 1 TO 30 DO\nWaitUntil TestAndSet(taken);\na{1} := a{1} * 1.1 + a{2};\na{2} := a{3} - a{1} / 3;\ntaken := FALSE;\nSetDO do1, i MOD 2;\nTPWrite ValToStr(a);\nENDFOR";
    let run = || run(module("x", data, body), module("y", data, body)).finished();
    assert_eq!(run().events, run().events);
}

/// One task alone gives the same whether it is set or added.
#[test]
fn a_second_task_that_does_nothing_changes_nothing() {
    let main = module(
        "a",
        "PERS num x := 1;",
        "FOR i FROM 1 TO 500 DO\nx := x + i;\nIF i MOD 100 = 0 WaitTime 0.01;\nENDFOR\nTPWrite \"x\"\\Num:=x;",
    );
    let alone = drive(cabinet(&[(TaskRole::motion("T_ROB1"), main.clone())]), &[]).finished();
    let both = run(main, module("b", "PERS num x := 1;", "WaitTime 0.001;")).finished();
    let own = |told: &Told| -> Vec<String> {
        let of_side = |e: &&ControllerEvent| !format!("{e:?}").contains("T_SIDE");
        told.events
            .iter()
            .filter(of_side)
            .map(|e| format!("{e:?}"))
            .collect()
    };
    assert_eq!(own(&alone), own(&both));
}

#[test]
fn event_routines_run_when_their_event_comes() {
    let text = "MODULE m\nPROC main()\nTPWrite \"main\";\nStop;\nTPWrite \"on\";\nENDPROC\nPROC power()\nTPWrite \"power\";\nENDPROC\nPROC start()\nTPWrite \"start\";\nENDPROC\nPROC halt()\nTPWrite \"halt\";\nENDPROC\nPROC again()\nTPWrite \"again\";\nENDPROC\nENDMODULE\n";
    let entry = TaskEntry {
        main: "main",
        events: vec![
            (TaskEvent::BeforeStart, "power", true),
            (TaskEvent::BeforeStart, "start", true),
            (TaskEvent::Stop, "halt", true),
            (TaskEvent::Restart, "again", true),
            (TaskEvent::Restart, "missing", false),
        ],
    };
    let mut controller = Controller::without_arm(ControllerSpec::without_arm("rob1")).expect("one");
    let machine = machine_of("T_ROB1", text, &entry).single_cycle();
    controller.add_task(TaskRole::motion("T_ROB1"), Box::new(machine));
    let lines = |controller: &mut Controller, at: SimTime| -> Vec<String> {
        controller.tick(at, &mut NoNetwork);
        let text = |event| match event {
            ControllerEvent::Log { text, .. } => Some(text),
            _ => None,
        };
        std::iter::from_fn(|| controller.poll_event())
            .filter_map(text)
            .collect()
    };
    let first = lines(&mut controller, SimTime::ZERO);
    assert_eq!(first, ["power", "start", "main", "halt"]);
    assert!(matches!(controller.state(), ControllerState::Stopped(_)));
    assert!(controller.restart());
    let second = lines(&mut controller, SimTime::from_nanos(4_000_000));
    assert_eq!(second, ["again", "on"]);
    assert_eq!(*controller.state(), ControllerState::Finished);
    assert!(
        !controller.restart(),
        "a program that has ended does not go on"
    );
}

/// EXIT gives the program up: nothing runs at it, and it cannot go on. An event routine's error is nobody's to handle.
#[test]
fn exit_is_no_stop_and_errors_of_events_are_fatal() {
    let text = "MODULE m\nPROC main()\nEXIT;\nERROR\nTPWrite \"handled\";\nENDPROC\nPROC halt()\nTPWrite \"halt\";\nENDPROC\nPROC bad()\nVAR num x;\nx := 1/x;\nENDPROC\nENDMODULE\n";
    let run = |events: Vec<(TaskEvent, &str, bool)>| {
        let entry = TaskEntry {
            main: "main",
            events,
        };
        let mut controller =
            Controller::without_arm(ControllerSpec::without_arm("rob1")).expect("one");
        let machine = machine_of("T_ROB1", text, &entry).single_cycle();
        controller.add_task(TaskRole::motion("T_ROB1"), Box::new(machine));
        let told = drive(controller, &[]);
        (told.state, told.lines)
    };
    let (state, lines) = run(vec![(TaskEvent::Stop, "halt", true)]);
    assert_eq!(state, ControllerState::Stopped("EXIT".into()));
    assert!(lines.is_empty());
    let (state, lines) = run(vec![(TaskEvent::BeforeStart, "bad", true)]);
    assert!(matches!(state, ControllerState::Failed(_)), "{state:?}");
    assert!(lines.is_empty());
}

const IN_STEP: &str = "PERS tasks all{2} := [[\"T_ROB1\"],[\"T_SIDE\"]];\nVAR syncident on;\nVAR syncident off;\nFUNC string mode()\nIF IsSyncMoveOn() RETURN \" in step\";\nRETURN \" alone\";\nENDFUNC";

/// The tasks meet where they begin and where they end to move in step; the cabinet has one arm, so one of them moves.
#[test]
fn tasks_that_move_in_step_meet_at_both_ends() {
    let told = run(
        module(
            "a",
            IN_STEP,
            "TPWrite \"a\" + mode();\nSyncMoveOn on, all;\nTPWrite \"a\" + mode();\nWaitTime 1;\nSyncMoveOff off;\nTPWrite \"a\" + mode();",
        ),
        module(
            "b",
            IN_STEP,
            "WaitTime 0.5;\nTPWrite \"b\";\nSyncMoveOn on, all;\nWaitTime 0.2;\nTPWrite \"b waits\";\nSyncMoveOff off;\nWaitTime 0.1;\nTPWrite \"b\" + mode();",
        ),
    )
    .finished();
    assert_eq!(
        told.lines,
        ["a alone", "b", "a in step", "b waits", "a alone", "b alone"]
    );
}

#[test]
fn moving_in_step_that_does_not_come_about_is_an_error() {
    let rest = module("b", IN_STEP, "WaitTime 2;");
    let late = module("a", IN_STEP, "SyncMoveOn on, all \\TimeOut:=0.5;");
    assert_eq!(run(late, rest.clone()).failure().0, "ERR_SYNCMOVEON");
    let never = module("a", IN_STEP, "SyncMoveOff off;");
    assert_eq!(run(never, rest).failure().0, "ERR_SYNCMOVEOFF");
    // Undone, it can begin anew, and nobody is waited for.
    let undone = "SyncMoveOn on, all;\nSyncMoveUndo;\nTPWrite \"a\" + mode();";
    let told = run(
        module("a", IN_STEP, undone),
        module("b", IN_STEP, "SyncMoveOn on, all;\nSyncMoveUndo;"),
    )
    .finished();
    assert_eq!(told.lines, ["a alone"]);
}
