//! Every fault has its effect, and without it the same dialogue goes as ever.

use super::*;

const OTHER: ConnectionId = ConnectionId(2);

fn bench(faults: &[&str]) -> Bench {
    with_profile(faults, Profile::v1_8())
}

fn with_profile(faults: &[&str], profile: Profile) -> Bench {
    let settings = ServerSettings {
        ports: vec![PortSettings::of_profile(profile)],
        viz: Some(VizProject {
            branches: vec![BranchStep { step: 7, exits: 2 }],
            ..VizProject::default()
        }),
        faults: FaultScript::parse(faults).unwrap(),
        ..ServerSettings::default()
    };
    let mut server = Server::new(settings).unwrap();
    server.handle_connect(SimTime::ZERO, PORT, CLIENT);
    server.handle_connect(SimTime::ZERO, PORT, OTHER);
    Bench {
        server,
        now: SimTime::ZERO,
    }
}

fn told(text: &str) -> String {
    FaultScript::parse(&[text]).unwrap_err().to_string()
}

#[test]
fn what_is_written_wrong_is_named() {
    for (text, expected) in [
        (
            "no_point@pick=4",
            "fault \"no_point@pick=4\": name: expected one of no_points, camera_lost, status, delay, drop_connection, \
             split_replies, found \"no_point\"; did you mean \"no_points\"?",
        ),
        (
            "no_points@pik=4",
            "fault \"no_points@pik=4\": key: expected pick=..., found \"pik\"; did you mean \"pick\"?",
        ),
        (
            "no_points@pick=0",
            "fault \"no_points@pick=0\": pick: expected a whole number from 1, found \"0\"",
        ),
        (
            "camera_lost@t=10",
            "fault \"camera_lost@t=10\": t: expected a time of at most a day with its unit, as in 12s, 500ms or 2min, \
             found \"10\"",
        ),
        (
            "status=1102@command=101",
            "fault \"status=1102@command=101\": status: expected the code of an error in the interface's table, as in \
             1019, found 1102, which is a success (vision project triggered)",
        ),
        (
            "status=1019",
            "fault \"status=1019\": after @: expected which command or reply it hits, as in @command=102, found nothing",
        ),
        (
            "delay@command=205",
            "fault \"delay@command=205\": delay: expected a time, as in delay=12s, found nothing",
        ),
        (
            "drop_connection@n=2",
            "fault \"drop_connection@n=2\": n: expected the command that it counts, as in command=102,n=2, found n=2 alone",
        ),
        (
            "drop_connection@reply=2,command=102",
            "fault \"drop_connection@reply=2,command=102\": reply: expected it without command, found both",
        ),
        (
            "split_replies=3",
            "fault \"split_replies=3\": split_replies: expected no value, found \"3\"",
        ),
        (
            "delay=1s@command=102,command=103",
            "fault \"delay=1s@command=102,command=103\": command: expected it once, found it twice",
        ),
    ] {
        assert_eq!(told(text), expected);
    }
    assert!(told("status=1019@command=103x").contains("one of 100, 101"));
    for wrong in [
        "",
        " ; ",
        "status=99@command=102",
        "delay=-1s",
        "delay=nans",
        "no_points@",
        "delay=9999999h",
    ] {
        assert!(told(wrong).contains("expected"), "{wrong}");
    }
    let all = "no_points@pick=4; camera_lost@t=10s;status=1019@command=102,n=2;";
    let more = [
        "delay = 12 s @ command=205",
        "drop_connection@reply=7",
        "split_replies",
    ];
    let mut script = FaultScript::parse(&[all]).unwrap();
    script.extend(FaultScript::parse(&more).unwrap());
    assert_eq!(script.faults.len(), 6);
}

#[test]
fn a_status_answers_instead_of_the_command() {
    let mut bench = bench(&["status=1019@command=102,n=2", "status=2025@command=201"]);
    bench.check("101,1,0,0", "101,1102");
    let job_id = bench.job_id();
    let points = vec![object(0.5), object(0.6)];
    bench.server.finish_vision(bench.now, job_id, Ok(points));
    bench.send(OTHER, "102,9");
    assert_eq!(bench.replies(), ["102,1011"], "the first 102 of the port");
    bench.check("102,1", "102,1019");
    // Nothing was taken from the result.
    bench.send(CLIENT, "102,1");
    assert!(bench.replies()[0].starts_with("102,1100,1,2,"));
    // Without a number every one is hit, and nothing starts.
    for _ in 0..3 {
        bench.check("201,0", "201,2025");
    }
    assert_eq!(bench.server.poll_job(), None);
    bench.check("205,1", "205,2022");

    let mut control = self::bench(&[]);
    control.check("102,1", "102,1020");
    control.check("102,1", "102,1020");
    control.check("201,0", "201,2103");
}

#[test]
fn a_status_has_the_form_of_the_commands_own_errors() {
    for (encoding, expected) in [
        (Encoding::HexLittleEndian, [102, 0, 0, 0, 0xfb, 3, 0, 0]),
        (Encoding::HexBigEndian, [0, 0, 0, 102, 0, 0, 3, 0xfb]),
    ] {
        let port = PortSettings {
            encoding,
            ..PortSettings::default()
        };
        let settings = ServerSettings {
            ports: vec![port],
            faults: FaultScript::parse(&["status=1019@command=102"]).unwrap(),
            ..ServerSettings::default()
        };
        let mut server = Server::new(settings).unwrap();
        server.handle_connect(SimTime::ZERO, PORT, CLIENT);
        let mut request = [0; 64];
        let place = if encoding == Encoding::HexBigEndian {
            3
        } else {
            0
        };
        request[place] = 102;
        server.handle_input(SimTime::ZERO, PORT, CLIENT, &request);
        server.handle_timeout(SimTime::ZERO + depal_wire::HEX_SILENCE);
        let reply = server.poll_reply().unwrap().bytes;
        assert_eq!(reply.len(), 660);
        assert_eq!(reply[..8], expected);
        assert!(reply[8..].iter().all(|byte| *byte == 0));
    }
}

#[test]
fn a_delay_holds_up_a_reply_and_its_connection_alone() {
    let mut bench = bench(&["delay=12s@command=101"]);
    bench.send(CLIENT, "101,1,0,0");
    // Carried out at once, answered late, and what follows on this connection waits.
    bench.job_id();
    bench.send(CLIENT, "901");
    assert!(bench.server.is_waiting(PORT, CLIENT));
    bench.send(OTHER, "901");
    assert_eq!(bench.replies(), ["901,1101"]);
    assert_eq!(
        bench.server.poll_timeout(),
        Some(bench.now + SimDuration::from_millis(12_000))
    );
    bench.wait(11_999);
    assert_eq!(bench.replies(), [""; 0]);
    bench.wait(1);
    assert_eq!(bench.replies(), ["101,1102", "901,1101"]);
    assert!(!bench.server.is_waiting(PORT, CLIENT));

    // A client that has gone gets nothing; the next is not held up.
    bench.send(CLIENT, "101,9,0,0");
    bench.server.handle_disconnect(bench.now, PORT, CLIENT);
    bench.wait(12_000);
    assert_eq!(bench.replies(), [""; 0]);
    assert_eq!(bench.server.poll_timeout(), None);

    let mut control = self::bench(&["delay=12s@command=102"]);
    control.check("101,1,0,0", "101,1102");
}

#[test]
fn a_connection_drops_instead_of_the_nth_reply_of_its_port() {
    let mut bench = bench(&["drop_connection@reply=3"]);
    bench.check("901", "901,1101");
    bench.send(OTHER, "901");
    assert_eq!(bench.replies(), ["901,1101"]);
    bench.send(CLIENT, "901\r901");
    let dropped = bench.server.poll_reply().unwrap();
    assert_eq!(
        (dropped.connection, dropped.closes, dropped.bytes.len()),
        (CLIENT, true, 0)
    );
    assert_eq!(bench.server.poll_reply(), None, "nothing follows");
    let log: Vec<_> = std::iter::from_fn(|| bench.server.poll_log()).collect();
    assert_eq!(log.last().unwrap().status, None, "nobody has heard it");
    let told = &log.last().unwrap().text;
    assert_eq!(
        told,
        "[fault drop_connection@reply=3] 901,1101 (vision ready)"
    );
    // The port goes on.
    bench.send(OTHER, "901");
    assert_eq!(bench.replies(), ["901,1101"]);

    let mut control = self::bench(&[]);
    control.send(CLIENT, "901\r901\r901\r901");
    let replies = std::iter::from_fn(|| control.server.poll_reply());
    assert_eq!(replies.filter(|reply| !reply.closes).count(), 4);
}

#[test]
fn replies_come_in_pieces_one_tick_apart() {
    let mut bench = bench(&["split_replies@command=901"]);
    bench.check("999", "999,3001");
    bench.send(CLIENT, "901\r999");
    assert_eq!(bench.replies(), ["9"]);
    bench.wait(4);
    assert_eq!(bench.replies(), ["01,1"]);
    bench.wait(3);
    assert_eq!(bench.replies(), [""; 0]);
    bench.wait(1);
    assert_eq!(bench.replies(), ["101", "999,3001"]);

    let mut control = self::bench(&[]);
    control.check("901", "901,1101");
}

#[test]
fn a_lost_camera_shows_in_the_state() {
    let mut bench = with_profile(&["camera_lost@t=10s"], Profile::v2_2());
    bench.check("901", "901,9100,1,1,1");
    bench.wait(10_000);
    bench.check("901", "901,9100,1,1,0");
    let mut control = with_profile(&[], Profile::v2_2());
    control.wait(10_000);
    control.check("901", "901,9100,1,1,1");
}

#[test]
fn pictures_fail_when_they_shall() {
    let script = FaultScript::parse(&["no_points@pick=2;no_points@pick=4;camera_lost@t=1s"]);
    let mut faults = FrameFaults::new(&script.unwrap());
    let shown: Vec<bool> = (0..5).map(|_| faults.frame_is_empty()).collect();
    assert_eq!(shown, [false, true, false, true, false]);
    let before = SimTime::ZERO + SimDuration::from_millis(999);
    let at = SimTime::ZERO + SimDuration::from_millis(1000);
    assert_eq!(
        (faults.camera_is_lost(before), faults.camera_is_lost(at)),
        (false, true)
    );
    let mut always = FrameFaults::new(&FaultScript::parse(&["no_points"]).unwrap());
    assert!((0..3).all(|_| always.frame_is_empty()));
    let mut none = FrameFaults::new(&FaultScript::default());
    assert!(!none.frame_is_empty() && !none.camera_is_lost(at));
}
