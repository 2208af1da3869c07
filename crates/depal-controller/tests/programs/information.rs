use depal_controller::ConfigurationData;

use crate::harness::*;

/// The calendar is that of the simulation: the same on every day.
#[test]
fn the_calendar_begins_with_the_simulation() {
    let told = run("TPWrite CDate();\nTPWrite CTime();\nWaitTime 59;\nTPWrite CTime();").lines;
    assert_eq!(told, ["2000-01-01", "00:00:00", "00:00:59"]);
    let told = run("TPWrite NumToStr(GetTime(\\WDay),0);\nTPWrite GetTaskName();\nTPWrite GetSysInfo(\\CtrlId);\nIF OpMode()=OP_AUTO AND RobOS() TPWrite \"auto\";").finished();
    assert_eq!(told.lines, ["6", "T_ROB1", "depal", "auto"]);
}

#[test]
fn analogue_signals_are_waited_for() {
    let inputs = [(1.0, "ai1", 3.0), (2.0, "ai1", 7.0)];
    let told = run_with("WaitAI ai1\\GT,5;\nSetDO do1,1;", "", &inputs).finished();
    assert!((told.edge("do1") - 2.0).abs() < 0.01);
    let told = run_with("WaitAI ai1,2.5;\nSetDO do1,1;", "", &inputs).finished();
    assert!(
        (told.edge("do1") - 1.0).abs() < 0.01,
        "passed on its way to 3"
    );
    let told = run_with("WaitAI ai1\\LT,-1\\MaxTime:=1.5;", "", &inputs);
    assert_eq!(told.failure(), ("ERR_WAIT_MAXTIME".to_owned(), 2));
    let told =
        run("SetAO ao1,4.5;\nWaitAO ao1\\GT,4;\nTPWrite NumToStr(AOutput(ao1),1);").finished();
    assert_eq!(told.lines, ["4.5"]);
}

#[test]
fn a_signal_has_another_name() {
    let alias = "VAR signaldo mine;\nVAR signaldi theirs;";
    let told = run_with(
        "AliasIO do1,mine;\nAliasIO \"di1\",theirs;\nSetDO mine,1;\nWaitDI theirs,1;\nIF theirs=1 SetDO do2,1;",
        alias,
        &[(1.0, "di1", 1.0)],
    )
    .finished();
    assert!(told.edge("do1") < 0.01 && told.edge("do2") >= 1.0);
    let told = run_with("AliasIO \"nothing\",mine;", alias, &[]);
    assert_eq!(told.failure(), ("ERR_ALIASIO_DEF".to_owned(), 2));
    let told = run_with("AliasIO 5,mine;", alias, &[]);
    assert_eq!(told.failure(), ("ERR_ALIASIO_TYPE".to_owned(), 2));
}

#[test]
fn bits_and_semaphores() {
    let told = run_with(
        "TPWrite NumToStr(BitOr(5,10),0)+\" \"+NumToStr(BitXOr(6,3),0)+\" \"+NumToStr(BitNeg(1),0)+\" \"+NumToStr(BitLSh(129,1),0)+\" \"+NumToStr(BitRSh(129,1),0);\nBitSet b,3;\nBitClear b,1;\nTPWrite NumToStr(b,0);\nIF BitCheck(b,3) AND NOT BitCheck(b,1) TPWrite \"set\";\nIF TestAndSet(flag) TPWrite \"was free\";\nIF NOT TestAndSet(flag) TPWrite \"taken\";\nIF StrOrder(\"abc\",\"abd\",STR_LOWER) TPWrite \"ordered\";",
        "VAR byte b := 1;\nPERS bool flag := FALSE;",
        &[],
    )
    .finished();
    assert_eq!(
        told.lines,
        ["15 5 254 2 64", "4", "set", "was free", "taken", "ordered"]
    );
    let told = run_with(
        "WaitTestAndSet flag;\nWaitTestAndSet flag;",
        "PERS bool flag := FALSE;",
        &[],
    );
    assert!(told.waits_for_ever);
}

#[test]
fn configuration_is_read_by_its_path() {
    let mut configuration = ConfigurationData::default();
    configuration
        .read(
            "MOC",
            "MOC:CFG_1.0::\n#\nMOTOR_CALIB:\n -name \"rob1_1\" -cal_offset 2.5 -valid_cal_offset\n",
        )
        .expect("a good file");
    let ask = |path: &str, attribute: &str, variable: &str| {
        run_in(
            &format!(
                "ReadCfgData \"{path}\", \"{attribute}\", {variable};\nTPWrite ValToStr({variable});"
            ),
            "VAR num n;\nVAR bool b;\nVAR string s;",
            &[],
            |spec| spec.configuration = configuration.clone(),
        )
    };
    let path = "/moc/MOTOR_CALIB/Rob1_1";
    assert_eq!(ask(path, "cal_offset", "n").finished().lines, ["2.5"]);
    assert_eq!(ask(path, "cal_offset", "s").finished().lines, ["\"2.5\""]);
    assert_eq!(
        ask(path, "valid_cal_offset", "b").finished().lines,
        ["TRUE"]
    );
    for (path, attribute, variable, expected) in [
        (path, "cal_offset", "b", "ERR_CFG_ILLTYPE"),
        (path, "other", "n", "ERR_CFG_NOTFND"),
        (
            "/MOC/MOTOR_CALIB/rob1_2",
            "cal_offset",
            "n",
            "ERR_CFG_NOTFND",
        ),
        ("MOTOR_CALIB", "cal_offset", "n", "ERR_CFG_NOTFND"),
    ] {
        let told = ask(path, attribute, variable);
        assert_eq!(
            told.failure(),
            (expected.to_owned(), 2),
            "{path} {attribute}"
        );
    }
}
