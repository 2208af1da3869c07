use depal_controller::{Controller, ControllerSpec};

use crate::harness::*;

/// The arc of a half circle of radius 100 mm: its length at 200 mm/s, its points, its end.
#[test]
fn move_c_goes_through_its_circle_point() {
    let told = run("MoveC Offs(p0,100,100,0),Offs(p0,200,0,0),v200,fine,tTool;").finished();
    let begin = told.trace[0];
    let centre = begin + depal_frames::Vector::new(0.1, 0.0, 0.0);
    for place in &told.trace {
        assert!(((place - centre).norm() - 0.1).abs() < 2e-4);
    }
    let widest = told.trace.iter().map(|p| p.y - begin.y).fold(0.0, f64::max);
    assert!((widest - 0.1).abs() < 1e-4, "{widest}");
    assert!((told.end() - begin).norm() - 0.2 < 1e-6);
    let seconds = told.reached(2);
    let even = std::f64::consts::PI * 0.1 / 0.2;
    assert!(seconds > even && seconds < even + 0.3, "{seconds}");
}

#[test]
fn an_arc_without_a_circle_is_an_error_at_its_line() {
    let told = run(
        "MoveL Offs(p0,10,0,0),v200,fine,tTool;\nMoveC Offs(p0,100,0,0),Offs(p0,200,0,0),v200,fine,tTool;",
    );
    assert_eq!(told.failure(), ("ERR_ROBLIMIT".to_owned(), 3));
}

/// A cabinet without an arm drives the same arc.
#[test]
fn a_cabinet_without_an_arm_drives_arcs_too() {
    let text = program(
        "MoveC Offs(p0,100,100,0),Offs(p0,200,0,0),v200,fine,tTool;",
        "",
    );
    let mut spec = ControllerSpec::without_arm("rob1");
    spec.signals = signals();
    let mut controller = Controller::without_arm(spec).expect("a cabinet");
    controller.set_task(Box::new(machine(&text)));
    let told = drive(controller, &[]).finished();
    let even = std::f64::consts::PI * 0.1 / 0.2;
    assert!((told.reached(2) - even).abs() < 0.01);
    let highest = told.trace.iter().map(|p| p.y).fold(0.0, f64::max);
    assert!((highest - 0.1).abs() < 1e-4);
}

/// An output after a fly-by move switches before the arm arrives; MoveLDO switches at the corner; after fine it waits.
#[test]
fn outputs_and_corners() {
    let told = run("MoveL Offs(p0,300,0,0),v200,z50,tTool;\nSetDO do1,1;\nMoveL Offs(p0,300,200,0),v200,fine,tTool;\nSetDO do1,0;").finished();
    assert!(told.edge("do1") < 0.01, "run-ahead: switched at once");
    assert!((told.edges("do1")[1].0 - told.reached(4)).abs() < 0.005);

    let told = run(
        "MoveLDO Offs(p0,300,0,0),v200,z50,tTool,do1,1;\nMoveL Offs(p0,300,200,0),v200,fine,tTool;",
    )
    .finished();
    let corner = told.at(told.edge("do1"));
    let begin = told.trace[0];
    let (dx, dy) = (corner.x - begin.x, corner.y - begin.y);
    assert!(dx > 0.27 && dx < 0.3 && dy > 0.0 && dy < 0.03, "{dx} {dy}");

    for (instruction, line) in [
        ("MoveLDO Offs(p0,100,0,0),v200,fine,tTool,do1,1;", 2),
        ("MoveJDO Offs(p0,100,0,0),v200,fine,tTool,do1,1;", 2),
        (
            "MoveCDO Offs(p0,50,50,0),Offs(p0,100,0,0),v200,fine,tTool,do1,1;",
            2,
        ),
    ] {
        let told = run(instruction).finished();
        let (edge, reached) = (told.edge("do1"), told.reached(line));
        assert!(
            (edge - reached).abs() < 1e-6,
            "{instruction}: {edge} {reached}"
        );
    }
}

#[test]
fn concurrent_moves_do_not_wait() {
    let told = run("MoveL \\Conc,Offs(p0,300,0,0),v200,fine,tTool;\nSetDO do1,1;\nWaitRob\\InPos;\nSetDO do1,0;").finished();
    assert!(told.edge("do1") < 0.01);
    assert!((told.edges("do1")[1].0 - told.reached(2)).abs() < 0.005);
}

#[test]
fn a_time_instead_of_a_speed_and_a_stop_with_a_time() {
    let told = run("MoveL Offs(p0,400,0,0),v1000\\T:=4,fine,tTool;").finished();
    let seconds = told.reached(2);
    // The way in that time, and the ramps.
    assert!((4.0..4.06).contains(&seconds), "{seconds}");
    let told =
        run("MoveL Offs(p0,100,0,0),v200,z50\\Inpos:=stoptime1_5,tTool;\nSetDO do1,1;").finished();
    let stood = told.edge("do1") - told.reached(2);
    assert!((stood - 1.5).abs() < 0.01, "{stood}");
}

/// The configuration is chosen or refused at its own line, from the start on, until ConfJ or ConfL \Off.
#[test]
fn configuration_is_reached_or_refused() {
    let flip = "p0.robconf.cf4 := p0.robconf.cf4 - 2;\np0.robconf.cf6 := p0.robconf.cf6 - 2;\n";
    // Away from the singularity, with joints 4 and 6 inside their quarters.
    let away = "MoveAbsJ [[10,10,10,20,60,20],[9E9,9E9,9E9,9E9,9E9,9E9]],v1000,fine,tTool;\np0 := CRobT(\\Tool:=tTool);\n";
    let told = run(&format!("{away}{flip}MoveJ p0,v1000,fine,tTool;")).finished();
    let degrees = told.joints[told.joints.len() - 1].to_degrees();
    assert!(
        (degrees[3] + 160.0).abs() < 0.1 && degrees[4] < 0.0,
        "{degrees:?}"
    );
    let told = run(&format!(
        "{away}{flip}ConfJ\\Off;\nMoveJ p0,v1000,fine,tTool;"
    ))
    .finished();
    let degrees = told.joints[told.joints.len() - 1].to_degrees();
    assert!((degrees[3] - 20.0).abs() < 0.1, "{degrees:?}");
    // A line cannot flip the wrist.
    let told = run(&format!("{away}{flip}MoveL p0,v1000,fine,tTool;"));
    assert_eq!(told.failure(), ("ERR_ROBLIMIT".to_owned(), 6));
    let told = run(&format!(
        "{away}{flip}ConfL\\Off;\nConfL\\On;\nMoveL p0,v1000,fine,tTool;"
    ));
    assert_eq!(told.failure(), ("ERR_ROBLIMIT".to_owned(), 8));
    run(&format!(
        "{away}{flip}ConfL\\Off;\nMoveL p0,v1000,fine,tTool;"
    ))
    .finished();
}

/// Joint 6 may stand at most 45 degrees beside the quarter turn that the target names.
#[test]
fn the_margin_of_a_configuration_is_45_degrees() {
    let to = |degrees: f64, quarter: i32, instruction: &str| {
        run(&format!(
            "MoveAbsJ [[10,10,10,20,60,{degrees}],[9E9,9E9,9E9,9E9,9E9,9E9]],v1000,fine,tTool;\np0 := CRobT(\\Tool:=tTool);\np0.robconf.cf6 := {quarter};\n{instruction} p0,v1000,fine,tTool;"
        ))
    };
    for (degrees, quarter) in [(134.0, 0), (46.0, 1), (-44.0, 0), (44.0, -1)] {
        for instruction in ["MoveJ", "MoveL"] {
            to(degrees, quarter, instruction).finished();
        }
    }
    for (degrees, quarter) in [(136.0, 0), (44.0, 1), (-46.0, 0), (46.0, -1)] {
        for instruction in ["MoveJ", "MoveL"] {
            let failure = to(degrees, quarter, instruction).failure();
            assert_eq!(failure.0, "ERR_ROBLIMIT", "{degrees} {quarter}");
        }
    }
}

#[test]
fn limits_are_errors_at_the_line_of_the_move() {
    let told = run(
        "MoveL Offs(p0,100,0,0),v200,z10,tTool;\nMoveAbsJ [[0,0,0,0,90,999],[9E9,9E9,9E9,9E9,9E9,9E9]],v200,fine,tTool;",
    );
    assert_eq!(told.failure(), ("ERR_ROBLIMIT".to_owned(), 3));
    let told = run("MoveJ Offs(p0,3000,0,0),v200,fine,tTool;");
    assert_eq!(told.failure(), ("ERR_ROBLIMIT".to_owned(), 2));
    // A calculated target out of reach can be handled.
    let handled = "VAR jointtarget j;\nj := CalcJointT(Offs(p0,3000,0,0),tTool);\nTPWrite \"no\";\nERROR\nIF ERRNO=ERR_ROBLIMIT THEN\nTPWrite \"limit\";\nTRYNEXT;\nENDIF";
    let told = run_with("calc;", &format!("PROC calc()\n{handled}\nENDPROC"), &[]).finished();
    assert_eq!(told.lines, ["limit", "no"]);
    let told = run("p0 := CalcRobT(CalcJointT(Offs(p0,50,0,0),tTool),tTool);\nTPWrite NumToStr(p0.trans.x - 50,1);\nMoveL p0,v200,fine,tTool;").finished();
    assert!((told.end() - told.trace[0]).norm() - 0.05 < 1e-4);
}

/// A work object moves and turns the targets in it.
#[test]
fn work_objects_and_external_axes() {
    let told = run_with(
        "wObj.uframe.trans := [0,100,0];\nMoveL RelTool(CRobT(\\Tool:=tTool\\WObj:=wObj),0,0,-50),v200,fine,tTool\\WObj:=wObj;\nMoveL Offs(CRobT(\\Tool:=tTool),0,0,0),v200,fine,tTool\\WObj:=wObj;",
        "TASK PERS wobjdata wObj := [FALSE,TRUE,\"\",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];",
        &[],
    );
    let told = told.finished();
    let moved = told.end() - told.trace[0];
    // Up by the tool, then by the work object's place along Y.
    assert!(
        (moved.z - 0.05).abs() < 1e-4 && (moved.y - 0.1).abs() < 1e-4,
        "{moved}"
    );
}
