//! Refusals, lost connections and wrong arguments.

use super::*;

#[test]
fn a_refusal_goes_to_the_status_register_or_stops_the_program() {
    let order = ByteOrder::BigEndian;
    let refusal =
        |command: i32, code: i32| vec![at_once(pack(order, &[Int(command), Int(code)], 660))];
    let left = scripted(order, &["CALL MM_GET_VIS(1,51,52)"], refusal(102, 1020));
    assert_eq!(
        (left.end.as_str(), left.registers.join(" ").as_str()),
        ("", "R[51]=0 R[52]=1020")
    );
    let left = scripted(order, &["CALL MM_SET_MOD(1,9,70)"], refusal(103, 1012));
    assert_eq!(
        (left.end.as_str(), left.registers.join(" ").as_str()),
        ("", "R[70]=1012")
    );
    let left = scripted(order, &["CALL MM_START_VIS(9,0,0,60)"], refusal(101, 1011));
    assert!(
        left.end
            .starts_with("MAIN/MAIN:2: Robot_CMD_Error: MM_START_VIS: status 1011"),
        "{}",
        left.end
    );
}

#[test]
fn the_wrong_byte_order_is_noticed() {
    let little = pack(ByteOrder::LittleEndian, &[Int(901), Int(1101)], 660);
    let left = scripted(
        ByteOrder::BigEndian,
        &["CALL MM_GET_STAT(70)", "CALL MM_GET_STAT(71)"],
        vec![at_once(little)],
    );
    // Then the connection is closed.
    assert_eq!(
        (left.end.as_str(), left.registers.join(" ").as_str()),
        ("", "R[70]=3096 R[71]=3099")
    );
}

#[test]
fn the_connection_can_be_opened_again() {
    let little = pack(ByteOrder::LittleEndian, &[Int(901), Int(1101)], 660);
    let big = pack(ByteOrder::BigEndian, &[Int(901), Int(1101)], 660);
    let left = scripted(
        ByteOrder::BigEndian,
        &["CALL MM_GET_STAT(70)", INIT, "CALL MM_GET_STAT(71)"],
        vec![at_once(little), at_once(big)],
    );
    assert_eq!(
        (left.end.as_str(), left.registers.join(" ").as_str()),
        ("", "R[70]=3096 R[71]=1101")
    );
}

#[test]
fn without_a_connection() {
    let left = run_text(&listing(
        &["CALL MM_GET_STAT(70)", "CALL MM_SET_BS(1,400,300,250)"],
        "",
    ));
    assert_eq!(left.registers, ["R[70]=3099"]);
    assert!(
        left.end
            .starts_with("MAIN/MAIN:2: Robot_Socket_Closed: MM_SET_BS"),
        "{}",
        left.end
    );
    let system = FakeSystem {
        connect_after: None,
        ..FakeSystem::default()
    };
    let text = listing(&["CALL MM_INIT_SKT('1','1.2.3.4',50000,5,70)", INIT], "");
    let left = run_all(&[text], &Options::default(), system);
    assert_eq!(left.registers, ["R[70]=3099"]);
    assert!(
        left.end.starts_with("MAIN/MAIN:2: Robot_Socket_Closed"),
        "{}",
        left.end
    );
}

#[test]
fn a_connection_lost_on_the_way_is_a_status() {
    let half = pack(
        ByteOrder::BigEndian,
        &[Int(205), Int(2100), Int(1), Int(20), Int(3)],
        100,
    );
    let system = FakeSystem {
        peer: Script::new(vec![vec![(SimDuration::from_millis(8), half)]]),
        peer_closes_at: Some(SimTime::from_nanos(2_000_000_000)),
        ..FakeSystem::default()
    };
    let text = listing(
        &[
            INIT,
            "CALL MM_GET_VIZ(2,51,53,52)",
            "IF R[52]<>2100,JMP LBL[9]",
            "J PR[1] 10% FINE",
            "LBL[9]",
            "R[99]=1",
        ],
        "",
    );
    let left = run_all(&[text], &Options::default(), system);
    assert_eq!(left.end, "");
    assert_eq!(
        left.registers.join(" "),
        "R[51]=0 R[52]=3097 R[53]=0 R[99]=1"
    );
}

#[test]
fn no_reply_in_the_time_of_init() {
    let left = run_text(&listing(
        &[
            "CALL MM_INIT_SKT('2','1.2.3.4',50000,.1)",
            "TIMER[1]=START",
            "CALL MM_GET_STAT(70)",
            "R[1]=TIMER[1]",
        ],
        "",
    ));
    assert_eq!(left.registers[1], "R[70]=3098");
    let seconds: f64 = left.registers[0][5..].parse().unwrap();
    assert!((seconds - 6.0).abs() < 0.01, "{seconds}");
}

#[test]
fn wrong_arguments() {
    for (call, part) in [
        ("CALL MM_INIT_SKT('9','1.2.3.4',50000,5)", "the tag"),
        ("CALL MM_INIT_SKT('1','1.2.3.4',70000,5)", "no port"),
        ("CALL MM_GET_POS(1,60,61,62)", "0 points are held"),
    ] {
        let left = lines(&[call]);
        assert!(left.end.contains("Robot_Argument_Error"), "{}", left.end);
        assert!(left.end.contains(part), "{}", left.end);
    }
    let left = lines(&[INIT, "PR[60]=LPOS", "CALL MM_START_VIZ(2,60)"]);
    assert!(
        left.end.contains("PR[60] must hold joint angles"),
        "{}",
        left.end
    );
}
