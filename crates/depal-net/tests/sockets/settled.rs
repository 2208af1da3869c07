//! What users may rely on where it concerns sockets, as far as the fault list does not show it.

use std::io::Read;
use std::time::{Duration, Instant};

use depal_interface::Encoding;

use crate::served::{Client, Setup, TRIGGER, ascii, serve};

/// All kinds of ports at once, one session each.
const KINDS: &[Encoding] = &[
    Encoding::Ascii,
    Encoding::HexLittleEndian,
    Encoding::HexBigEndian,
    Encoding::Ascii,
];

#[test]
fn every_port_is_a_session_of_its_own() {
    let served = serve(&Setup {
        kinds: KINDS,
        ..Setup::default()
    });
    let (mut one, mut other) = (served.client_of(0), served.client_of(3));
    one.check(TRIGGER, "101,1102");
    one.send(b"102,1\r");
    other.check("102,1", "102,1020");
    other.check(TRIGGER, "101,1102");
    assert!(one.reply().starts_with("102,1100,1,8,"));
    assert!(other.ask("102,1").starts_with("102,1100,1,8,"));
    for (port, kind) in KINDS.iter().enumerate() {
        served.check_alive(port, *kind);
    }
}

#[test]
fn a_bare_command_is_answered_after_50_ms() {
    let served = ascii();
    let mut robot = served.client();
    let times: Vec<Duration> = (0..10)
        .map(|_| {
            let started = Instant::now();
            robot.send(b"901");
            assert_eq!(robot.reply(), "901,1101");
            started.elapsed()
        })
        .collect();
    let best = *times.iter().min().expect("ten");
    assert!(best >= Duration::from_millis(44), "too early: {best:?}");
    assert!(best < Duration::from_millis(100), "too late: {best:?}");
}

#[test]
fn a_short_record_is_answered_after_20_ms() {
    const LITTLE: Encoding = Encoding::HexLittleEndian;
    let served = serve(&Setup {
        kinds: &[LITTLE],
        ..Setup::default()
    });
    let mut best = Duration::MAX;
    for _ in 0..10 {
        let mut robot = served.client();
        let started = Instant::now();
        robot.send(&crate::served::record(LITTLE, &[901], 63));
        robot.frame();
        best = best.min(started.elapsed());
    }
    assert!(best >= Duration::from_millis(14), "too early: {best:?}");
    assert!(best < Duration::from_millis(70), "too late: {best:?}");
}

#[test]
fn each_waiting_command_holds_up_its_own_connection_in_order() {
    // One port each, so that every command finds something to wait for.
    let waits: &[(&str, &str, &str)] = &[
        (TRIGGER, "102,1", "102,1100,1,8,"),
        ("101,2,0,0,0,0,0,0,0,0", "105,2,1", "105,1"),
        ("201,2,0,-20,10,0,60,0", "205,1", "205,2025"),
        ("201,2,0,-20,10,0,60,0", "210,1", "210,2025"),
        ("901", "601", "601,0"),
    ];
    let kinds = vec![Encoding::Ascii; waits.len()];
    let served = serve(&Setup {
        kinds: &kinds,
        set: &[("interface.timeout_s", "1.5")],
        ..Setup::default()
    });
    let mut robots: Vec<Client> = Vec::new();
    for (port, (start, wait, _)) in waits.iter().enumerate() {
        let mut robot = served.client_of(port);
        robot.ask(start);
        robot.send(format!("{wait}\r901\r999\r").as_bytes());
        robots.push(robot);
    }
    for port in 0..waits.len() {
        served.check_alive(port, Encoding::Ascii);
    }
    for (robot, (_, _, begin)) in robots.iter_mut().zip(waits) {
        let reply = robot.reply();
        assert!(reply.starts_with(begin), "{reply}");
        assert_eq!(robot.reply(), "901,1101");
        assert_eq!(robot.reply(), "999,3001");
    }
}

#[test]
fn one_reply_is_one_write() {
    let served = ascii();
    let mut robot = served.client();
    robot.check(TRIGGER, "101,1102");
    robot.send(b"102,1\r");
    let mut buffer = [0; 4096];
    let count = robot.0.read(&mut buffer).expect("a reply");
    assert_eq!(buffer[count - 1], b'\r', "whole at the first read");
    assert!(buffer.starts_with(b"102,1100,1,8,"));
}

#[test]
fn a_result_outlives_its_connection_and_is_given_once() {
    let served = ascii();
    let mut gone = served.client();
    gone.check(TRIGGER, "101,1102");
    drop(gone);
    let mut next = served.client();
    assert!(next.ask("102,1").starts_with("102,1100,1,8,"));
    served.client().check("102,1", "102,1002");
}

/// The run stands at its branch until both have asked, however busy the computer is.
#[test]
fn who_left_while_waiting_gives_way_to_the_next_who_waits() {
    let served = serve(&Setup {
        set: &[("interface.timeout_s", "60")],
        ..Setup::default()
    });
    let mut gone = served.client();
    gone.check("201,2,0,-20,10,0,60,0", "201,2103");
    gone.send(b"205,1\r");
    drop(gone);
    let mut next = served.client();
    next.send(b"205,1\r");
    assert!(served.has_told("another client waits for the result"));
    let mut third = served.client();
    third.check("203,1,2", "203,2105");
    assert!(next.reply().starts_with("205,2100,1,1,"));
    third.check("205,1", "205,2022");
}

#[test]
fn a_flood_of_64_does_not_delay_a_polite_client() {
    let served = ascii();
    let address = served.ports[0];
    let floods: Vec<_> = (0..64)
        .map(|_| {
            std::thread::spawn(move || {
                let mut robot = Client::connect(address);
                let started = Instant::now();
                while started.elapsed() < Duration::from_secs(2) {
                    robot.send("901\r".repeat(50).as_bytes());
                    let mut replies = [0; 9 * 50];
                    robot.0.read_exact(&mut replies).expect("fifty replies");
                }
            })
        })
        .collect();
    let mut polite = served.client();
    let mut times: Vec<Duration> = (0..50)
        .map(|_| {
            let started = Instant::now();
            polite.check("901", "901,1101");
            started.elapsed()
        })
        .collect();
    times.sort();
    // The load bench looks at the 99th percentile, on a computer that does nothing else.
    assert!(times[25] < Duration::from_millis(50), "{times:?}");
    for flood in floods {
        flood.join().expect("every reply came");
    }
}
