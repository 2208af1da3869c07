//! Rows of the fault table: what the controller does wrong, what people are told, and that all is well after.

use std::thread;

use depal_wire::s7::{ReturnCode, S7Body, Setup, VarData};

use super::fake_plc::{Act, FakePlc, Fault, Packet};
use super::vision::Vision;

/// Faults of the first two connections; then the controller behaves. The text is told, and commands run.
#[test]
fn faults_are_told_and_survived() {
    fn early(packet: &Packet<'_>, number: usize, act: Act) -> Act {
        if packet.connection <= 2 && packet.number == number {
            act
        } else {
            Act::Normal
        }
    }
    /// On the first read or write of variables after the greeting.
    fn later(packet: &Packet<'_>, act: Act) -> Act {
        early(packet, 6, act)
    }
    fn setup(pdu: u16) -> S7Body {
        S7Body::SetupReply(Setup {
            calling_jobs: 1,
            called_jobs: 1,
            pdu,
        })
    }
    fn each_value(body: S7Body, change: impl Fn(VarData) -> Result<VarData, ReturnCode>) -> S7Body {
        match body {
            S7Body::ReadReply(values) => {
                S7Body::ReadReply(values.into_iter().map(|value| change(value?)).collect())
            }
            S7Body::WriteReply(_) => S7Body::WriteReply(vec![ReturnCode::ACCESS_DENIED]),
            other => other,
        }
    }
    let cases: Vec<(&str, Fault, &str)> = vec![
        (
            "50 silent",
            |p| early(p, 0, Act::Silence),
            "no complete answer to connecting within 2.5 s",
        ),
        ("50 reset", |p| early(p, 0, Act::Reset), "connection lost"),
        (
            "50 reset later",
            |p| later(p, Act::Reset),
            "connection lost",
        ),
        (
            "50 closed",
            |p| later(p, Act::Close),
            "connection closed by the PLC",
        ),
        (
            "50 silent later",
            |p| later(p, Act::Silence),
            "no complete answer to a read within 2.5 s",
        ),
        (
            "51 length 0",
            |p| early(p, 0, Act::Raw(&[3, 0, 0, 0])),
            "frame of 0 bytes, expected 7 to 487",
        ),
        (
            "51 length 3",
            |p| later(p, Act::Raw(&[3, 0, 0, 3])),
            "frame of 3 bytes",
        ),
        (
            "51 length 4",
            |p| later(p, Act::Raw(&[3, 0, 0, 4])),
            "frame of 4 bytes",
        ),
        (
            "51 length 65535",
            |p| later(p, Act::Raw(&[3, 0, 0xff, 0xff])),
            "frame of 65535 bytes",
        ),
        (
            "51 version 2",
            |p| early(p, 1, Act::Raw(&[2, 0, 0, 7, 2, 0xf0, 0x80])),
            "found version 2",
        ),
        (
            "51 HTTP",
            |p| early(p, 0, Act::Raw(b"HTTP/1.1 400 Bad Request\r\n")),
            "expected ISO on TCP",
        ),
        (
            "52 disconnect",
            |p| early(p, 0, Act::Raw(&[3, 0, 0, 11, 6, 0x80, 0, 1, 0, 0, 3])),
            "rack 0, slot 1 refused (reason 3)",
        ),
        (
            "52 reject",
            |p| early(p, 0, Act::Raw(&[3, 0, 0, 9, 4, 0x70, 0, 1, 2])),
            "rack 0, slot 1 refused (reason 2)",
        ),
        (
            "52 data instead of a confirmation",
            |p| early(p, 0, Act::Raw(&[3, 0, 0, 8, 2, 0xf0, 0x80, 0x32])),
            "answer to connecting has another packet, expected a confirmation",
        ),
        (
            "53 PDU 0",
            |p| early(p, 1, Act::Body(|_| setup(0))),
            "grants telegrams of 0 bytes, at least 64",
        ),
        (
            "53 PDU 1",
            |p| early(p, 1, Act::Body(|_| setup(1))),
            "grants telegrams of 1 bytes",
        ),
        (
            "53 PDU 63",
            |p| early(p, 1, Act::Body(|_| setup(63))),
            "grants telegrams of 63 bytes",
        ),
        (
            "53 setup refused",
            |p| {
                early(
                    p,
                    1,
                    Act::Body(|_| S7Body::Refusal {
                        class: 0x85,
                        code: 0,
                    }),
                )
            },
            "the setup refused with error 0x85 0x00 (DB 1, rack 0, slot 1)",
        ),
        (
            "54 longer than asked",
            |p| {
                later(
                    p,
                    Act::Body(|b| {
                        each_value(b, |mut v| {
                            v.bytes.extend([9, 9]);
                            Ok(v)
                        })
                    }),
                )
            },
            "answer to a read has 4 bytes, expected 2 bytes",
        ),
        (
            "54 much longer than agreed",
            |p| {
                later(
                    p,
                    Act::Body(|b| each_value(b, |_| Ok(VarData::bytes(&[7; 1000])))),
                )
            },
            "frame of 1025 bytes, expected 7 to 487",
        ),
        (
            "54 shorter than asked",
            |p| {
                later(
                    p,
                    Act::Body(|b| each_value(b, |_| Ok(VarData::bytes(&[1])))),
                )
            },
            "answer to a read has 1 bytes, expected 2 bytes",
        ),
        (
            "54 claims more than it carries",
            |p| {
                later(
                    p,
                    Act::Change(|mut frame| {
                        // Length field of the item: 16 bits become 64.
                        let at = frame.len() - 3;
                        frame[at] = 64;
                        frame
                    }),
                )
            },
            "unreadable answer: value of an item: expected 12 bytes, found 6",
        ),
        (
            "54 no item",
            |p| later(p, Act::Body(|_| S7Body::ReadReply(Vec::new()))),
            "answer to a read has 0 items, expected 1 item",
        ),
        (
            "54 two items",
            |p| {
                later(
                    p,
                    Act::Body(|b| match b {
                        S7Body::ReadReply(mut values) => {
                            values.extend_from_within(..);
                            S7Body::ReadReply(values)
                        }
                        other => other,
                    }),
                )
            },
            "answer to a read has 2 items, expected 1 item",
        ),
        (
            "54 an answer to something else",
            |p| later(p, Act::Body(|_| S7Body::WriteReply(vec![ReturnCode::OK]))),
            "answer to a read has an answer to something else, expected values",
        ),
        (
            "54 half a telegram, then silence",
            |p| later(p, Act::Change(|frame| frame[..frame.len() / 2].to_vec())),
            "no complete answer to a read within 2.5 s",
        ),
        (
            "56 code 0x05",
            |p| {
                early(
                    p,
                    3,
                    Act::Body(|b| each_value(b, |_| Err(ReturnCode::BAD_ADDRESS))),
                )
            },
            "DB 1, bytes 9694 to 9695: code 0x05, address out of range; the block needs 9696 bytes",
        ),
        (
            "56 code 0x0a",
            |p| {
                early(
                    p,
                    2,
                    Act::Body(|b| each_value(b, |_| Err(ReturnCode::NO_OBJECT))),
                )
            },
            "DB 1, bytes 194 to 203: code 0x0a, object does not exist",
        ),
        (
            "56 code 0x03",
            |p| {
                later(
                    p,
                    Act::Body(|b| each_value(b, |_| Err(ReturnCode::ACCESS_DENIED))),
                )
            },
            "DB 1, bytes 0 to 1: code 0x03, access denied",
        ),
        (
            "56 an unknown code",
            |p| later(p, Act::Body(|b| each_value(b, |_| Err(ReturnCode(0x42))))),
            "code 0x42, unknown code",
        ),
        (
            "61 read-only",
            |p| early(p, 4, Act::Body(|b| each_value(b, Ok))),
            "DB 1, bytes 198 to 198: code 0x03, access denied",
        ),
        (
            "61 no permission",
            |p| {
                later(
                    p,
                    Act::Body(|_| S7Body::Refusal {
                        class: 0x87,
                        code: 0,
                    }),
                )
            },
            "a read refused with error 0x87 0x00 (DB 1, rack 0, slot 1)",
        ),
    ];
    // Side by side: some of them have to wait.
    thread::scope(|scope| {
        for (name, fault, told) in cases {
            let case = move || {
                let plc = FakePlc::start(fault);
                let vision = Vision::at(plc.plc());
                vision.wait_told(told);
                assert_eq!(vision.run_count(), 0, "{name}: nothing runs by a fault");
                plc.fetch();
                assert_eq!(vision.run_count(), 1, "{name}");
                assert!(
                    vision.has_told("connected to DB 1, rack 0, slot 1"),
                    "{name}"
                );
            };
            let named = thread::Builder::new().name(name.to_owned());
            named.spawn_scoped(scope, case).expect("a thread");
        }
    });
}
