use crate::harness::*;

fn seconds(before: &str) -> (f64, f64) {
    let told = run(&format!(
        "{before}\nSetDO do1,1;\nMoveL Offs(p0,400,0,0),v1000,fine,tTool;\nSetDO do2,1;"
    ))
    .finished();
    (told.edge("do2") - told.edge("do1"), told.top_speed())
}

#[test]
fn accelerations_lengthen_a_move() {
    let (full, _) = seconds("AccSet 100,100;");
    let (half, _) = seconds("AccSet 50,100;");
    let (least, _) = seconds("AccSet 5,100;");
    let (twenty, _) = seconds("AccSet 20,100;");
    assert!(half > full * 1.1, "{full} {half}");
    assert_eq!(least, twenty, "below 20 % acts as 20 %");
    let (limited, _) = seconds("PathAccLim TRUE\\AccMax:=2,TRUE\\DecelMax:=2;");
    assert!((limited - twenty).abs() < 1e-9);
}

#[test]
fn speeds_are_scaled_and_limited() {
    let (_, full) = seconds("VelSet 100,5000;");
    let (_, half) = seconds("VelSet 50,5000;");
    let (_, limited) = seconds("VelSet 100,300;");
    assert!(full > 0.9, "{full}");
    assert!((half - 0.5).abs() < 0.005, "{half}");
    assert!((limited - 0.3).abs() < 0.003, "{limited}");
}

/// The override holds for the moves that follow, on top of VelSet.
#[test]
fn the_override_slows_what_follows() {
    let (_, quarter) = seconds("SpeedRefresh 25;");
    assert!((quarter - 0.25).abs() < 0.003, "{quarter}");
    let (_, both) = seconds("VelSet 50,5000; SpeedRefresh 50;");
    assert!((both - 0.25).abs() < 0.003, "{both}");
    let told = run("SpeedRefresh 40;\nTPWrite NumToStr(CSpeedOverride(),0);\nSpeedRefresh 130;");
    assert_eq!(told.lines, ["40"]);
    assert_eq!(told.failure(), ("ERR_SPEED_REFRESH_LIM".to_owned(), 4));
}

/// What the motion model has no use for is accepted where it is right, and refused where it would lie.
#[test]
fn what_has_no_effect_is_told() {
    run("SingArea\\Wrist;\nSingArea\\Off;\nGripLoad load0;\nMotionSup\\On;\nPathResol 100;\nCirPathMode\\ObjectFrame;").finished();
    for wrong in [
        "SingArea\\LockAxis4;",
        "MotionSup\\Off;",
        "CirPathMode\\CirPointOri;",
    ] {
        assert_eq!(run(wrong).failure().1, 2, "{wrong}");
    }
    let heavy = "GripLoad [-1,[0,0,0.001],[1,0,0,0],0,0,0];";
    assert_eq!(run(heavy).failure().1, 2);
}

/// With torque limits in the arm's file the load that the program names slows its moves; without them it does not.
#[test]
fn a_named_load_slows_an_arm_with_torque_limits() {
    let seconds = |mass: f64, torque: f64| {
        let text = format!(
            "GripLoad [{mass},[0,0,200],[1,0,0,0],0,0,0];\nSetDO do1,1;\nMoveJ Offs(p0,-300,1000,0),v7000,fine,tTool;\nSetDO do2,1;"
        );
        let told = run_in(&text, "", &[], |spec| {
            let limits = [torque, 0.0, 0.0, 0.0, 0.0, 0.0];
            let weak = (*spec.arm).clone().with_torque_limits(&limits);
            spec.arm = std::sync::Arc::new(weak.expect("six torques"));
        })
        .finished();
        told.edge("do2") - told.edge("do1")
    };
    let (light, heavy) = (seconds(5.0, 1000.0), seconds(150.0, 1000.0));
    assert!(heavy > 1.05 * light, "{light} {heavy}");
    let (light, heavy) = (seconds(5.0, 0.0), seconds(150.0, 0.0));
    assert_eq!(light.to_bits(), heavy.to_bits());
}
