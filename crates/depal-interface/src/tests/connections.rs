//! What outlives a connection, what it may be flooded with, what is logged of it, and how it is set up.

use super::*;

#[test]
fn results_outlive_the_connection_and_come_once() {
    let mut bench = Bench::new();
    let job = bench.start_viz();
    bench.check("205,1", "");
    bench.server.handle_disconnect(bench.now, PORT, CLIENT);
    bench.finish_viz(job, Ok(path(1, None)));
    assert_eq!(bench.replies(), Vec::<String>::new());
    let next = ConnectionId(2);
    bench.server.handle_connect(bench.now, PORT, next);
    bench.send(next, "205,1\r205,1");
    let replies = bench.replies();
    assert!(replies[0].starts_with("205,2100,1,1,0,1.0"), "{replies:?}");
    assert_eq!(replies[1], "205,2022");
}

#[test]
fn swapped_bytes_are_named_in_the_log() {
    let mut bench = Bench::with_port(PortSettings {
        encoding: Encoding::HexLittleEndian,
        ..PortSettings::default()
    });
    let mut frame = [0u8; 64];
    frame[..4].copy_from_slice(&901i32.to_be_bytes());
    bench.server.handle_input(bench.now, PORT, CLIENT, &frame);
    bench.wait(20);
    let reply = bench.server.poll_reply().unwrap();
    assert_eq!(reply.status, Some(Status::InvalidCommand));
    assert_eq!(reply.bytes[..4], frame[..4]);
    let entry = bench.server.poll_log().unwrap();
    assert!(
        entry.text.contains("byte order? Swapped it is 901"),
        "{}",
        entry.text
    );
}

#[test]
fn the_log_names_what_was_said() {
    let mut bench = Bench::new();
    bench.check("901", "901,1101");
    bench.check("103,1", "103,3002");
    let log: Vec<_> = std::iter::from_fn(|| bench.server.poll_log())
        .map(|e| (e.direction, e.command, e.status, e.text))
        .collect();
    let expected = [
        (Direction::Received, 901, None, "901 (get state)"),
        (Direction::Sent, 901, Some(1101), "901,1101 (vision ready)"),
        (
            Direction::Received,
            103,
            None,
            "refused: field 3 is missing",
        ),
        (
            Direction::Sent,
            103,
            Some(3002),
            "103,3002 (wrong number or form of parameters)",
        ),
    ];
    assert_eq!(log, expected.map(|(d, c, s, t)| (d, c, s, t.to_owned())));
}

#[test]
fn an_endless_line_is_cut() {
    let mut bench = Bench::new();
    bench
        .server
        .handle_input(bench.now, PORT, CLIENT, &[b'7'; 5000]);
    let reply = bench.server.poll_reply().unwrap();
    assert!(reply.closes);
    bench.check("901", "");
}

#[test]
fn a_flood_behind_a_waiting_request_is_cut() {
    let mut bench = Bench::new();
    bench.start_viz();
    bench.check("205,1", "");
    for _ in 0..20 {
        let flood = "901\r".repeat(1_000);
        bench
            .server
            .handle_input(bench.now, PORT, CLIENT, flood.as_bytes());
    }
    assert!(bench.server.poll_reply().unwrap().closes);
    assert_eq!(bench.server.poll_reply(), None);
    assert_eq!(bench.server.poll_timeout(), None);
}

#[test]
fn sessions_do_not_touch_one_another() {
    let settings = ServerSettings {
        ports: vec![PortSettings::default(), PortSettings::default()],
        ..ServerSettings::default()
    };
    let mut server = Server::new(settings).unwrap();
    for port in [PortId(0), PortId(1)] {
        server.handle_connect(SimTime::ZERO, port, CLIENT);
        server.handle_input(SimTime::ZERO, port, CLIENT, b"201,0\r");
        assert_eq!(server.poll_reply().unwrap().bytes, b"201,2103\r");
    }
    let jobs: Vec<_> = std::iter::from_fn(|| server.poll_job()).collect();
    assert!(matches!(
        jobs[1],
        Job::StartViz {
            job_id: JobId {
                port: PortId(1),
                number: 1
            },
            ..
        }
    ));
}

#[test]
fn settings_are_checked() {
    let mut settings = ServerSettings::default();
    settings.ports[0].profile.pose_cap = 31;
    let refused = Server::new(settings).unwrap_err();
    assert_eq!(refused, InterfaceError::PoseCap { port: 0, found: 31 });
    let mut settings = ServerSettings::default();
    settings.projects.push(settings.projects[0].clone());
    assert_eq!(
        settings.check(),
        Err(InterfaceError::DuplicateProject { id: 1 })
    );
}
