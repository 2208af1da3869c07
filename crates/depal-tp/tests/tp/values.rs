//! Registers, arithmetic, logic, signals: one rule each.

use crate::fake_system::*;

#[test]
fn a_slash_is_real_and_div_and_mod_are_whole() {
    assert_eq!(
        registers(&[
            "R[1]=7/2",
            "R[2]=7 DIV 2",
            "R[3]=7 MOD 2",
            "R[4]=(-7) DIV 2",
            "R[5]=(-7) MOD 2"
        ]),
        "R[1]=3.5 R[2]=3 R[3]=1 R[4]=-3 R[5]=-1"
    );
}

#[test]
fn products_bind_tighter_than_sums() {
    assert_eq!(
        registers(&["R[1]=2+3*4", "R[2]=(2+3)*4", "R[3]=10-2-3"]),
        "R[1]=14 R[2]=20 R[3]=5"
    );
}

#[test]
fn real_numbers_have_32_bits_and_print_short() {
    assert_eq!(
        registers(&[
            "R[1]=.1+.2",
            "R[2]=1/3",
            "R[3]=16777217",
            "R[4]=0.0",
            "R[5]=-2.50"
        ]),
        "R[1]=0.3 R[2]=0.33333334 R[3]=16777217 R[4]=0 R[5]=-2.5"
    );
}

#[test]
fn only_written_registers_are_told() {
    let options = depal_tp::Options {
        registers: vec![(1, 4.0), (2, 7.5)],
        ..depal_tp::Options::default()
    };
    let text = listing(&["R[3]=R[1]+R[2]", "R[4]=R[99]"], "");
    let left = run_all(&[text], &options, FakeSystem::default());
    assert_eq!(left.registers, ["R[3]=11.5", "R[4]=0"]);
}

#[test]
fn registers_are_addressed_through_registers() {
    assert_eq!(
        registers(&[
            "R[1]=5",
            "R[R[1]]=8",
            "R[2:copy of five]=R[R[1:five]:the number]",
            "R[3]=R[R[1]-3]"
        ]),
        "R[1]=5 R[2]=8 R[3]=8 R[5]=8"
    );
}

#[test]
fn division_by_zero_stops_with_the_line_of_the_listing() {
    let text = "/PROG MAIN\n/MN\n  10:  R[1]=0 ;\n  12:  R[2]=1/R[1] ;\n/POS\n/END\n";
    assert_eq!(
        run_text(text).end,
        "MAIN/MAIN:12: INTP: Divide by zero: 1 / 0"
    );
    assert!(lines(&["R[1]=1 DIV 0"]).end.contains("Divide by zero"));
    assert!(lines(&["R[1]=1 MOD .5"]).end.contains("Divide by zero"));
}

#[test]
fn an_index_out_of_range_is_an_error() {
    assert_eq!(
        lines(&["R[1]=R[0]"]).end,
        "MAIN/MAIN:1: INTP: Invalid index: there is no R[0]; R[1] to R[999] are there"
    );
    assert!(lines(&["R[1]=1.5", "R[R[1]]=1"]).end.contains("no R[1.5]"));
}

#[test]
fn logic_in_brackets() {
    assert_eq!(
        registers(&[
            "F[1]=(ON)",
            "R[1]=(F[1] AND !F[2])",
            "R[2]=(F[2] OR (R[1]=1 AND R[1]<2))",
            "F[3]=(!(F[1] AND F[2]))",
            "R[3]=F[3]",
        ]),
        "R[1]=1 R[2]=1 R[3]=1"
    );
}

#[test]
fn signals_go_to_the_cabinet_by_their_names() {
    let left = lines(&[
        "DO[1]=ON",
        "DO[R[1]+2]=DO[1]",
        "GO[1]=12",
        "R[2]=GO[1]",
        "AO[1]=2.5",
        "RO[1]=OFF",
    ]);
    assert_eq!(left.end, "");
    assert_eq!(
        left.trace,
        [
            "0.000 DO[1] = 1",
            "0.000 DO[2] = 1",
            "0.000 GO[1] = 12",
            "0.000 AO[1] = 2.5",
            "0.000 RO[1] = 0"
        ]
    );
    assert_eq!(left.registers, ["R[2]=12"]);
    assert_eq!(
        lines(&["DO[7]=ON"]).end,
        "MAIN/MAIN:1: PRIO: there is no signal DO[7]"
    );
}

#[test]
fn a_pulse_ends_later() {
    let left = lines(&[
        "DO[1]=PULSE,0.5sec",
        "R[1]=DO[1]",
        "WAIT .60(sec)",
        "R[2]=DO[1]",
    ]);
    assert_eq!(left.registers, ["R[1]=1", "R[2]=0"]);
}

#[test]
fn outputs_can_be_bits_of_a_group() {
    let options = depal_tp::Options {
        groups: vec![depal_tp::GroupOutput {
            signal: "GO[1]".into(),
            first: 1,
            bits: 8,
        }],
        ..depal_tp::Options::default()
    };
    let text = listing(
        &[
            "DO[1]=ON",
            "DO[4]=ON",
            "DO[1]=OFF",
            "R[1]=DO[4]",
            "R[2]=GO[1]",
        ],
        "",
    );
    let left = run_all(&[text], &options, FakeSystem::default());
    assert_eq!(left.registers, ["R[1]=1", "R[2]=8"]);
}

#[test]
fn strings_are_joined_measured_and_cut() {
    assert_eq!(
        registers(&[
            "SR[1]='Tool'",
            "SR[2]=SR[1]+'Box7'",
            "R[1]=STRLEN SR[2]",
            "R[2]=FINDSTR SR[2],'box'",
            "SR[3]=SUBSTR SR[2],(R[2]+3),1",
            "R[3]=SR[3]",
        ]),
        "R[1]=8 R[2]=5 R[3]=7"
    );
}

#[test]
fn position_registers_by_element_and_as_a_whole() {
    assert_eq!(
        registers(&[
            "PR[1]=P[1]",
            "PR[1,3]=PR[1,3]+100",
            "PR[GP1:2]=PR[1]+PR[1]",
            "R[1]=PR[1,3]",
            "R[2]=PR[2,1]",
            "R[3]=PR[GP1:2,4]",
        ]),
        "R[1]=600 R[2]=2000 R[3]=360"
    );
}

#[test]
fn a_register_without_a_value_is_an_error() {
    let end = lines(&["PR[2]=PR[1]"]).end;
    assert_eq!(
        end,
        "MAIN/MAIN:1: INTP: Uninitialized data: PR[1] has no value"
    );
    // One element does not make a position.
    let end = lines(&["PR[1,1]=100", "R[1]=PR[1,1]", "J PR[1] 100% FINE"]).end;
    assert_eq!(
        end,
        "MAIN/MAIN:3: INTP: Uninitialized data: PR[1] has no value"
    );
    let end = lines(&["J P[9] 100% FINE"]).end;
    assert_eq!(
        end,
        "MAIN/MAIN:1: INTP: Uninitialized data: P[9] has no value"
    );
}

#[test]
fn kinds_of_positions_do_not_mix() {
    let end = lines(&["PR[1]=LPOS", "PR[2]=JPOS", "PR[3]=PR[1]-PR[2]"]).end;
    assert!(end.contains("INTP: Type mismatch"), "{end}");
}

#[test]
fn system_variables_are_read_and_set() {
    assert_eq!(
        registers(&[
            "R[1]=$WAITTMOUT",
            "$WAITTMOUT=200",
            "R[2]=$WAITTMOUT",
            "R[3]=$MCR.$GENOVERRIDE"
        ]),
        "R[1]=3000 R[2]=200 R[3]=100"
    );
    assert!(lines(&["R[1]=$NOT_THERE.$X"]).end.contains("$NOT_THERE.$X"));
}

#[test]
fn a_timer_runs_between_start_and_stop() {
    assert_eq!(
        registers(&[
            "TIMER[1]=RESET",
            "TIMER[1]=START",
            "WAIT 2.00(sec)",
            "TIMER[1]=STOP",
            "WAIT 1.00(sec)",
            "R[1]=(TIMER[1]>1.99 AND TIMER[1]<2.01)",
        ]),
        "R[1]=1"
    );
}

#[test]
fn functions_take_degrees() {
    assert_eq!(
        registers(&[
            "R[1]=SQRT[16]",
            "R[2]=ABS[(-3)]",
            "R[3]=COS[60]",
            "R[4]=ATAN2[1,1]",
            "R[5]=TRUNC[2.7]"
        ]),
        "R[1]=4 R[2]=3 R[3]=0.5 R[4]=45 R[5]=2"
    );
}

#[test]
fn presets_are_read() {
    use depal_tp::{PresetError, parse_preset};
    assert_eq!(parse_preset("1=0"), Ok((1, 0.0)));
    assert_eq!(parse_preset(" 12 = -2.5"), Ok((12, -2.5)));
    assert!(matches!(
        parse_preset("0=1"),
        Err(PresetError::Number { number: 0, .. })
    ));
    for wrong in ["", "1", "R[1]=2", "1=two", "1=inf"] {
        assert!(
            matches!(parse_preset(wrong), Err(PresetError::Form { .. })),
            "{wrong}"
        );
    }
}

#[test]
fn half_a_turn_is_plus_180() {
    let mut system = FakeSystem::default();
    let turned = depal_frames::EulerConvention::FanucWpr
        .pose_from_mm_deg([1.0, 2.0, 3.0, -180.0, 0.0, 90.0]);
    system.arm = Some((depal_frames::JointPositions::zeros(6), turned));
    let text = listing(
        &[
            "PR[1]=LPOS",
            "R[1]=PR[1,4]",
            "R[2]=PR[1,5]",
            "R[3]=PR[1,6]",
            "R[4]=PR[1,1]",
        ],
        "",
    );
    let left = run_all(&[text], &depal_tp::Options::default(), system);
    assert_eq!(left.registers.join(" "), "R[1]=180 R[2]=0 R[3]=90 R[4]=1");
}
