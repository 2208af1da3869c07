use crate::harness::*;

const TRAP: &str = "VAR intnum stopper;\nVAR intnum starter;\n";

/// A trap stops the arm on its way, another lets it go on: the move ends where it would have.
#[test]
fn stop_move_holds_the_path_and_start_move_takes_it_up() {
    let traps =
        "TRAP halt\nStopMove;\nSetDO do1,1;\nENDTRAP\nTRAP go\nSetDO do1,0;\nStartMove;\nENDTRAP";
    let told = run_with(
        "CONNECT stopper WITH halt;\nISignalDI di1,1,stopper;\nCONNECT starter WITH go;\nISignalDI di2,1,starter;\nMoveL Offs(p0,300,0,0),v200,z20,tTool;\nMoveL Offs(p0,300,200,0),v200,fine,tTool;\nSetDO do2,1;",
        &format!("{traps}\n{TRAP}"),
        &[(0.8, "di1", 1.0), (3.0, "di2", 1.0)],
    )
    .finished();
    let stood = told.edge("do1");
    assert!(
        stood > 0.8 && stood < 1.1,
        "StopMove ends when the arm stands: {stood}"
    );
    assert!(
        (told.at(stood + 0.01) - told.at(3.0)).norm() < 1e-9,
        "it stands"
    );
    let moved = told.end() - told.trace[0];
    assert!((moved.x - 0.3).abs() < 1e-6 && (moved.y - 0.2).abs() < 1e-6);
    assert!(told.edge("do2") > 4.0, "the time of the stop is added");
    // The way is the same: never beside the two lines and their corner.
    for place in &told.trace {
        let off = place - told.trace[0];
        assert!(off.y < 1e-4 || off.x > 0.279, "{off}");
    }
}

#[test]
fn a_stop_without_a_start_waits_for_ever() {
    let told = run(
        "MoveL Offs(p0,300,0,0),v200,z20,tTool;\nStopMove;\nMoveL Offs(p0,300,200,0),v200,fine,tTool;",
    );
    assert!(told.waits_for_ever, "{:?}", told.state);
    assert!((told.end() - told.trace[0]).norm() < 0.1);
}

/// A cleared path is gone: the next move begins where the arm stands.
#[test]
fn clear_path_forgets_the_way() {
    let told = run("MoveL\\Conc,Offs(p0,400,0,0),v100,fine,tTool;\nWaitTime 1;\nStopMove;\nClearPath;\nStartMove;\nSetDO do1,1;\nMoveL Offs(p0,0,100,0),v200,fine,tTool;").finished();
    let farthest = told
        .trace
        .iter()
        .map(|p| p.x - told.trace[0].x)
        .fold(0.0, f64::max);
    assert!(farthest > 0.08 && farthest < 0.12, "{farthest}");
    let moved = told.end() - told.trace[0];
    assert!(moved.x.abs() < 1e-5 && (moved.y - 0.1).abs() < 1e-5);
    // Not while it moves.
    let told = run("MoveL\\Conc,Offs(p0,400,0,0),v100,fine,tTool;\nWaitTime 1;\nClearPath;");
    assert_eq!(told.failure().1, 4);
}

/// Another job in the middle of a move, then the rest of it.
#[test]
fn a_stored_path_is_taken_up_after_another_job() {
    let job = "TRAP job\nVAR robtarget back;\nStopMove;\nStorePath;\nback := CRobT(\\Tool:=tTool);\nSetDO do1,1;\nMoveL Offs(back,0,0,100),v200,fine,tTool;\nMoveL back,v200,fine,tTool;\nSetDO do1,0;\nRestoPath;\nStartMove;\nENDTRAP";
    let told = run_with(
        "CONNECT stopper WITH job;\nISignalDI di1,1,stopper;\nMoveL Offs(p0,300,0,0),v200,fine,tTool;\nSetDO do2,1;",
        &format!("{job}\n{TRAP}"),
        &[(0.8, "di1", 1.0)],
    )
    .finished();
    let (begun, over) = (told.edges("do1")[0].0, told.edges("do1")[1].0);
    let highest = told
        .trace
        .iter()
        .map(|p| p.z - told.trace[0].z)
        .fold(0.0, f64::max);
    assert!((highest - 0.1).abs() < 1e-4, "{highest}");
    assert!(
        (told.at(begun) - told.at(over)).norm() < 1e-3,
        "back where it was"
    );
    let moved = told.end() - told.trace[0];
    assert!(
        (moved.x - 0.3).abs() < 1e-6 && moved.z.abs() < 1e-6,
        "{moved}"
    );
    assert!(told.edge("do2") > over);
}

#[test]
fn a_stored_path_is_not_taken_up_from_elsewhere() {
    let told = run(
        "MoveL\\Conc,Offs(p0,300,0,0),v200,fine,tTool;\nWaitTime 0.5;\nStorePath;\nMoveL Offs(p0,100,0,100),v200,fine,tTool;\nRestoPath;",
    );
    assert_eq!(told.failure().1, 6);
    let told = run("RestoPath;");
    assert_eq!(told.failure().1, 2);
}

/// Without a stop of its own, StorePath stops the arm and RestoPath lets it go on.
#[test]
fn store_path_alone_stops_and_goes_on() {
    let told = run("MoveL\\Conc,Offs(p0,300,0,0),v200,fine,tTool;\nWaitTime 0.5;\nStorePath;\nWaitTime 1;\nRestoPath;\nWaitRob\\InPos;\nSetDO do1,1;").finished();
    assert!(((told.end() - told.trace[0]).norm() - 0.3).abs() < 1e-6);
    assert!(told.edge("do1") > 2.5);
}

#[test]
fn stop_move_reset_drops_what_was_held() {
    let told = run("MoveL\\Conc,Offs(p0,300,0,0),v200,fine,tTool;\nWaitTime 0.5;\nStopMove;\nStopMoveReset;\nMoveL p0,v200,fine,tTool;\nSetDO do1,1;").finished();
    assert!((told.end() - told.trace[0]).norm() < 1e-6);
    assert!(told.edge("do1") > 0.5);
}
