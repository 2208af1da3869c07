//! Awkward input on a text port: rows 1 to 33 of the fault list that are about the dialogue.
//! Every row has a port, and afterwards a second client of that port is answered.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use depal_interface::Encoding;

use crate::served::{Served, Setup, TRIGGER, serve};

/// Number of the row, what it is about, and what a client does.
type Row = (u32, &'static str, fn(&Served, usize));

const ROWS: &[Row] = &[
    (1, "an empty line is ignored", |served, port| {
        let mut robot = served.client_of(port);
        robot.send(b"\r\r \r901\r\r");
        assert_eq!(robot.reply(), "901,1101");
        assert!(robot.is_quiet(Duration::from_millis(200)));
    }),
    (2, "an unknown command", |served, port| {
        served.client_of(port).check("999", "999,3001");
    }),
    (3, "letters", |served, port| {
        served.client_of(port).check("abc", "0,3001");
    }),
    (4, "too few fields", |served, port| {
        let mut robot = served.client_of(port);
        robot.check("101", "101,3002");
        robot.check("103,1", "103,3002");
        robot.check("501,1,400,300", "501,3002");
    }),
    (5, "11 of 12 pose values", |served, port| {
        let mut robot = served.client_of(port);
        robot.check("101,1,0,1,0,-20,10,0,60,0,500,0,900,180,0", "101,3002");
    }),
    (6, "200 fields too many", |served, port| {
        let mut robot = served.client_of(port);
        let extra = ",1".repeat(200);
        for command in ["901", "102,1", "103,1,2", TRIGGER, "202"] {
            let code = &command[..3];
            robot.check(&format!("{command}{extra}"), &format!("{code},3002"));
        }
    }),
    (7, "an unknown pose type", |served, port| {
        let mut robot = served.client_of(port);
        robot.check("101,1,0,9,0,0,0,0,0,0", "101,1005");
        robot.check("201,9,0,0,0,0,0,0", "201,2006");
    }),
    (8, "project numbers that nobody has", |served, port| {
        let mut robot = served.client_of(port);
        for job in ["99999", "-1", "0", "2147483647"] {
            robot.check(&format!("102,{job}"), "102,1011");
        }
        for job in [
            "2147483648",
            "9223372036854775808",
            "-99999999999999999999999",
        ] {
            let reply = robot.ask(&format!("102,{job}"));
            assert!(
                matches!(reply.as_str(), "102,1011" | "102,3002"),
                "{job}: {reply}"
            );
        }
    }),
    (9, "numbers that are none", |served, port| {
        let mut robot = served.client_of(port);
        for real in ["nan", "NaN", "inf", "-infinity", "1e999"] {
            robot.check(&format!("101,1,0,2,{real},0,900,180,0,0"), "101,1006");
            robot.check(&format!("201,2,{real},0,0,0,0,0"), "201,2013");
            robot.check(&format!("501,1,{real},300,250"), "501,1022");
        }
    }),
    (10, "numbers of other languages", |served, port| {
        let mut robot = served.client_of(port);
        robot.check("501,1,400,5,300,5,250,5", "501,3002");
        for number in [
            "0x1", "1_0", "\u{ff11}", "\u{661}", "1;2", "--1", "1e", "1 2",
        ] {
            robot.check(&format!("103,1,{number}"), "103,3002");
        }
    }),
    (11, "blanks and signs around numbers", |served, port| {
        let mut robot = served.client_of(port);
        robot.check(" 103 ,\t1 , +2 ", "103,1107");
        robot.check("103,1.0,1.,", "103,1107");
        robot.check("501,1, +400.0 ,3e2,250", "501,1108");
        robot.check("101,1,-0,2,-0,0,900,180,-0.0,0", "101,1102");
    }),
    (12, "LF, CR LF and stray LF", |served, port| {
        let mut robot = served.client_of(port);
        robot.send(b"\n901\n901\r\n\n\n901\r\n");
        for _ in 0..3 {
            assert_eq!(robot.reply(), "901,1101");
        }
        assert!(robot.is_quiet(Duration::from_millis(200)));
    }),
    (13, "one byte now and then", |served, port| {
        // Silence ends a line, so that no half line is ever kept: each byte is a command of its own.
        let mut robot = served.client_of(port);
        for (byte, expected) in [("9", "9,3001"), ("0", "0,3001"), ("1", "1,3001")] {
            robot.send(byte.as_bytes());
            served.check_alive(port, Encoding::Ascii);
            assert_eq!(robot.reply(), expected);
        }
    }),
    (15, "a thousand commands at once", |served, port| {
        let mut robot = served.client_of(port);
        let all: Vec<String> = (4000..5000).map(|code| format!("{code}\r")).collect();
        robot.send(all.concat().as_bytes());
        for code in 4000..5000 {
            assert_eq!(robot.reply(), format!("{code},3001"));
        }
    }),
    (16, "a command cut at every byte", |served, port| {
        let command = b"103,1,2\r\n";
        for cut in 0..=command.len() {
            let mut robot = served.client_of(port);
            robot.send(&command[..cut]);
            std::thread::sleep(Duration::from_millis(5));
            robot.send(&command[cut..]);
            assert_eq!(robot.reply(), "103,1107", "cut at {cut}");
            assert!(cut > 0 || robot.is_quiet(Duration::from_millis(100)));
        }
    }),
    (17, "bytes that are no text", |served, port| {
        let mut robot = served.client_of(port);
        let utf16: Vec<u8> = "901\r".encode_utf16().flat_map(u16::to_be_bytes).collect();
        for (bytes, expected) in [
            (&b"\xff\xfe\xfd\r"[..], "0,3001"),
            (b"\xef\xbb\xbf901\r", "0,3001"),
            (b"\x80\x81,1,2\r", "0,3001"),
            (b"103,\xff,1\r", "0,3001"),
            (b"\0\0\0\0901\r", "901,1101"),
            (&utf16, "901,1101"),
        ] {
            robot.send(bytes);
            assert_eq!(robot.reply(), expected, "{}", bytes.escape_ascii());
        }
    }),
    (18, "102 before any 101", |served, port| {
        let mut robot = served.client_of(port);
        robot.check("102,1", "102,1020");
        robot.check("110,1", "110,1016");
        robot.check("205,1", "205,2022");
    }),
    (19, "101 while it runs", |served, port| {
        let mut robot = served.client_of(port);
        robot.send(format!("{TRIGGER}\r{TRIGGER}\r103,1,2\r501,1,1,1,1\r").as_bytes());
        let replies: Vec<String> = (0..4).map(|_| robot.reply()).collect();
        assert_eq!(replies, ["101,1102", "101,1007", "103,1007", "501,1007"]);
        assert!(robot.ask("102,1").starts_with("102,1100,1,8,0,"));
    }),
    (20, "what a project does not give", |served, port| {
        let mut robot = served.client_of(port);
        robot.check(TRIGGER, "101,1102");
        robot.check("105,1,1", "105,1016");
        robot.check("101,2,0,0,0,0,0,0,0,0", "101,1102");
        robot.check("102,2", "102,1016");
    }),
    (21, "102 after the last part", |served, port| {
        let mut robot = served.client_of(port);
        robot.check(TRIGGER, "101,1102");
        assert!(robot.ask("102,1").starts_with("102,1100,1,8,0,"));
        robot.check("102,1", "102,1002");
        robot.check("102,1", "102,1002");
    }),
    (22, "a client that goes after 101", |served, port| {
        served.client_of(port).check(TRIGGER, "101,1102");
        let mut next = served.client_of(port);
        assert!(next.ask("102,1").starts_with("102,1100,1,8,0,"));
        next.check("102,1", "102,1002");
    }),
    (27, "two robots on one port", |served, port| {
        let (mut one, mut other) = (served.client_of(port), served.client_of(port));
        one.check(TRIGGER, "101,1102");
        other.check(TRIGGER, "101,1007");
        assert!(other.ask("102,1").starts_with("102,1100,1,8,0,"));
        one.check("102,1", "102,1002");
    }),
    (28, "recipes", |served, port| {
        let mut robot = served.client_of(port);
        for (recipe, code) in [
            ("0", 1012),
            ("100", 1012),
            ("3", 1012),
            ("A", 3002),
            ("2", 1107),
        ] {
            robot.check(&format!("103,1,{recipe}"), &format!("103,{code}"));
        }
        robot.check("103,3,1", "103,1013");
    }),
    (29, "sizes", |served, port| {
        let mut robot = served.client_of(port);
        for side in ["0", "-300", "nan", "1e9", "10000.1"] {
            robot.check(&format!("501,1,400,{side},250"), "501,1022");
        }
        robot.check("501,1,400,300,250", "501,1108");
    }),
    (30, "branches and indexes", |served, port| {
        let mut robot = served.client_of(port);
        robot.check("203,1,1", "203,2022");
        robot.check("201,2,0,-20,10,0,60,0", "201,2103");
        robot.check("204,99,1", "204,2026");
        for place in ["0", "7", "-2147483648"] {
            robot.check(&format!("204,3,{place}"), "204,2027");
        }
        for exit in ["0", "3", "2147483647"] {
            robot.check(&format!("203,1,{exit}"), "203,2018");
        }
        robot.check("203,99,1", "203,2024");
        // None of these ended the run.
        robot.check("204,3,6", "204,2106");
        robot.check("203,1,2", "203,2105");
    }),
    (31, "a calibration that is none", |served, port| {
        let mut robot = served.client_of(port);
        let poses = "500,0,900,180,0,0,0,-20,10,0,60,0";
        robot.check(&format!("701,3,{poses}"), "701,7001");
        robot.check(&format!("701,1,{poses}"), "701,7001");
        robot.check("701,0,0,0,0,0,0,0,0,-20,10,0,60,0", "701,7002");
        robot.check("701,0,500,0,900", "701,3002");
        robot.check(&format!("701,0,{poses},7"), "701,3002");
        assert!(
            robot
                .ask(&format!("701,0,{poses}"))
                .starts_with("701,7101,0,")
        );
    }),
    (32, "gripper sections", |served, port| {
        let mut robot = served.client_of(port);
        for sections in ["0", "-1", "65", "2147483647"] {
            robot.check(&format!("206,{sections}"), "206,3002");
        }
        robot.check("206,64", "206,2011");
        robot.check("206", "206,2011");
    }),
    (33, "other protocols", |served, port| {
        let mut tls = served.client_of(port);
        let mut hello = vec![0x16, 3, 1, 2, 0, 1, 0, 1, 0xfc];
        hello.resize(517, 0xa5);
        tls.send(&hello);
        assert!(tls.is_closed());
        let mut browser = served.client_of(port);
        browser.send(b"GET / HTTP/1.1\r\nHost: robot\r\n\r\n");
        assert!(browser.is_closed());
        assert!(served.has_told("looks like TLS") && served.has_told("looks like HTTP"));
    }),
];

#[test]
fn awkward_lines_are_answered_and_hurt_nobody() {
    let kinds = vec![Encoding::Ascii; ROWS.len()];
    let served = serve(&Setup {
        kinds: &kinds,
        ..Setup::default()
    });
    in_parallel(&served, ROWS, Encoding::Ascii);
}

/// All rows, a few at a time; every one is tried, and those that fail are named.
pub fn in_parallel(served: &Served, rows: &[Row], kind: Encoding) {
    let next = AtomicUsize::new(0);
    let failed = std::thread::scope(|scope| {
        let work = || {
            let mut failed = Vec::new();
            loop {
                let port = next.fetch_add(1, Ordering::Relaxed);
                let Some((number, about, row)) = rows.get(port) else {
                    return failed;
                };
                let outcome = std::thread::scope(|inner| {
                    let run = inner.spawn(move || {
                        row(served, port);
                        served.check_alive(port, kind);
                    });
                    run.join()
                });
                if outcome.is_err() {
                    failed.push(format!("{number} ({about})"));
                }
            }
        };
        let workers: Vec<_> = (0..6).map(|_| scope.spawn(work)).collect();
        let failed = workers
            .into_iter()
            .flat_map(|worker| worker.join().expect("rows panic elsewhere"));
        failed.collect::<Vec<String>>()
    });
    assert!(failed.is_empty(), "rows that failed: {}", failed.join(", "));
}
