//! Moves: where, how fast, in which frame.

use crate::fake_system::*;

fn moves(text: &[&str]) -> Vec<String> {
    let left = lines(text);
    assert_eq!(left.end, "", "{text:?}");
    left.trace
}

#[test]
fn joint_linear_and_circular() {
    assert_eq!(
        moves(&[
            "J P[1] 50% FINE",
            "L P[2:over] 250mm/sec CNT50",
            "C P[1]\n    :  P[2] 600cm/min FINE",
            "L P[1] max_speed FINE",
        ]),
        [
            "0.000 line 1 Joint tcp 1.0000 0.0000 0.5000 at 5.000 m/s fine tool z 0.000",
            "0.100 line 2 Linear tcp 1.0000 0.5000 0.5000 at 0.250 m/s fly 0.0125 tool z 0.000",
            "0.100 line 3 Linear tcp 1.0000 0.5000 0.5000 at 0.100 m/s fine tool z 0.000",
            "0.304 line 4 Linear tcp 1.0000 0.0000 0.5000 at 10.000 m/s fine tool z 0.000",
        ]
    );
}

#[test]
fn units_of_speed() {
    let speed = |text: &str| moves(&[text])[0].split(" at ").nth(1).unwrap()[..5].to_owned();
    assert_eq!(speed("L P[1] 120cm/min FINE"), "0.020");
    assert_eq!(speed("L P[1] 600inch/min FINE"), "0.254");
    assert_eq!(speed("L P[1] 250mm/sec FINE"), "0.250");
    // The fake arm stands at (1, 2, 3): 3.2 m from the target.
    assert_eq!(speed("L P[1] 2.0sec FINE"), "1.601");
    assert_eq!(speed("L P[1] 500msec FINE"), "6.403");
    assert_eq!(
        moves(&["R[1]=40", "L P[1] R[1]mm/sec FINE"])[0]
            .split(" at ")
            .nth(1)
            .unwrap()[..5],
        *"0.040"
    );
}

#[test]
fn override_scales_the_speed() {
    let trace = moves(&["OVERRIDE=50%", "L P[1] 200mm/sec FINE"]);
    assert!(trace[0].contains("at 0.100 m/s"), "{trace:?}");
}

#[test]
fn frames_and_tools_in_use() {
    let trace = moves(&[
        "PR[1]=LPOS-LPOS",
        "PR[1,3]=300",
        "UTOOL[1]=PR[1]",
        "PR[2]=LPOS-LPOS",
        "PR[2,1]=2000",
        "PR[2,6]=90",
        "UFRAME[1]=PR[2]",
        "PR[3]=P[1]",
        "UFRAME_NUM=1",
        "L PR[3] 100mm/sec FINE",
    ]);
    // x 1000, y 0 in a frame at x 2000 that is turned by 90 degrees.
    assert_eq!(
        trace,
        ["0.000 line 10 Linear tcp 2.0000 1.0000 0.5000 at 0.100 m/s fine tool z 0.300"]
    );
}

#[test]
fn a_position_of_another_frame_is_refused() {
    assert_eq!(
        lines(&["UFRAME_NUM=1", "L P[1] 100mm/sec FINE"]).end,
        "MAIN/MAIN:2: INTP-252: User frame number mismatch: P[1] was taught in UF 0, UFRAME_NUM is 1"
    );
    assert_eq!(
        lines(&["UTOOL_NUM=0", "L P[1] 100mm/sec FINE"]).end,
        "MAIN/MAIN:2: INTP: Tool frame number mismatch: P[1] was taught with UT 1, UTOOL_NUM is 0"
    );
    assert!(
        lines(&["UFRAME_NUM=10"])
            .end
            .contains("UFRAME_NUM cannot be 10; 0 to 9 are possible")
    );
}

#[test]
fn an_unreachable_target_names_the_line_of_the_move() {
    let system = FakeSystem {
        refuse_move: Some(0),
        ..FakeSystem::default()
    };
    let text = listing(
        &["R[1]=1", "J P[1] 100% FINE"],
        &taught(1, [1.0, 2.0, 3.0, 0.0, 0.0, 0.0]),
    );
    let left = run_all(&[text], &depal_tp::Options::default(), system);
    assert_eq!(
        left.end,
        "MAIN/MAIN:2: MOTN: Position not reachable: the wrist would be 4.2 m away, at most 3.2 m"
    );
}

#[test]
fn offsets_move_the_target_in_the_frame_or_in_the_tool() {
    // P[1] looks down: its tool's Z is the world's -Z.
    let trace = moves(&[
        "PR[1]=LPOS-LPOS",
        "PR[1,3]=100",
        "L P[1] 100mm/sec FINE Offset,PR[1]",
        "L P[1] 100mm/sec FINE Tool_Offset,PR[1]",
        "OFFSET CONDITION PR[1]",
        "PR[1,3]=999",
        "L P[1] 100mm/sec FINE Offset",
        "L P[1] 100mm/sec FINE",
    ]);
    let heights: Vec<_> = trace.iter().map(|t| t.split(' ').nth(7).unwrap()).collect();
    assert_eq!(heights, ["0.6000", "0.4000", "0.6000", "0.5000"]);
    assert!(
        lines(&["L P[1] 100mm/sec FINE Offset"])
            .end
            .contains("no OFFSET CONDITION came before")
    );
}

#[test]
fn joint_targets_are_those_of_the_arm() {
    let positions = "P[1]{\n   GP1:\n\tUF : 0, UT : 1,\n\tJ1= 10.000 deg,\tJ2= 20.000 deg,\tJ3= -30.000 deg,\n\tJ4= 0.000 deg,\tJ5= -90.000 deg,\tJ6= 5.000 deg\n};\n";
    let text = listing(&["J P[1] 100% FINE"], positions);
    assert_eq!(
        run_text(&text).trace,
        [
            "0.000 line 1 Joint joints [10.0, 20.0, -10.0, 0.0, -90.0, 5.0] at 10.000 m/s fine tool z 0.000"
        ]
    );
    let options = depal_tp::Options {
        is_axis_3_coupled: false,
        ..depal_tp::Options::default()
    };
    let left = run_all(&[text], &options, FakeSystem::default());
    assert!(
        left.trace[0].contains("joints [10.0, 20.0, -30.0"),
        "{:?}",
        left.trace
    );
}

#[test]
fn incremental_moves_add_to_where_the_arm_goes() {
    let trace = moves(&[
        "PR[1]=LPOS-LPOS",
        "PR[1,1]=10",
        "L PR[1] 100mm/sec FINE INC",
    ]);
    assert!(trace[0].contains("tcp 1.0100 2.0000 3.0000"), "{trace:?}");
}

#[test]
fn where_the_arm_is() {
    assert_eq!(
        registers(&[
            "PR[1]=LPOS",
            "PR[2]=JPOS",
            "R[1]=PR[1,1]",
            "R[2]=PR[1,3]",
            "R[3]=PR[2,2]",
            "R[4]=PR[2,3]"
        ]),
        "R[1]=1000 R[2]=3000 R[3]=20 R[4]=10"
    );
}

#[test]
fn outputs_along_the_way() {
    let trace = moves(&[
        "L P[1] 100mm/sec CNT100 TB .20sec,DO[1]=ON DB 50.0mm,DO[2]=OFF",
        "L P[2] 100mm/sec FINE TA .5sec,GO[1]=7",
    ]);
    assert_eq!(
        trace
            .iter()
            .filter(|t| t.contains("lead"))
            .map(|t| &t[6..])
            .collect::<Vec<_>>(),
        [
            "DO[1] = 1 BeforeEnd(0.0) lead 0.200 delay 0.000",
            "DO[2] = 0 BeforeEnd(0.05) lead 0.000 delay 0.000",
            "GO[1] = 7 BeforeEnd(0.0) lead 0.000 delay 0.500",
        ]
    );
}

#[test]
fn outputs_behind_a_corner_are_switched_in_it() {
    let trace = moves(&[
        "L P[1] 100mm/sec CNT100",
        "DO[1]=ON",
        "!and a number",
        "GO[1]=5",
        "R[1]=1",
        "L P[2] 100mm/sec FINE",
        "DO[2]=ON",
    ]);
    let short: Vec<_> = trace
        .iter()
        .map(|t| t.split(" lead").next().unwrap_or_default())
        .collect();
    assert_eq!(
        short[..2],
        [
            "0.000 DO[1] = 1 BeforeEnd(0.0)",
            "0.000 GO[1] = 5 BeforeEnd(0.0)"
        ]
    );
    assert!(
        short[2].contains("line 1") && short[3].starts_with("0.000 line 6"),
        "{short:?}"
    );
    assert_eq!(short[4], "0.200 DO[2] = 1");
}

#[test]
fn what_touches_the_world_comes_after_the_corner() {
    let trace = moves(&[
        "L P[1] 100mm/sec CNT100",
        "R[1]=1",
        "DO[R[1]]=ON",
        "L P[2] 100mm/sec CNT100",
        "R[2]=DI[1]",
        "DO[2]=ON",
    ]);
    assert_eq!(trace[1], "0.100 DO[1] = 1");
    assert_eq!(trace[3], "0.204 DO[2] = 1");
    // A wait is counted from there.
    let text = ["L P[1] 100mm/sec CNT100", "WAIT .50(sec)", "DO[1]=ON"];
    assert_eq!(moves(&text)[1], "0.600 DO[1] = 1");
}

#[test]
fn skip_goes_to_the_label_unless_the_condition_comes_true() {
    let text = [
        "SKIP CONDITION DI[1]=ON",
        "L P[1] 100mm/sec FINE Skip,LBL[1],PR[5]=LPOS",
        "R[1]=1",
        "R[2]=PR[5,1]",
        "END",
        "LBL[1]",
        "R[1]=2",
    ];
    assert_eq!(registers(&text), "R[1]=2");
    let mut system = FakeSystem::default();
    system.changes.push((
        depal_time::SimTime::from_nanos(40_000_000),
        "DI[1]".into(),
        1.0,
    ));
    let positions = taught(1, [1000.0, 0.0, 500.0, 180.0, 0.0, 0.0]);
    let left = run_all(
        &[listing(&text, &positions)],
        &depal_tp::Options::default(),
        system,
    );
    assert_eq!(
        (left.end.as_str(), left.registers.join(" ").as_str()),
        ("", "R[1]=1 R[2]=1000")
    );
    assert!(left.trace[1].ends_with("stop"), "{:?}", left.trace);
}

#[test]
fn values_out_of_range_are_errors() {
    assert!(
        lines(&["R[1]=0", "J P[1] R[1]% FINE"])
            .end
            .contains("the percentage is 0")
    );
    assert!(
        lines(&["R[1]=101", "J P[1] 5% CNT R[1]"])
            .end
            .contains("CNT101")
    );
}

/// The payload schedule in use goes with each move; one without a mass leaves what the cabinet was set up with.
#[test]
fn the_payload_reaches_the_cabinet() {
    let left = lines(&[
        "J P[1] 50% FINE",
        "$PLST_GRP1[2].$PAYLOAD=(62.5)",
        "$PLST_GRP1[2].$PAYLOAD_Z=(20)",
        "PAYLOAD[2]",
        "J P[2] 50% FINE",
        "$PLST_GRP1[2].$PAYLOAD=(50)",
        "J P[1] 50% FINE",
        "PAYLOAD[1]",
        "J P[2] 50% FINE",
    ]);
    assert_eq!(left.end, "");
    assert_eq!(
        left.system.loads,
        [
            "as set up",
            "tool 62.5 at 0.000 0.000 0.200",
            "tool 50 at 0.000 0.000 0.200",
            "as set up",
        ]
    );
}
