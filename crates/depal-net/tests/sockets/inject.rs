//! Faults on demand over sockets: each with its effect, and beside it the same dialogue without.

use std::io::Read;
use std::net::Shutdown;
use std::time::{Duration, Instant};

use depal_interface::Encoding;

use crate::served::{Client, Served, Setup, TRIGGER, ascii, cells, serve};

fn with(inject: &[&str]) -> Served {
    serve(&Setup {
        inject,
        ..Setup::default()
    })
}

fn picture(robot: &mut Client) -> String {
    robot.check(TRIGGER, "101,1102");
    let reply = robot.ask("102,1");
    reply.chars().take(12).collect()
}

/// The answer of the planning project at its first exit, which takes a picture with project 3.
fn path(robot: &mut Client) -> String {
    robot.check("201,2,0,-20,10,0,60,0", "201,2103");
    robot.check("203,1,1", "203,2105");
    let reply = robot.ask("205,1");
    reply.chars().take(8).collect()
}

#[test]
fn without_faults_pictures_show_cartons() {
    let served = ascii();
    let mut robot = served.client();
    for _ in 0..3 {
        assert_eq!(picture(&mut robot), "102,1100,1,8");
    }
    assert_eq!(path(&mut robot), "205,2100");
}

#[test]
fn no_points_empties_the_wanted_picture() {
    let served = with(&["no_points@pick=2;no_points@pick=4"]);
    let mut robot = served.client();
    for expected in ["102,1100,1,8", "102,1002", "102,1100,1,8"] {
        assert_eq!(picture(&mut robot), expected);
    }
    assert_eq!(path(&mut robot), "205,2037");
    assert_eq!(path(&mut robot), "205,2100");
}

#[test]
fn a_lost_camera_fails_every_later_run() {
    let served = with(&["camera_lost@t=3s"]);
    let mut robot = served.client();
    assert_eq!(picture(&mut robot), "102,1100,1,8");
    std::thread::sleep(Duration::from_secs(3));
    assert_eq!(picture(&mut robot), "102,1023");
    assert_eq!(path(&mut robot), "205,2008");
    assert_eq!(picture(&mut robot), "102,1023");
    served.check_alive(0, Encoding::Ascii);
}

#[test]
fn status_and_delay_hit_what_they_name() {
    let served = with(&["status=1019@command=102,n=1", "delay=600ms@command=103,n=2"]);
    let mut robot = served.client();
    assert_eq!(picture(&mut robot), "102,1019");
    assert!(
        robot.ask("102,1").starts_with("102,1100,1,8"),
        "still there"
    );
    let mut time = |expected: &str| {
        let started = Instant::now();
        robot.check("103,1,2", expected);
        started.elapsed()
    };
    time("103,1107");
    let late = time("103,1107");
    assert!(late >= Duration::from_millis(590), "{late:?}");
    // Only that connection was held up, and only then.
    served.check_alive(0, Encoding::Ascii);
}

#[test]
fn a_dropped_connection_gets_no_reply_and_the_port_goes_on() {
    let served = with(&["drop_connection@reply=3"]);
    let mut robot = served.client();
    robot.check("901", "901,1101");
    robot.check("901", "901,1101");
    robot.send(b"901\r901\r");
    let mut rest = Vec::new();
    robot.0.read_to_end(&mut rest).expect("closed in order");
    assert_eq!(rest, b"");
    let mut again = served.client();
    for _ in 0..5 {
        again.check("901", "901,1101");
    }
    served.check_alive(0, Encoding::Ascii);

    let control = ascii();
    let mut robot = control.client();
    for _ in 0..10 {
        robot.check("901", "901,1101");
    }
}

/// What single reads of a reply give.
fn reads(robot: &mut Client, length: usize) -> Vec<Vec<u8>> {
    let mut pieces: Vec<Vec<u8>> = Vec::new();
    while pieces.iter().map(Vec::len).sum::<usize>() < length {
        let mut buffer = [0; 1024];
        let count = robot.0.read(&mut buffer).expect("a piece");
        assert!(count > 0, "closed after {pieces:?}");
        pieces.push(buffer[..count].to_vec());
    }
    pieces
}

#[test]
fn split_replies_come_in_pieces_and_are_whole() {
    const LITTLE: Encoding = Encoding::HexLittleEndian;
    let kinds = &[Encoding::Ascii, LITTLE];
    let served = serve(&Setup {
        kinds,
        inject: &["split_replies"],
        ..Setup::default()
    });
    let control = serve(&Setup {
        kinds,
        ..Setup::default()
    });
    // A busy computer may let pieces run together, so some tries; one read more than one write is never needed.
    let mut most = 0;
    for _ in 0..20 {
        let mut robot = served.client();
        robot.send(b"901\r");
        let pieces = reads(&mut robot, 9);
        assert_eq!(pieces.concat(), b"901,1101\r");
        most = most.max(pieces.len());
    }
    assert_eq!(most, 3);
    let mut robot = served.client_of(1);
    let reply = robot.ask_cells(LITTLE, &[901]);
    assert_eq!(cells(LITTLE, &reply, 3), [901, 1101, 0]);
    for _ in 0..20 {
        let mut robot = control.client();
        robot.send(b"901\r");
        assert_eq!(reads(&mut robot, 9).len(), 1);
    }
}

/// A client that has closed its sending side and gets its reply late is not taken for one that is gone.
#[test]
fn a_delayed_reply_is_not_lost_to_a_client_that_waits_for_a_run() {
    let served = with(&["delay=1s@command=901"]);
    let mut patient = served.client();
    patient.send(b"901\r");
    patient.0.shutdown(Shutdown::Write).expect("a socket");
    let mut other = served.client();
    other.check(TRIGGER, "101,1102");
    assert!(other.ask("102,1").starts_with("102,1100,1,8,"));
    let mut all = String::new();
    patient.0.read_to_string(&mut all).expect("a reply");
    assert_eq!(all, "901,1101\r");
}
