//! Rows of the fault table: what the controller does wrong, what people are told, and that all is well after.

use std::net::TcpListener;
use std::thread;
use std::time::{Duration, Instant};

use depal_wire::s7::{Field, ReturnCode, S7Body, Setup, VarData};

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

/// Odd, but allowed: no reconnect, no trouble.
#[test]
fn oddities_are_no_faults() {
    fn pdu(body: S7Body, pdu: u16) -> S7Body {
        match body {
            S7Body::SetupReply(setup) => S7Body::SetupReply(Setup { pdu, ..setup }),
            other => other,
        }
    }
    let cases: Vec<(&str, Fault, u16)> = vec![
        (
            "53 PDU 64",
            |p| {
                if p.number == 1 {
                    Act::Body(|b| pdu(b, 64))
                } else {
                    Act::Normal
                }
            },
            64,
        ),
        (
            "53 PDU 112",
            |p| {
                if p.number == 1 {
                    Act::Body(|b| pdu(b, 112))
                } else {
                    Act::Normal
                }
            },
            112,
        ),
        (
            "53 PDU 65535",
            |p| {
                if p.number == 1 {
                    Act::Body(|b| pdu(b, 65_535))
                } else {
                    Act::Normal
                }
            },
            480,
        ),
        // A late answer to somebody else's question, before each good one.
        (
            "55 wrong reference",
            |p| {
                if p.is_transfer() {
                    Act::Change(|frame| {
                        let mut late = frame.clone();
                        late[11] ^= 0x55;
                        // It would be taken for a pressed Trigger.
                        if let Some(last) = late.last_mut() {
                            *last ^= 1;
                        }
                        [late, frame].concat()
                    })
                } else {
                    Act::Normal
                }
            },
            480,
        ),
        (
            "54 two segments",
            |p| {
                if p.number < 12 {
                    Act::Pieces(9, Duration::from_millis(20))
                } else {
                    Act::Normal
                }
            },
            480,
        ),
        (
            "54 single bytes",
            |p| {
                if p.number < 40 {
                    Act::Pieces(1, Duration::ZERO)
                } else {
                    Act::Normal
                }
            },
            480,
        ),
    ];
    thread::scope(|scope| {
        for (name, fault, pdu) in cases {
            let case = move || {
                let plc = FakePlc::start(fault);
                let vision = Vision::at(plc.plc());
                plc.fetch();
                vision.wait_told(&format!("telegrams of {pdu} bytes"));
                let told = vision.told.lock().expect("alive").clone();
                assert_eq!(told.len(), 1, "{name}: {told:?}");
                let connections = plc.connections.load(std::sync::atomic::Ordering::SeqCst);
                assert_eq!(connections, 1, "{name}");
                assert_eq!(vision.run_count(), 1, "{name}");
            };
            let named = thread::Builder::new().name(name.to_owned());
            named.spawn_scoped(scope, case).expect("a thread");
        }
    });
}

/// Row 50: nobody listens at first. Few attempts, and a heartbeat soon after the controller is there.
#[test]
fn attempts_are_few_and_never_end() {
    let reserved = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = reserved.local_addr().expect("bound");
    drop(reserved);
    let vision = Vision::at(crate::s7::PlcAddress::new(address));
    vision.wait_told("cannot connect");
    thread::sleep(Duration::from_secs(9));
    assert_eq!(vision.told.lock().expect("alive").len(), 1, "told once");
    let back = Instant::now();
    let Ok(listener) = TcpListener::bind(address) else {
        println!("skipped: another program has taken port {}", address.port());
        return;
    };
    let plc = FakePlc::start_on(listener, |_| Act::Normal);
    plc.wait("a heartbeat", |block| block.bool(Field::Heartbeat));
    assert!(
        back.elapsed() < Duration::from_secs(7),
        "{:?}",
        back.elapsed()
    );
    plc.fetch();

    // A controller that refuses each attempt at once is not asked more often than back-off allows.
    let plc = FakePlc::start(|_| Act::Reset);
    let _vision = Vision::at(plc.plc());
    thread::sleep(Duration::from_secs(3));
    // 0.2, 0.4, 0.8, 1.6 s between them.
    let attempts = plc.connections.load(std::sync::atomic::Ordering::SeqCst);
    assert!((3..=5).contains(&attempts), "{attempts} attempts in 3 s");
}

/// Rows 57 to 59 over a socket; the state machine has the details.
#[test]
fn rules_of_the_handshake_hold_on_the_wire() {
    let plc = FakePlc::start(|_| Act::Normal);
    let vision = Vision::at(plc.plc());
    // 57: Trigger stays 1, and another command is put there without an edge.
    plc.block(|block| {
        block.set_int(Field::Project, 0, 1);
        block.set_int(Field::Command, 0, 101);
        block.set_bool(Field::Trigger, true);
    });
    plc.wait("101", |block| block.int(Field::Status, 0) == 1102);
    plc.block(|block| block.set_int(Field::Command, 0, 102));
    thread::sleep(Duration::from_millis(300));
    assert_eq!(plc.block(|block| block.int(Field::Status, 0)), 1102);
    assert!(plc.block(|block| block.bool(Field::Acknowledge)));
    assert_eq!(vision.run_count(), 1);
    plc.block(|block| block.set_bool(Field::Trigger, false));
    plc.wait("Acknowledge falls", |block| !block.bool(Field::Acknowledge));
    // 58: the controller does not reset Status of Pose Sent: the next edge does.
    assert_eq!(plc.call(102), 1100);
    plc.wait("the flag", |block| block.bool(Field::PoseSent));
    assert_eq!(plc.call(102), 1002);
    assert!(!plc.block(|block| block.bool(Field::PoseSent)));
    // 59: no numbers, and no command.
    plc.block(|block| {
        block.set_int(Field::PoseType, 0, 2);
        block.set_real(Field::Flange, 0, f32::NAN);
    });
    assert_eq!(plc.call(101), 1006);
    plc.block(|block| block.set_real(Field::Flange, 0, 1e38));
    assert_eq!(plc.call(101), 1006);
    assert_eq!(plc.call(-1), 3001);
    assert_eq!(vision.run_count(), 1);
}

/// Row 60: the cable is pulled at each write of a result, before or after the controller has taken it in.
#[test]
fn a_pulled_cable() {
    fn lost(packet: &Packet<'_>, field: Field, act: Act) -> Act {
        // 102 is the second command: its flags are written on the first connection, too.
        if packet.connection == 1 && packet.writes(field) {
            act
        } else {
            Act::Normal
        }
    }
    let cases: Vec<(&str, Fault)> = vec![
        ("poses unseen", |p| lost(p, Field::TargetPose, Act::Close)),
        ("poses", |p| lost(p, Field::TargetPose, Act::CloseAfter)),
        ("labels unseen", |p| lost(p, Field::TargetLabel, Act::Reset)),
        ("labels", |p| lost(p, Field::TargetLabel, Act::CloseAfter)),
        ("counts", |p| lost(p, Field::PoseCount, Act::CloseAfter)),
        ("flag unseen", |p| lost(p, Field::PoseSent, Act::Close)),
        ("flag", |p| lost(p, Field::PoseSent, Act::CloseAfter)),
        ("Acknowledge unseen", |p| {
            lost(p, Field::Acknowledge, Act::Close)
        }),
        ("Acknowledge", |p| {
            lost(p, Field::Acknowledge, Act::CloseAfter)
        }),
        ("Status unseen", |p| lost(p, Field::Status, Act::Close)),
        ("Status", |p| lost(p, Field::Status, Act::CloseAfter)),
    ];
    thread::scope(|scope| {
        for (name, fault) in cases {
            let case = move || {
                let plc = FakePlc::start(fault);
                let vision = Vision::at(plc.plc());
                plc.fetch();
                assert_eq!(vision.run_count(), 1, "{name}: no command runs twice");
                let written = plc.written.lock().expect("alive").clone();
                let flag = written.iter().rposition(|field| *field == Field::PoseSent);
                use Field::*;
                assert!(
                    written[..=flag.expect("written")].ends_with(&[
                        TargetPose,
                        TargetLabel,
                        PoseCount,
                        Status,
                        PoseSent
                    ]),
                    "{name}: {written:?}"
                );
            };
            let named = thread::Builder::new().name(name.to_owned());
            named.spawn_scoped(scope, case).expect("a thread");
        }
    });
}

/// Row 61: one of two controllers has no such block; the other one does not notice.
#[test]
fn one_bad_controller_of_two() {
    let good = FakePlc::start(|_| Act::Normal);
    let bad = FakePlc::start(|_| Act::Normal);
    let vision = Vision::at(good.plc());
    let other = Vision::at(crate::s7::PlcAddress { db: 2, ..bad.plc() });
    other.wait_told("DB 2, bytes 194 to 203: code 0x0a, object does not exist");
    for _ in 0..20 {
        good.fetch();
    }
    assert_eq!(vision.run_count(), 20);
    assert_eq!(vision.told.lock().expect("alive").len(), 1);
    assert_eq!(bad.written.lock().expect("alive").len(), 0);
}

/// Two changes a second apart, whatever the controller is asked meanwhile.
#[test]
fn heartbeat_on_the_wire() {
    let plc = FakePlc::start(|_| Act::Normal);
    let _vision = Vision::at(plc.plc());
    let started = Instant::now();
    while started.elapsed() < Duration::from_millis(5_500) {
        plc.fetch();
    }
    let beats = plc.beats.lock().expect("alive").clone();
    assert!((5..=7).contains(&beats.len()), "{}", beats.len());
    for pair in beats.windows(2) {
        let apart = pair[1] - pair[0];
        let allowed = Duration::from_millis(600)..Duration::from_millis(1_500);
        assert!(allowed.contains(&apart), "{apart:?}");
    }
}
