//! Clients that misuse the connection itself: rows 14, 23 to 26, 66, 69 and 70 of the fault list.

use std::io::{ErrorKind, Write};
use std::net::TcpListener;
use std::time::{Duration, Instant};

use depal_interface::{ConnectionId, Encoding, PortId};
use depal_net::{Limits, NetError, bind};
use socket2::{Domain, SockRef, Socket, Type};

use crate::served::{Client, Served, Setup, TRIGGER, ascii, record, serve, serve_on, station};

#[test]
fn row_14_a_line_without_end_is_cut() {
    let served = ascii();
    let mut endless = served.client();
    let limit = Some(Duration::from_secs(10));
    endless.0.set_write_timeout(limit).expect("a socket");
    let piece = vec![b'7'; 64 * 1024];
    let mut sent = 0;
    let end = loop {
        match endless.0.write(&piece) {
            Ok(count) => sent += count,
            Err(error) => break error.kind(),
        }
        assert!(sent < 100_000_000, "100 MB were taken");
    };
    assert!(
        matches!(end, ErrorKind::ConnectionReset | ErrorKind::BrokenPipe),
        "{end:?}"
    );
    served.check_alive(0, Encoding::Ascii);
    // 4 KiB are still a line, one byte more is not.
    let mut robot = served.client();
    let command = |length: usize| format!("901{}\r", " ".repeat(length - 3));
    robot.check(command(4096).trim_end_matches('\r'), "901,1101");
    robot.send(command(4097).as_bytes());
    assert_eq!(robot.reply(), "0,3002");
    assert!(robot.is_closed());
    served.check_alive(0, Encoding::Ascii);
}

/// Ports of the server and of the client.
#[cfg(target_os = "linux")]
fn ends(client: &Client) -> (u16, u16) {
    let port = |address: std::io::Result<std::net::SocketAddr>| address.expect("a socket").port();
    (port(client.0.peer_addr()), port(client.0.local_addr()))
}

/// The timer of the server's end of a connection, from the system's table: its kind and its time in 1/100 s.
#[cfg(target_os = "linux")]
fn timer_of(ends: (u16, u16)) -> Option<(u32, u64)> {
    let table = std::fs::read_to_string("/proc/net/tcp").expect("the table");
    table.lines().skip(1).find_map(|line| {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let port = |field: &str| u16::from_str_radix(field.rsplit(':').next()?, 16).ok();
        if (port(fields[1])?, port(fields[2])?) != ends {
            return None;
        }
        let (kind, time) = fields[5].split_once(':')?;
        let number = |text: &str| u64::from_str_radix(text, 16).ok();
        Some((number(kind)? as u32, number(time)?))
    })
}

#[test]
fn row_23_a_peer_that_is_silent_is_asked_and_the_next_served_at_once() {
    let limits = Limits::default();
    let in_all = limits.keepalive_after + limits.keepalive_interval * limits.keepalive_retries;
    assert!(in_all <= Duration::from_secs(15), "{in_all:?}");
    let served = ascii();
    let mut half_open = served.client();
    half_open.check("901", "901,1101");
    #[cfg(target_os = "linux")]
    {
        const KEEP_ALIVE: u32 = 2;
        let (kind, time) = timer_of(ends(&half_open)).expect("the connection is in the table");
        assert_eq!(kind, KEEP_ALIVE);
        assert!(time <= 500, "the first question comes in {time}/100 s");
    }
    served.check_alive(0, Encoding::Ascii);
    half_open.check("901", "901,1101");
}

#[test]
fn row_24_a_reset_in_the_middle_of_replies_ends_one_client() {
    let served = ascii();
    for _ in 0..20 {
        let mut robot = served.client();
        robot.send("901\r".repeat(500).as_bytes());
        robot.reply();
        let no_linger = Some(Duration::ZERO);
        SockRef::from(&robot.0)
            .set_linger(no_linger)
            .expect("a socket");
        drop(robot);
        served.check_alive(0, Encoding::Ascii);
    }
}

/// Its window is small, and full in a moment.
fn deaf_client(served: &Served) -> Client {
    let socket = Socket::new(Domain::IPV4, Type::STREAM, None).expect("a socket");
    socket.set_recv_buffer_size(4096).expect("a socket");
    socket.connect(&served.ports[0].into()).expect("it listens");
    Client(socket.into())
}

#[test]
fn row_25_a_peer_that_never_reads_is_cut() {
    const LITTLE: Encoding = Encoding::HexLittleEndian;
    assert_eq!(Limits::default().write, Duration::from_secs(10));
    let write = Duration::from_secs(1);
    let served = serve(&Setup {
        kinds: &[LITTLE],
        limits: Limits {
            write,
            ..Limits::default()
        },
        ..Setup::default()
    });
    let mut deaf = deaf_client(&served);
    let limit = Some(Duration::from_secs(10));
    deaf.0.set_write_timeout(limit).expect("a socket");
    let requests = record(LITTLE, &[901], 64).repeat(100);
    let started = Instant::now();
    let end = loop {
        if let Err(error) = deaf.0.write_all(&requests) {
            break error.kind();
        }
        assert!(started.elapsed() < Duration::from_secs(30), "still taken");
    };
    eprintln!(
        "{:?} told {}",
        started.elapsed(),
        served.has_told("does not read")
    );
    assert!(
        matches!(end, ErrorKind::ConnectionReset | ErrorKind::BrokenPipe),
        "{end:?}"
    );
    assert!(started.elapsed() >= write, "cut before its time");
    assert!(served.has_told("does not read"));
    served.check_alive(0, LITTLE);
}

/// Replies that nobody will ever read are not kept by the system either.
#[test]
#[cfg(target_os = "linux")]
fn row_25_nothing_is_left_of_a_peer_that_never_reads() {
    const LITTLE: Encoding = Encoding::HexLittleEndian;
    let served = serve(&Setup {
        kinds: &[LITTLE],
        limits: Limits {
            write: Duration::from_secs(1),
            ..Limits::default()
        },
        ..Setup::default()
    });
    // More replies than the system buffers, and then silence: nothing that would call for a reset.
    let mut deaf = deaf_client(&served);
    deaf.send(&record(LITTLE, &[901], 64).repeat(8000));
    let ends = ends(&deaf);
    assert!(timer_of(ends).is_some());
    assert!(served.has_told("does not read"));
    let started = Instant::now();
    while timer_of(ends).is_some() {
        assert!(started.elapsed() < Duration::from_secs(3), "still there");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn row_26_a_port_has_room_for_128_and_turns_the_rest_away() {
    let served = ascii();
    let mut old: Vec<Client> = (0..128).map(|_| served.client()).collect();
    for robot in &mut old {
        robot.check("901", "901,1101");
    }
    for _ in 0..200 {
        assert!(served.client().is_closed(), "one too many");
    }
    assert!(served.has_told("128 clients are connected already"));
    for robot in &mut old {
        robot.check("901", "901,1101");
    }
    // A place that becomes free is given again.
    old.truncate(127);
    served.check_room();
}

impl crate::served::Served {
    /// A new client is answered, as soon as the server has seen the old one go.
    fn check_room(&self) {
        let started = Instant::now();
        loop {
            let mut robot = self.client();
            let mut answer = [0; 9];
            let asked = robot.0.write_all(b"901\r");
            let read = asked.and_then(|()| std::io::Read::read_exact(&mut robot.0, &mut answer));
            if read.is_ok() {
                return assert_eq!(&answer, b"901,1101\r");
            }
            assert!(started.elapsed() < Duration::from_secs(10), "no room");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

#[test]
fn row_66_a_jump_of_the_clock_ends_what_is_due_and_nothing_else() {
    let mut station = station(&Setup::default());
    let (port, client) = (PortId(0), ConnectionId(1));
    station.connect(port, client);
    station.receive(port, client, b"201,0,0,0,0,0,0,0\r205,1\r");
    // Months at once, as after a sleep of the computer: the branch is still not chosen.
    let far = 10_000_000_000;
    station.advance_waiting(far);
    assert_eq!(station.tick(), far);
    let replies: Vec<_> = std::iter::from_fn(|| station.poll_reply()).collect();
    let texts: Vec<_> = replies
        .iter()
        .map(|r| r.bytes.escape_ascii().to_string())
        .collect();
    assert_eq!(texts, ["201,2103\\r", "205,2025\\r"]);
    assert_eq!(replies[1].tick, 2500, "after 10 s, not after months");
    // Time never goes back.
    assert_eq!(station.advance(17), far);
    station.receive(port, client, b"901\r");
    let reply = station.poll_reply().expect("an answer");
    assert_eq!((reply.tick, &reply.bytes[..]), (far, &b"901,1101\r"[..]));
}

#[test]
fn row_69_a_stop_finishes_replies_and_ends_in_time() {
    let served = ascii();
    let mut waiting = served.client();
    waiting.check(TRIGGER, "101,1102");
    waiting.send(b"102,1\r");
    let mut busy = served.client();
    busy.send("901\r".repeat(5_000).as_bytes());
    busy.reply();
    let took = served.stop();
    assert!(took < Duration::from_secs(2), "{took:?}");
    // What came is whole replies.
    let mut rest = Vec::new();
    let _ = std::io::Read::read_to_end(&mut busy.0, &mut rest);
    assert_eq!(rest.len() % b"901,1101\r".len(), 0);
    assert!(waiting.is_closed());
}

#[test]
fn row_70_a_port_in_use_is_named_and_a_port_just_left_is_free() {
    let taken = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = taken.local_addr().expect("bound");
    match bind(&[address]) {
        Err(NetError::Listen {
            address: named,
            source,
        }) => {
            assert_eq!(named, address);
            assert_eq!(source.kind(), ErrorKind::AddrInUse);
        }
        other => panic!("{other:?}"),
    }
    let served = ascii();
    let address = served.ports[0];
    let mut robot = served.client();
    robot.check("901", "901,1101");
    // The server closes first: its end of the connection lingers in the system.
    served.stop();
    assert!(robot.is_closed());
    let again = serve_on(bind(&[address]).expect("free again"), &Setup::default());
    again.client().check("901", "901,1101");
}
