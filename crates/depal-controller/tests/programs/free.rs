//! The same rules on a mechanism that reaches everything (`exec --no-kinematics`).

use depal_controller::{Controller, ControllerSpec};

use crate::harness::*;

fn run_free(statements: &str, more: &str, inputs: &[(f64, &str, f64)]) -> Told {
    let text = program(statements, more);
    let mut spec = ControllerSpec::without_arm("rob1");
    spec.signals = signals();
    let mut controller = Controller::without_arm(spec).expect("a cabinet");
    controller.set_task(Box::new(machine(&text)));
    drive(controller, inputs)
}

#[test]
fn outputs_fire_at_their_places() {
    let told = run_free(
        "TriggIO trigg,100\\DOp:=do1,1;\nTriggEquip other,100,0.1\\GOp:=go1,3;\nTriggL Offs(p0,400,0,0),v200,trigg\\T2:=other,fine,tTool;",
        "",
        &[],
    )
    .finished();
    // 400 mm at 200 mm/s; 100 mm before the end is half a second before it.
    assert!((told.edge("do1") - 1.5).abs() < 0.005);
    assert!((told.edge("go1") - 1.4).abs() < 0.005);
    assert!((told.reached(4) - 2.0).abs() < 0.005);
}

#[test]
fn a_held_path_is_taken_up() {
    let traps =
        "TRAP halt\nStopMove;\nENDTRAP\nTRAP go\nStartMove;\nENDTRAP\nVAR intnum a;\nVAR intnum b;";
    let told = run_free(
        "CONNECT a WITH halt;\nISignalDI di1,1,a;\nCONNECT b WITH go;\nISignalDI di2,1,b;\nMoveL Offs(p0,200,0,0),v200,z20,tTool;\nMoveLDO Offs(p0,400,0,0),v200,fine,tTool,do1,1;",
        traps,
        &[(0.5, "di1", 1.0), (2.5, "di2", 1.0)],
    )
    .finished();
    assert!((told.at(1.0) - told.at(2.4)).norm() < 1e-9, "it stands");
    assert!((told.at(1.0).x - 0.1).abs() < 0.005);
    // Two seconds of way and two of rest.
    assert!(
        (told.edge("do1") - 4.0).abs() < 0.02,
        "{}",
        told.edge("do1")
    );
    let told = run_free(
        "MoveL\\Conc,Offs(p0,200,0,0),v200,fine,tTool;\nWaitTime 0.2;\nStopMove;\nMoveL p0,v200,fine,tTool;",
        "",
        &[],
    );
    assert!(told.waits_for_ever);
}

#[test]
fn a_stored_path_is_taken_up_after_another_job() {
    let told = run_free(
        "MoveL\\Conc,Offs(p0,200,0,0),v200,fine,tTool;\nWaitTime 0.5;\nStopMove;\nStorePath;\np0 := CRobT(\\Tool:=tTool);\nMoveL Offs(p0,0,0,100),v200,fine,tTool;\nMoveL p0,v200,fine,tTool;\nRestoPath;\nStartMove;\nWaitRob\\InPos;\nSetDO do1,1;",
        "",
        &[],
    )
    .finished();
    let highest = told
        .trace
        .iter()
        .map(|p| p.z - told.trace[0].z)
        .fold(0.0, f64::max);
    assert!((highest - 0.1).abs() < 1e-3, "{highest}");
    assert!(((told.end() - told.trace[0]).x - 0.2).abs() < 1e-4);
    // Half a second, a second of the other job, half a second.
    assert!(
        (told.edge("do1") - 2.0).abs() < 0.03,
        "{}",
        told.edge("do1")
    );
    let told = run_free(
        "MoveL\\Conc,Offs(p0,200,0,0),v200,fine,tTool;\nWaitTime 0.5;\nStorePath;\nMoveL p0,v200,fine,tTool;\nRestoPath;",
        "",
        &[],
    );
    assert_eq!(told.failure().1, 6);
    let told = run_free(
        "MoveL\\Conc,Offs(p0,200,0,0),v200,fine,tTool;\nWaitTime 0.5;\nStopMove;\nClearPath;\nStartMove;\nMoveL p0,v200,fine,tTool;",
        "",
        &[],
    )
    .finished();
    assert!((told.end() - told.trace[0]).norm() < 1e-4);
}

#[test]
fn a_search_stops() {
    let told = run_free(
        "SearchL\\Stop,di1,pFound,Offs(p0,400,0,0),v100,tTool;\nTPWrite NumToStr(pFound.trans.x-p0.trans.x,0);",
        "",
        &[(2.0, "di1", 1.0)],
    )
    .finished();
    assert_eq!(told.lines, ["200"]);
    assert!((told.end() - told.trace[0]).norm() < 0.205);
}
