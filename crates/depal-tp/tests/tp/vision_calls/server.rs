//! Every call against the real server in this process.

use super::*;

fn every_call(order: ByteOrder, encoding: Encoding) -> Left {
    let text =
        include_str!("../../../../../assets/tp/MM_ALL.LS").replace("/PROG  MM_ALL", "/PROG  MAIN");
    let options = Options {
        byte_order: order,
        ..Options::default()
    };
    let system = FakeSystem {
        peer: Script {
            vision: Some(Box::new(Vision::new(encoding))),
            ..Script::default()
        },
        ..FakeSystem::default()
    };
    run_all(&[text], &options, system)
}

#[test]
fn every_call_once_against_the_server() {
    for (order, encoding) in [
        (ByteOrder::BigEndian, Encoding::HexBigEndian),
        (ByteOrder::LittleEndian, Encoding::HexLittleEndian),
    ] {
        let left = every_call(order, encoding);
        assert_eq!(left.end, "");
        let told = left.registers.join(" ");
        for register in [
            "R[70]=1101",
            "R[51]=23",
            "R[52]=1100",
            "R[61]=0",
            "R[53]=3",
            "R[54]=2",
            "R[55]=1103",
            "R[56]=2",
            "R[57]=1100",
            "R[65]=5",
            "R[66]=2.5",
            "R[67]=3.5",
            "R[10]=2109",
            "R[11]=6.5",
            "R[12]=2108",
            "R[13]=77",
            "R[14]=3",
            "R[15]=2",
            "R[16]=2100",
            "R[17]=3",
            "R[18]=2",
            "R[19]=2100",
            "R[20]=2",
            "R[21]=1",
            "R[22]=40",
            "R[131]=3",
            "R[141]=4",
            "R[142]=2",
            "R[143]=1",
            "R[144]=10",
            "R[151]=250",
            "R[200]=0",
        ] {
            assert!(
                told.split(' ').any(|r| r == register),
                "{register} is not among {told}"
            );
        }
        let outputs: Vec<_> = left
            .trace
            .iter()
            .filter(|t| t.contains("DO["))
            .map(|t| &t[6..])
            .collect();
        assert_eq!(outputs, ["DO[1] = 1", "DO[2] = 1"]);
        // The calibration: five points, and back to where it began.
        assert_eq!(left.trace.iter().filter(|t| t.contains("Joint")).count(), 6);
    }
}

#[test]
fn the_other_byte_order_meets_no_success() {
    let left = every_call(ByteOrder::LittleEndian, Encoding::HexBigEndian);
    assert!(left.end.contains("Robot_"), "{}", left.end);
    assert!(
        !left.registers.iter().any(|r| r == "R[70]=1101"),
        "{:?}",
        left.registers
    );
}

proptest! {
    /// However a reply is cut, the result is the same.
    #[test]
    fn a_reply_may_come_in_any_pieces(cuts in prop::collection::vec((1usize..200, 0u64..40), 0..20)) {
        let order = ByteOrder::BigEndian;
        let cells = [
            Int(102), Int(1100), Int(1), Int(1), Int(0),
            Real(95.5), Real(644.25), Real(401.0), Real(-91.0), Real(10.0), Real(180.0), Int(7), Int(50),
        ];
        let mut rest = pack(order, &cells, 660);
        let mut pieces = Vec::new();
        let mut at = 0;
        for (length, delay) in cuts {
            at += delay;
            let tail = rest.split_off(length.min(rest.len()));
            pieces.push((SimDuration::from_millis(at), std::mem::replace(&mut rest, tail)));
        }
        pieces.push((SimDuration::from_millis(at + 4), rest));
        let left = scripted(
            order,
            &["CALL MM_GET_VIS(1,51,52)", "CALL MM_GET_POS(1,60,61,62)", "R[1]=PR[60,2]"],
            vec![pieces],
        );
        prop_assert_eq!(left.registers.join(" "), "R[1]=644.25 R[51]=1 R[52]=1100 R[61]=7 R[62]=50");
    }
}
