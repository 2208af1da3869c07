//! What is odd but no fault, and how the link comes back: rows of the fault table with a course of their own.

use std::net::TcpListener;
use std::thread;
use std::time::{Duration, Instant};

use depal_wire::s7::{Field, S7Body, Setup};

use super::fake_plc::{Act, FakePlc, Fault, Packet};
use super::vision::Vision;

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
