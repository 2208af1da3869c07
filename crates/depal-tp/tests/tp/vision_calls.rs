//! The vision calls: exact bytes in both orders, replies in pieces, and the real server in this process.

use depal_interface::Encoding;
use depal_time::{SimDuration, SimTime};
use depal_tp::{ByteOrder, Options};
use proptest::prelude::*;

use crate::fake_system::*;
use crate::vision::Vision;

mod server;
mod trouble;

/// Cells packed here by hand.
enum Cell {
    Int(i32),
    Real(f32),
}
use Cell::{Int, Real};

fn pack(order: ByteOrder, cells: &[Cell], length: usize) -> Vec<u8> {
    let mut bytes: Vec<u8> = Vec::new();
    for cell in cells {
        bytes.extend(match (cell, order) {
            (Int(v), ByteOrder::BigEndian) => v.to_be_bytes(),
            (Int(v), ByteOrder::LittleEndian) => v.to_le_bytes(),
            (Real(v), ByteOrder::BigEndian) => v.to_be_bytes(),
            (Real(v), ByteOrder::LittleEndian) => v.to_le_bytes(),
        });
    }
    bytes.resize(length, 0);
    bytes
}

const INIT: &str = "CALL MM_INIT_SKT('1','192.168.1.20',50000,5)";

fn at_once(bytes: Vec<u8>) -> Vec<(SimDuration, Vec<u8>)> {
    vec![(SimDuration::from_millis(8), bytes)]
}

/// Runs lines behind MM_INIT_SKT against a script of replies.
fn scripted(order: ByteOrder, text: &[&str], replies: Vec<Vec<(SimDuration, Vec<u8>)>>) -> Left {
    let mut all = vec![INIT];
    all.extend(text);
    let options = Options {
        byte_order: order,
        ..Options::default()
    };
    let system = FakeSystem {
        peer: Script::new(replies),
        ..FakeSystem::default()
    };
    run_all(&[listing(&all, "")], &options, system)
}

#[test]
fn requests_are_big_endian_unless_set() {
    let text = listing(&[INIT, "CALL MM_SET_MOD(1,2,70)"], "");
    let reply = pack(ByteOrder::BigEndian, &[Int(103), Int(1107)], 660);
    let system = FakeSystem {
        peer: Script::new(vec![at_once(reply)]),
        ..FakeSystem::default()
    };
    let left = run_all(&[text], &Options::default(), system);
    assert_eq!(left.end, "");
    assert_eq!(left.trace[0], "0.000 connect 192.168.1.20:50000");
    let mut expected = vec![0, 0, 0, 0x67, 0, 0, 0, 1, 0, 0, 0, 2];
    expected.resize(64, 0);
    assert_eq!(left.system.peer.sent, [expected]);
    assert_eq!(left.registers, ["R[70]=1107"]);
    // A request leaves cell by cell.
    assert_eq!(left.system.peer.writes, 16);
}

#[test]
fn both_byte_orders_of_every_kind_of_cell() {
    for order in [ByteOrder::BigEndian, ByteOrder::LittleEndian] {
        let reply = pack(
            order,
            &[
                Int(102),
                Int(1100),
                Int(1),
                Int(2),
                Int(0),
                Real(95.5),
                Real(644.25),
                Real(401.0),
                Real(-91.0),
                Real(10.0),
                Real(180.0),
                Int(7),
                Int(50),
                Real(1.0),
                Real(2.0),
                Real(3.0),
                Real(4.0),
                Real(5.0),
                Real(6.0),
                Int(8),
                Int(60),
            ],
            660,
        );
        let left = scripted(
            order,
            &[
                "CALL MM_START_VIS(1,0,2,60)",
                "CALL MM_GET_VIS(1,51,52)",
                "CALL MM_GET_POS(1,60,61,62)",
                "R[1]=PR[60,1]",
                "R[2]=PR[60,4]",
                "CALL MM_GET_POS(2,60,63,64)",
                "R[3]=PR[60,6]",
            ],
            vec![
                at_once(pack(order, &[Int(101), Int(1102)], 660)),
                at_once(reply),
            ],
        );
        assert_eq!(left.end, "");
        assert_eq!(
            left.registers.join(" "),
            "R[1]=95.5 R[2]=-91 R[3]=6 R[51]=2 R[52]=1100 R[61]=7 R[62]=50 R[63]=8 R[64]=60"
        );
        // The fake arm's flange: 1, 2, 3 m from the foot, not turned.
        let request = pack(
            order,
            &[
                Int(101),
                Int(1),
                Int(0),
                Int(2),
                Real(1000.0),
                Real(2000.0),
                Real(3000.0),
                Real(0.0),
                Real(0.0),
                Real(0.0),
            ],
            64,
        );
        assert_eq!(left.system.peer.sent[0], request);
        assert_eq!(
            left.system.peer.sent[1],
            pack(order, &[Int(102), Int(1)], 64)
        );
    }
}

#[test]
fn joints_on_the_wire_are_those_of_the_arm() {
    let order = ByteOrder::BigEndian;
    let reply = pack(
        order,
        &[
            Int(205),
            Int(2100),
            Int(1),
            Int(1),
            Int(1),
            Real(10.0),
            Real(20.0),
            Real(30.0),
            Real(0.0),
            Real(0.0),
            Real(0.0),
            Int(0),
            Int(50),
        ],
        660,
    );
    let left = scripted(
        order,
        &[
            "PR[60]=JPOS",
            "R[1]=PR[60,3]",
            "CALL MM_START_VIZ(2,60)",
            "CALL MM_GET_VIZ(1,51,53,52)",
            "CALL MM_GET_JPS(1,61,54,55)",
            "R[2]=PR[61,3]",
        ],
        vec![
            at_once(pack(order, &[Int(201), Int(2103)], 660)),
            at_once(reply),
        ],
    );
    assert_eq!(left.end, "");
    // The fake arm stands at 10, 20, 30, 40, 50, 60 degrees: J3 is shown as 30 - 20.
    assert_eq!(left.registers[..2], ["R[1]=10", "R[2]=10"]);
    let sent = pack(
        order,
        &[
            Int(201),
            Int(2),
            Real(10.0),
            Real(20.0),
            Real(30.0),
            Real(40.0),
            Real(50.0),
            Real(60.0),
        ],
        64,
    );
    assert_eq!(left.system.peer.sent[0], sent);
}

#[test]
fn parts_of_a_list_are_joined() {
    let order = ByteOrder::BigEndian;
    let part = |is_last: i32, count: i32, vision_move: i32, label: i32| {
        let mut cells = vec![
            Int(205),
            Int(2100),
            Int(is_last),
            Int(count),
            Int(vision_move),
        ];
        for k in 0..count {
            cells.extend([
                Real(0.0),
                Real(0.0),
                Real(0.0),
                Real(0.0),
                Real(0.0),
                Real(0.0),
                Int(label + k),
                Int(1),
            ]);
        }
        at_once(pack(order, &cells, 660))
    };
    let left = scripted(
        order,
        &[
            "CALL MM_GET_VIZ(2,51,53,52)",
            "CALL MM_GET_POS(45,60,61,62)",
        ],
        vec![part(0, 20, 0, 100), part(0, 20, 3, 200), part(1, 5, 0, 300)],
    );
    assert_eq!(left.end, "");
    assert_eq!(
        left.registers.join(" "),
        "R[51]=45 R[52]=2100 R[53]=23 R[61]=304 R[62]=1"
    );
}

#[test]
fn listed_outputs_are_switched_on_and_no_other_off() {
    let order = ByteOrder::BigEndian;
    let mut cells = vec![Int(206), Int(2102), Int(2)];
    cells.extend((0..63).map(|_| Int(-1)));
    let left = scripted(
        order,
        &["DO[1]=ON", "CALL MM_GET_DL(0)", "CALL MM_SET_DL"],
        vec![at_once(pack(order, &cells, 660))],
    );
    assert_eq!(left.end, "");
    assert_eq!(
        left.trace[1..].iter().map(|t| &t[6..]).collect::<Vec<_>>(),
        ["DO[1] = 1", "DO[2] = 1"]
    );
}
