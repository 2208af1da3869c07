use crate::harness::*;

fn left(told: &Told, seconds: f64) -> f64 {
    (told.end() - told.at(seconds)).norm()
}

#[test]
fn an_output_fires_so_far_before_the_target() {
    let told = run("TriggIO trigg,100\\DOp:=do1,1;\nTriggL Offs(p0,400,0,0),v500,trigg,fine,tTool;\nSetDO do2,1;").finished();
    let (edge, reached) = (told.edge("do1"), told.edge("do2"));
    assert!((left(&told, edge) - 0.1).abs() < 1e-3);
    assert!(edge < reached - 0.15, "{edge} {reached}");
    // From the start.
    let told = run(
        "TriggIO trigg,100\\Start\\DOp:=do1,1;\nTriggL Offs(p0,400,0,0),v500,trigg,fine,tTool;",
    )
    .finished();
    assert!((left(&told, told.edge("do1")) - 0.3).abs() < 1e-3);
}

#[test]
fn an_output_fires_so_long_before_the_target() {
    let told =
        run("TriggIO trigg,0.2\\Time\\DOp:=do1,1;\nTriggL Offs(p0,400,0,0),v500,trigg,fine,tTool;")
            .finished();
    let before = told.reached(3) - told.edge("do1");
    assert!((before - 0.2).abs() < 1e-6, "{before}");
}

#[test]
fn equipment_has_its_lag() {
    let place = |lag: &str| {
        let told = run(&format!("TriggEquip trigg,100,{lag}\\GOp:=go1,5;\nTriggL Offs(p0,400,0,0),v500,trigg,fine,tTool;")).finished();
        assert_eq!(told.edges("go1").len(), 1);
        assert_eq!(told.edges("go1")[0].1, 5.0);
        told.edge("go1")
    };
    let (none, early, late) = (place("0"), place("0.1"), place("-0.1"));
    assert!((none - early - 0.1).abs() < 1e-6);
    assert!((late - none - 0.1).abs() < 1e-6);
    let told = run("TriggEquip trigg,100,0\\DOp:=do1,1\\Inhib:=TRUE;\nTriggL Offs(p0,400,0,0),v500,trigg,fine,tTool;").finished();
    assert!(told.edges("do1").is_empty(), "inhibited: set to 0");
}

/// Several on one move, by distance: in the order of their places; joint and circular moves have them too.
#[test]
fn several_triggers_on_one_move() {
    let define = "TriggIO trigg,50\\DOp:=do1,1;\nTriggIO other,150\\AOp:=ao1,2.5;\n";
    for go in [
        "TriggL Offs(p0,400,0,0),v500,trigg\\T2:=other,fine,tTool;",
        "TriggJ Offs(p0,400,0,0),v500,trigg\\T2:=other,fine,tTool;",
        "TriggC Offs(p0,200,200,0),Offs(p0,400,0,0),v500,trigg\\T2:=other,fine,tTool;",
    ] {
        let told = run(&format!("{define}{go}")).finished();
        let (first, second) = (told.edge("ao1"), told.edge("do1"));
        assert!(first < second && second < told.reached(4), "{go}");
        assert_eq!(told.edges("ao1")[0].1, 2.5);
        // The chord of 50 mm of an arc is a little shorter.
        assert!((left(&told, second) - 0.05).abs() < 2e-3, "{go}");
    }
}

/// In a corner the middle is the end.
#[test]
fn triggers_of_fly_by_moves() {
    let told = run("TriggIO trigg,0\\DOp:=do1,1;\nTriggIO other,20\\Start\\DOp:=do2,1;\nTriggL Offs(p0,300,0,0),v300,trigg,z100,tTool;\nTriggL Offs(p0,300,300,0),v300,other,fine,tTool;").finished();
    let place = told.at(told.edge("do1")) - told.trace[0];
    assert!(
        (place.x - 0.3 + place.y).abs() < 5e-3,
        "on the bisector: {place}"
    );
    assert!(told.edge("do2") > told.edge("do1"));
    assert!(told.edge("do2") < told.reached(4));
}

#[test]
fn triggers_are_refused_where_they_are_wrong() {
    let told = run("TriggL Offs(p0,300,0,0),v300,trigg,fine,tTool;");
    assert_eq!(told.failure().1, 2);
    let told = run("TriggIO trigg,0.9\\Time\\DOp:=do1,1;");
    assert_eq!(told.failure().1, 2);
    let told =
        run("TriggIO trigg,10\\GOp:=go1,999;\nTriggL Offs(p0,300,0,0),v300,trigg,fine,tTool;");
    assert_eq!(told.failure(), ("ERR_SIG_NOT_VALID".to_owned(), 3));
}

const PASSED: &str = "TRAP passed\nTPWrite \"passed\";\nPulseDO do2;\nENDTRAP";

/// The trap runs while the arm goes on; a second move with the same data orders it again.
#[test]
fn an_interrupt_comes_at_a_place_of_the_path() {
    let define = "CONNECT iPassed WITH passed; TriggInt trigg,100,iPassed;\n";
    let go = "TriggL Offs(p0,400,0,0),v500,trigg,fine,tTool;\n";
    let told = run_with(&format!("{define}{go}TPWrite \"over\";"), PASSED, &[]).finished();
    assert_eq!(told.lines, ["passed", "over"]);
    // A program sees the path once a cycle: at most 4 ms or 2 mm later.
    let at = left(&told, told.edge("do2"));
    assert!((0.0975..=0.1001).contains(&at), "{at}");
    let twice = format!("{define}{go}{go}TriggL p0,v500,trigg,fine,tTool;");
    let told = run_with(&twice, PASSED, &[]).finished();
    assert_eq!(told.lines.len(), 3, "{:?}", told.lines);
    // Not tied to the move, asleep or deleted: no interrupt.
    let plain = format!("{define}MoveL Offs(p0,400,0,0),v500,fine,tTool;");
    assert!(run_with(&plain, PASSED, &[]).finished().lines.is_empty());
    let asleep = format!("{define}ISleep iPassed;\n{go}");
    assert!(run_with(&asleep, PASSED, &[]).finished().lines.is_empty());
}

/// Analogue values: the condition, the step and the direction each hold an interrupt back.
#[test]
fn an_interrupt_comes_at_a_level() {
    let inputs = [
        (0.1, "ai1", 2.0),
        (0.2, "ai1", 6.0),
        (0.3, "ai1", 6.5),
        (0.4, "ai1", 9.0),
        (0.5, "ai1", 3.0),
    ];
    let trap = "TRAP passed\nTPWrite ValToStr(AInput(ai1));\nENDTRAP";
    let lines = |order: &str| {
        let statements = format!("CONNECT iPassed WITH passed;\n{order}\nWaitTime 1;");
        run_with(&statements, trap, &inputs).finished().lines
    };
    let above = "ISignalAI ai1,AIO_ABOVE_HIGH,5,0,1,iPassed;";
    assert_eq!(lines(above), ["6", "9"]);
    assert_eq!(
        lines(&above.replace("ISignalAI ", "ISignalAI\\Single,")),
        ["6"]
    );
    assert_eq!(lines(&above.replace(",1,", ",0.1,")), ["6", "6.5", "9"]);
    assert_eq!(lines(&above.replace("ABOVE_HIGH,5", "BELOW_HIGH,5")), ["2"]);
    assert_eq!(
        lines("ISignalAI ai1,AIO_ALWAYS,5,0,1,iPassed;"),
        ["2", "6", "9", "3"]
    );
    assert_eq!(
        lines("ISignalAI ai1,AIO_ALWAYS,5,0,1\\DPos,iPassed;"),
        ["2", "6", "9"]
    );
    assert_eq!(
        lines("ISignalAI ai1,AIO_BETWEEN,7,6,0,iPassed;"),
        ["6", "6.5"]
    );
    assert_eq!(
        lines("ISignalAI ai1,AIO_OUTSIDE,7,3,0,iPassed;"),
        ["2", "9"]
    );
}

/// The interrupt comes only if the signal is not as it must be where the arm passes.
#[test]
fn a_signal_is_checked_at_a_place_of_the_path() {
    let check = "CONNECT iPassed WITH passed;\nTriggCheckIO trigg,100,di1,EQ,1,iPassed;\n";
    let go = "TriggL Offs(p0,400,0,0),v500,trigg,fine,tTool;\nTPWrite \"over\";";
    let program = format!("{check}{go}");
    let there = [(0.2, "di1", 1.0)];
    assert_eq!(
        run_with(&program, PASSED, &[]).finished().lines,
        ["passed", "over"]
    );
    assert_eq!(
        run_with(&program, PASSED, &there).finished().lines,
        ["over"]
    );
    // It is there, but goes before the arm passes.
    let gone = [(0.2, "di1", 1.0), (0.4, "di1", 0.0)];
    assert_eq!(
        run_with(&program, PASSED, &gone).finished().lines,
        ["passed", "over"]
    );
    for (relation, passes) in [
        ("NOTEQ", true),
        ("LT", true),
        ("GTEQ", false),
        ("GT", false),
    ] {
        let lines = run_with(
            &program.replace("EQ,1", &format!("{relation},1")),
            PASSED,
            &[],
        )
        .finished()
        .lines;
        assert_eq!(lines.len() == 1, passes, "{relation} {lines:?}");
    }
    let wrong = run_with(&program.replace("EQ,1", "7,1"), PASSED, &[]);
    assert_eq!(wrong.failure().0, "ERR_ARGVALERR");
}

/// With \StopMove the arm stops on its path at once, and StartMove in the trap lets it go on to its end.
#[test]
fn a_check_that_fails_stops_the_arm() {
    let program = "CONNECT iPassed WITH passed;\nTriggCheckIO trigg,200,di1,EQ,1\\StopMove,iPassed;\nTriggL Offs(p0,400,0,0),v500,trigg,fine,tTool;\nTPWrite \"over\";";
    let trap = "TRAP passed\nTPWrite \"waits\";\nWaitDI di1,1;\nStartMove;\nENDTRAP";
    let told = run_with(program, trap, &[(5.0, "di1", 1.0)]).finished();
    assert_eq!(told.lines, ["waits", "over"]);
    let (stands, later) = (told.at(2.0), told.at(4.9));
    assert!((stands - later).norm() < 1e-9);
    let left = (told.end() - later).norm();
    assert!((0.05..0.2).contains(&left), "{left}");
    // The signal is there: the arm does not stop.
    let told = run_with(program, trap, &[(0.1, "di1", 1.0)]).finished();
    assert_eq!(told.lines, ["over"]);
    assert!((told.end() - told.at(2.0)).norm() < 1e-6);
}

#[test]
fn outputs_of_arrays_fire_at_their_places() {
    let data = "VAR triggios ios{3} := [[TRUE,100,FALSE,0,\"do1\",1,0],[TRUE,100,TRUE,0,\"do2\",1,0],[FALSE,50,FALSE,0,\"nowhere\",1,0]];\nVAR triggstrgo gos{1} := [[TRUE,200,FALSE,0,\"go1\",\"42\",0]];";
    let go = "TriggLIOs Offs(p0,400,0,0),v500\\TriggData1:=ios\\TriggData2:=gos,fine,tTool;\nTPWrite ValToStr(GOutput(go1));";
    let told = run_with(go, data, &[]).finished();
    assert_eq!(told.lines, ["42"]);
    assert!((left(&told, told.edge("do1")) - 0.1).abs() < 1e-3);
    assert!((left(&told, told.edge("do2")) - 0.3).abs() < 1e-3);
    // A signal that is used and not there is an error at the line of the move.
    let told = run_with(go, &data.replace("FALSE,50", "TRUE,50"), &[]);
    assert_eq!(told.failure().0, "ERR_NO_ALIASIO_DEF");
}

/// A slow change adds up: it is compared with the value at the last interrupt, not with the one before.
#[test]
fn a_level_is_compared_with_that_of_the_last_interrupt() {
    let inputs: Vec<_> = (1..=9)
        .map(|i| (0.1 * f64::from(i), "ai1", 0.5 * f64::from(i)))
        .collect();
    let trap = "TRAP passed\nTPWrite ValToStr(AInput(ai1));\nENDTRAP";
    let statements =
        "CONNECT iPassed WITH passed;\nISignalAI ai1,AIO_ALWAYS,5,0,1,iPassed;\nWaitTime 1.2;";
    let told = run_with(statements, trap, &inputs).finished();
    assert_eq!(told.lines, ["1.5", "3", "4.5"]);
}
