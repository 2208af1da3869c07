//! Moves: targets, frames, speeds, approximation, and how far the program runs ahead.

use crate::fake_system::*;

fn moves(statements: &str) -> Vec<String> {
    output("DECL E6POS p\nDECL E6AXIS j\nDECL FRAME f", statements)
}

/// Without the time in front.
fn bare(trace: &[String]) -> Vec<&str> {
    trace
        .iter()
        .map(|line| line.split_once(' ').map_or(line.as_str(), |(_, rest)| rest))
        .collect()
}

#[test]
fn axis_angles_are_joint_angles() {
    let trace = moves("$VEL_AXIS[1] = 20\nPTP {A1 10, A2 20, A3 30, A4 40, A5 50, A6 60}");
    assert_eq!(
        bare(&trace),
        ["line 6 Joint joints [10.0, 20.0, 30.0, 40.0, 50.0, 60.0] at 0.20 of the joints fine"]
    );
}

#[test]
fn parts_that_are_not_given_stay() {
    let trace = moves("PTP {A1 10, A2 20, A3 30}\nPTP {A2 25}\nLIN {Z 2500.0, A 90}");
    assert_eq!(
        bare(&trace)[1..],
        [
            "line 6 Joint joints [10.0, 25.0, 30.0, 0.0, 0.0, 0.0] at 1.00 of the joints fine",
            "line 7 Linear tcp 1000 2500 2500 90 0 0 at 3.000 m/s fine"
        ]
    );
}

#[test]
fn relative_moves_begin_at_the_end_of_the_one_before() {
    let trace = moves(
        "PTP {A1 10, A2 20, A3 30}\nLIN_REL {Z -100.0}\nPTP_REL {A1 -5}\nLIN {A 90}\nLIN_REL {X 10.0} #TOOL",
    );
    let bare = bare(&trace);
    assert!(bare[1].contains("tcp 1000 2000 2900 0 0 0"), "{bare:?}");
    assert!(bare[2].contains("joints [5.0, 20.0, 29.0"), "{bare:?}");
    // X of the turned tool is Y of the base; the fake arm does not turn.
    assert!(bare[4].contains("tcp 510 2000 2900"), "{bare:?}");
}

#[test]
fn base_and_tool() {
    let text = "$BASE = {X 1000.0, Y 0.0, Z 0.0, A 90.0, B 0.0, C 0.0}\n$TOOL = {X 0.0, Y 0.0, Z 200.0, A 0.0, B 0.0, C 0.0}\nLIN {X 10.0, Y 0.0, Z 500.0, A 0.0, B 0.0, C 0.0}";
    let trace = moves(text);
    assert!(
        bare(&trace)[0].contains("tcp 1000 10 500 90 0 0"),
        "{trace:?}"
    );
    // The flange is at the tool's place without the tool.
    let there = shown(
        "DECL INT n",
        &format!("{text}\n$BASE = $NULLFRAME\nn = $POS_ACT.Z + $POS_ACT.X"),
        "n",
    );
    assert!(there.ends_with("|1500"), "{there}");
}

#[test]
fn arcs_and_their_angle() {
    let start = "PTP {X 1000.0, Y 0.0, Z 0.0, A 0, B 0, C 0}\n";
    let trace = moves(&format!(
        "{start}CIRC {{X 0.0, Y 1000.0}}, {{X -1000.0, Y 0.0}}, CA 90"
    ));
    assert!(bare(&trace)[1].contains("Linear tcp 0 1000 0"), "{trace:?}");
    let trace = moves(&format!(
        "{start}CIRC {{X 0.0, Y 1000.0}}, {{X -1000.0, Y 0.0}}"
    ));
    assert!(
        bare(&trace)[1].contains("Linear tcp -1000 0 0"),
        "{trace:?}"
    );
    let trace = moves(&format!(
        "{start}CIRC {{X 0.0, Y 0.0}}, {{X -1000.0, Y 0.0}}, CA 90"
    ));
    assert!(trace[1].contains("lie on a line"), "{trace:?}");
}

#[test]
fn approximation() {
    let text = "$APO.CDIS = 30\n$APO.CPTP = 50\nPTP {X 1000.0, Y 0.0, Z 0.0} C_PTP\nLIN {Y 1000.0} C_DIS\nLIN {Y 1040.0} C_DIS\nSLIN {Y 0.0} C_SPL\nLIN {X 0.0}";
    let trace = moves(text);
    let zones: Vec<_> = bare(&trace)
        .iter()
        .map(|line| line.rsplit_once(" at ").map_or("", |(_, rest)| rest))
        .map(|rest| {
            rest.split_once(' ')
                .map_or("", |(_, rest)| rest)
                .trim_start_matches("of the joints ")
                .trim_start_matches("m/s ")
        })
        .map(str::to_owned)
        .collect();
    // Half of half the way; the distance; at most half the way.
    assert_eq!(
        zones,
        ["fly 250.0", "fly 30.0", "fly 20.0", "fly 30.0", "fine"]
    );
}

#[test]
fn settings_of_one_move_hold_for_that_move() {
    let trace = moves(
        "$VEL.CP = 1\nSLIN {X 100.0} WITH $VEL.CP = 0.25, $APO.CDIS = 7 C_DIS\nLIN {X 200.0} C_DIS",
    );
    let bare = bare(&trace);
    assert!(bare[0].contains("0.250 m/s fly 7.0"), "{bare:?}");
    assert!(bare[1].contains("1.000 m/s fly 5.0"), "{bare:?}");
}

#[test]
fn bas_sets_what_its_command_says() {
    let trace = moves(
        "BAS(#INITMOV, 0)\nBAS(#VEL_PTP, 40)\nPTP {A1 1}\nBAS(#VEL_CP, 0.5)\nLIN {X 1.0}\nTOOL_DATA[2] = {X 0.0, Y 0.0, Z 70.0, A 0.0, B 0.0, C 0.0}\nBAS(#TOOL, 2)\nMsgNotify(\"%1\", $TOOL.Z)",
    );
    let bare = bare(&trace);
    assert!(bare[0].contains("0.40 of the joints"), "{bare:?}");
    assert!(bare[1].contains("0.500 m/s"), "{bare:?}");
    assert_eq!(trace[2], "70");
    let inline = "PDAT_ACT = {VEL 100.0, ACC 50.0, APO_DIST 10.0}\nFDAT_ACT = {TOOL_NO 0, BASE_NO 0, IPO_FRAME #BASE}\nBAS(#PTP_PARAMS, 30)\nPTP XHOME";
    assert!(moves(inline)[0].contains("0.30 of the joints"));
}

#[test]
fn the_override_scales_all_speeds() {
    let trace = moves("$OV_PRO = 50\nPTP {A1 1}\n$VEL.CP = 1\nLIN {X 1.0}");
    let bare = bare(&trace);
    assert!(bare[0].contains("0.50 of the joints"), "{bare:?}");
    assert!(bare[1].contains("0.500 m/s"), "{bare:?}");
}

/// Four moves, and a message through a variable that does not wait.
fn time_of_the_flag(advance: u32) -> String {
    let text = format!(
        "$ADVANCE = {advance}\nFOR i = 1 TO 4\nPTP {{A1 i}}\nt = $ROB_TIMER\nENDFOR\nMsgNotify(\"%1\", t)"
    );
    let trace = output("DECL INT i, t", &text);
    trace.last().cloned().unwrap_or_default()
}

#[test]
fn the_program_runs_so_many_moves_ahead() {
    // The fourth move is taken when so many before it are over; each takes 100 ms.
    assert_eq!(time_of_the_flag(3), "0");
    let late: Vec<u32> = [2, 1, 0]
        .map(time_of_the_flag)
        .iter()
        .map(|t| t.parse().expect("ms"))
        .collect();
    assert!((100..110).contains(&late[0]), "{late:?}");
    assert!((200..210).contains(&late[1]), "{late:?}");
    assert!((400..420).contains(&late[2]), "{late:?}");
}

#[test]
fn outputs_wait_for_the_arm_unless_continue_stands_before() {
    let trace = output(
        "",
        "PTP {A1 1}\n$OUT[1] = TRUE\nPTP {A1 2}\nCONTINUE\n$OUT[2] = TRUE\nCONTINUE\nIF $IN[1] == FALSE THEN\n$OUT[3] = TRUE\nENDIF",
    );
    let times: Vec<_> = trace
        .iter()
        .map(|line| line.split("= ").next().unwrap_or(""))
        .collect();
    assert!(times[1].starts_with("0.100 $OUT[1]"), "{trace:?}");
    assert!(times[3].starts_with("0.100 $OUT[2]"), "{trace:?}");
    // CONTINUE holds for one statement: the one inside waits again.
    assert!(times[4].starts_with("0.204 $OUT[3]"), "{trace:?}");
}

#[test]
fn reading_the_actual_position_waits_for_the_arm() {
    let trace = output(
        "DECL E6AXIS j\nDECL INT t",
        "PTP {A1 12}\nj = $AXIS_ACT\nt = $ROB_TIMER\nMsgNotify(\"%1 %2\", j.A1, t)",
    );
    let last = trace.last().expect("written");
    assert!(last.starts_with("12 1"), "{trace:?}");
}

#[test]
fn the_program_ends_when_the_arm_stands() {
    let mut system = FakeSystem::default();
    let mut machine = machine(&[("main.src", "DEF main( )\nPTP {A1 1} C_PTP\nEND")]);
    run(&mut machine, &mut system);
    assert!(system.now.as_secs_f64() >= 0.1, "{:?}", system.now);
}

#[test]
fn triggers_set_outputs_along_the_next_move() {
    let trace = output(
        "SIGNAL gripper $OUT[2]",
        "PTP {A1 1}\nTRIGGER WHEN DISTANCE = 1 DELAY = -30 DO $OUT[1] = TRUE\nTRIGGER WHEN DISTANCE = 0 DELAY = 20 DO gripper = TRUE\nLIN {X 500.0}",
    );
    let bare: Vec<_> = trace.iter().map(|l| &l[..l.len().min(16)]).collect();
    assert_eq!(bare[2], "0.120 $OUT[2] = ", "{trace:?}");
    assert_eq!(bare[3], "0.172 $OUT[1] = ", "{trace:?}");
}

#[test]
fn triggers_call_routines() {
    let source = "DEF main( )\nTRIGGER WHEN DISTANCE = 1 DELAY = 0 DO shot(7) PRIO = -1\nPTP {A1 1} C_PTP\nPTP {A1 2}\nWAIT SEC 0.3\nEND\nDEF shot(n:IN)\nDECL INT n\nMsgNotify(\"%1\", n)\n$OUT[1] = TRUE\nEND";
    let trace = run_files(&[("main.src", source)]);
    assert_eq!(trace[2], "7", "{trace:?}");
    assert!(trace[3].starts_with("0.10"), "{trace:?}");
}

#[test]
fn an_output_on_time_is_set_when_the_arm_gets_there() {
    let trace = output(
        "",
        "PTP {A1 1} C_PTP\n$OUT_C[1] = TRUE\nPTP {A1 2}\n$OUT_C[2] = TRUE",
    );
    assert!(
        trace[1].starts_with("0.000 line 5"),
        "not held back: {trace:?}"
    );
    assert!(trace[2].starts_with("0.100 $OUT[1] = 1"), "{trace:?}");
    assert!(trace[3].starts_with("0.200 $OUT[2] = 1"), "{trace:?}");
}

#[test]
fn a_palletizer_has_four_axes() {
    let mut system = FakeSystem {
        joint_count: 4,
        ..FakeSystem::default()
    };
    let source = main_of(
        "DECL E6AXIS j",
        "PTP {A1 1, A2 2, A3 3, A4 0, A5 0, A6 6}\nj = $AXIS_ACT\nMsgNotify(\"%1 %2\", j.A5, j.A6)",
    );
    let mut machine = machine(&[("main.src", &source)]);
    run(&mut machine, &mut system);
    assert!(
        system.trace[0].contains("joints [1.0, 2.0, 3.0, 6.0]"),
        "{:?}",
        system.trace
    );
    assert_eq!(system.trace[1], "0 6");
}

#[test]
fn external_axes_are_refused_unless_they_stand_at_zero() {
    assert!(moves("PTP {A1 1, E1 0.0}")[0].contains("joints"));
    assert!(moves("PTP {A1 1, E1 5.0}")[0].contains("external axis E1"));
}

#[test]
fn the_turn_of_a_position_chooses_the_solution() {
    // The fake arm keeps the wrist near what it is asked near; half turns of A4 and A6 are tried.
    let mut system = FakeSystem::default();
    let source = main_of(
        "",
        "PTP {A4 10, A5 20, A6 30}\nPTP {X 1000.0, Y 0.0, Z 0.0, A 0.0, B 0.0, C 0.0, S 4, T 56}",
    );
    let mut machine = machine(&[("main.src", &source)]);
    run(&mut machine, &mut system);
    assert!(
        system.trace[1].contains("joints [10.0, 0.0, 0.0, -170.0, -20.0, -150.0]"),
        "{:?}",
        system.trace
    );
}

#[test]
fn inline_forms_take_their_settings_from_the_data_of_the_point() {
    let data = "DEFDAT main\nDECL E6POS XP1={X 10.0,Y 20.0,Z 30.0,A 0.0,B 0.0,C 0.0}\nDECL FDAT FP1={TOOL_NO 2,BASE_NO 0,IPO_FRAME #BASE,POINT2[] \" \",TQ_STATE FALSE}\nDECL PDAT PP={VEL 100.0,ACC 50.0,APO_DIST 100.0}\nDECL LDAT LP={VEL 2.0,ACC 50.0,APO_DIST 20.0}\nENDDAT";
    let source = "DEF main( )\nTOOL_DATA[2] = {Z 100.0}\nSPTP XP1 WITH $VEL_AXIS[1] = SVEL_JOINT(30.0), $TOOL = STOOL2(FP1), $BASE = SBASE(FP1.BASE_NO), $IPO_MODE = SIPO_MODE(FP1.IPO_FRAME), $LOAD = SLOAD(FP1.TOOL_NO), $ACC_AXIS[1] = SACC_JOINT(PP), $APO = SAPO_PTP(PP), $GEAR_JERK[1] = SGEAR_JERK(PP), $COLLMON_TOL_PRO[1] = USE_CM_PRO_VALUES(0)\nSLIN {Z 130.0} WITH $VEL = SVEL_CP(0.5, , LP), $ACC = SACC_CP(LP), $ORI_TYPE = SORI_TYP(LP), $APO = SAPO(LP), $JERK = SJERK(LP) C_SPL\nSLIN {Z 300.0}\nEND";
    let trace = run_files(&[("main.src", source), ("main.dat", data)]);
    let bare = bare(&trace);
    assert!(
        bare[0].contains("tcp 10 20 30") && bare[0].contains("0.30 of the joints"),
        "{bare:?}"
    );
    assert!(bare[1].contains("0.500 m/s fly 20.0"), "{bare:?}");
    assert!(bare[2].contains("3.000 m/s fine"), "{bare:?}");
}

/// `$LOAD` goes with each move; BAS and the inline forms take it from the data of the tool. Until something is said, and
/// where the mass is negative, what the cabinet was set up with counts.
#[test]
fn the_load_reaches_the_cabinet() {
    let statements = "PTP {A1 10}
        $LOAD.M = 40.5
        $LOAD.CM = {X 10.0, Y 0.0, Z 150.0, A 0.0, B 0.0, C 0.0}
        PTP {A1 20}
        TOOL_DATA[2] = {X 0.0, Y 0.0, Z 300.0, A 0.0, B 0.0, C 0.0}
        LOAD_DATA[2].M = 62
        LOAD_DATA[2].CM = {X 0.0, Y 0.0, Z 200.0, A 0.0, B 0.0, C 0.0}
        BAS(#TOOL, 2)
        PTP {A1 30}
        BAS(#TOOL, 0)
        PTP {A1 40}";
    let mut system = FakeSystem::default();
    let mut machine = machine(&[("main.src", &main_of("", statements))]);
    let end = run(&mut machine, &mut system);
    assert_eq!(end, depal_vm::execution::Step::Finished);
    assert_eq!(
        system.loads,
        [
            "as set up",
            "tool 40.5 at 0.010 0.000 0.150",
            "tool 62 at 0.000 0.000 0.200",
            "as set up",
        ]
    );
}
