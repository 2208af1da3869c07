//! Wrong order, wrong byte order, lost connections, nobody there: the program hears a status that is documented.

use depal_interface::{Encoding, Profile};

use super::cabinet::Cabinet;
use super::*;

const DATA: &str = "DECL INT ST[9]\nDECL INT N,VIS,LAST\nDECL E6POS P\nDECL E6AXIS HOME={A1 0.0,A2 -90.0,A3 90.0,A4 0.0,A5 0.0,A6 0.0}";

fn little() -> Cabinet {
    Cabinet::with_vision(Encoding::HexLittleEndian, Profile::v1_8())
}

const INIT: &str = "  MM_Init_Socket(\"XML_Kuka_MMIND\",873,871,3)\n";

#[test]
fn wrong_order_gives_the_servers_status() {
    let body = format!(
        "{INIT}  MM_Get_VisData(1,LAST,N,ST[1])\n  MM_Get_VizData(1,LAST,N,VIS,ST[2])\n  MM_Get_VisData(2,LAST,N,ST[3])"
    );
    let mut machine = with_module(&body, DATA);
    finished(&mut machine, &mut little());
    assert_eq!(ints(&machine, "ST", 3), [1020, 2022, 1016]);
    assert_eq!(int(&machine, "N"), 0);
}

#[test]
fn a_refusal_without_a_status_output_halts_the_program() {
    let body = format!("{INIT}  MM_Start_Vis(9,0,0,HOME)\n  ST[1]=1");
    let mut machine = with_module(&body, DATA);
    let mut cabinet = little();
    let end = run(&mut machine, &mut cabinet);
    assert!(matches!(end, Step::Stopped(_)), "{end:?}");
    assert_eq!(int(&machine, "MM_LAST_STATUS"), 1011);
    assert!(
        cabinet.log.iter().any(|line| line.contains("1011")),
        "{:?}",
        cabinet.log
    );
    assert_ne!(
        machine
            .global("ST")
            .map(|v| format!("{v:?}").contains("Int(1)")),
        Some(true)
    );
}

#[test]
fn the_other_byte_order_is_3096() {
    let mut machine = with_module(&format!("{INIT}  MM_Get_Status(ST[1])"), DATA);
    let mut cabinet = Cabinet::with_vision(Encoding::HexBigEndian, Profile::v1_8());
    finished(&mut machine, &mut cabinet);
    assert_eq!(ints(&machine, "ST", 1), [3096]);
}

#[test]
fn a_lost_connection_is_3097_and_the_next_command_mends_it() {
    let body =
        format!("{INIT}  MM_Get_Status(ST[1])\n  MM_Get_Status(ST[2])\n  MM_Get_Status(ST[3])");
    let mut machine = with_module(&body, DATA);
    let mut cabinet = little();
    cabinet.closes_after = Some(1);
    // Once closed, the server answers again.
    loop {
        match machine.step(&mut cabinet) {
            Step::Ran => cabinet.advance(SimDuration::from_micros(20)),
            Step::Blocked => cabinet.advance(TICK),
            end => {
                assert_eq!(end, Step::Finished, "{:?}", cabinet.log);
                break;
            }
        }
        if cabinet.is_closed {
            cabinet.closes_after = None;
        }
    }
    assert_eq!(ints(&machine, "ST", 3), [1101, 3097, 1101]);
}

#[test]
fn no_reply_is_3098_after_the_programs_time() {
    let mut machine = with_module(&format!("{INIT}  MM_Get_Status(ST[1])"), DATA);
    let mut cabinet = Cabinet::new();
    finished(&mut machine, &mut cabinet);
    assert_eq!(ints(&machine, "ST", 1), [3098]);
    let seconds = cabinet.now.as_secs_f64();
    assert!((3.0..3.1).contains(&seconds), "{seconds}");
}

#[test]
fn nobody_there_is_3099() {
    for deaf in [false, true] {
        let mut machine = with_module(INIT, DATA);
        let mut cabinet = Cabinet::new();
        cabinet.refuses = !deaf;
        cabinet.is_deaf = deaf;
        let end = run(&mut machine, &mut cabinet);
        assert!(matches!(end, Step::Stopped(_)), "{end:?}");
        assert_eq!(int(&machine, "MM_LAST_STATUS"), 3099);
        assert!(
            cabinet.log.iter().any(|l| l.contains("EKI00021")),
            "{:?}",
            cabinet.log
        );
        // TIMEOUT Connect of the file, 5 s.
        let seconds = cabinet.now.as_secs_f64();
        assert_eq!(deaf, (5.0..5.1).contains(&seconds), "{seconds}");
    }
}

#[test]
fn an_index_without_data_halts() {
    let mut machine = with_module(&format!("{INIT}  MM_Get_Pose(1,P,N,VIS)"), DATA);
    let mut cabinet = little();
    let end = run(&mut machine, &mut cabinet);
    assert!(matches!(end, Step::Stopped(_)), "{end:?}");
}

#[test]
fn a_program_that_starts_again_finds_no_old_state() {
    let body = format!("{INIT}{INIT}  MM_Get_Status(ST[1])");
    let mut machine = with_module(&body, DATA);
    finished(&mut machine, &mut little());
    assert_eq!(ints(&machine, "ST", 1), [1101]);
}

#[test]
fn a_calibration_pose_out_of_reach_is_reported() {
    let mut machine = with_module(&format!("{INIT}  MM_Calib(1,1,0.0,0.0)"), DATA);
    let mut cabinet = little();
    cabinet.is_out_of_reach = true;
    let end = run(&mut machine, &mut cabinet);
    assert!(matches!(end, Step::Stopped(_)), "{end:?}");
    assert_eq!(cabinet.answered, [7101, 7004]);
    assert_eq!(cabinet.moves.len(), 0);
}
