//! Awkward records on HEX ports: rows 34 to 40 of the fault list, in both byte orders where it matters.

use std::time::Duration;

use depal_interface::Encoding;

use crate::faults_ascii::in_parallel;
use crate::served::{Served, Setup, cells, record, serve};

const LITTLE: Encoding = Encoding::HexLittleEndian;

type Row = (u32, &'static str, fn(&Served, usize));

const ROWS: &[Row] = &[
    (34, "63 bytes, a pause; 65 bytes", |served, port| {
        let mut robot = served.client_of(port);
        // 63 bytes and silence are a command; what comes later is another.
        robot.send(&record(LITTLE, &[901], 63));
        assert_eq!(cells(LITTLE, &robot.frame(), 2), [901, 1101]);
        std::thread::sleep(Duration::from_millis(60));
        robot.send(&record(LITTLE, &[103, 1, 2], 64));
        assert_eq!(cells(LITTLE, &robot.frame(), 2), [103, 1107]);
        // A 65th byte is dropped and belongs to nothing.
        let mut robot = served.client_of(port);
        robot.send(&record(LITTLE, &[901], 65));
        assert_eq!(cells(LITTLE, &robot.frame(), 2), [901, 1101]);
        robot.send(&record(LITTLE, &[103, 1, 2], 64));
        assert_eq!(cells(LITTLE, &robot.frame(), 2), [103, 1107]);
        robot.send(&record(LITTLE, &[103, 1, 9], 64));
        assert_eq!(cells(LITTLE, &robot.frame(), 2), [103, 1012]);
        assert!(robot.is_quiet(Duration::from_millis(150)));
        // Less than a record is dropped.
        robot.send(&record(LITTLE, &[901], 20));
        assert!(robot.is_quiet(Duration::from_millis(150)));
        assert_eq!(
            cells(LITTLE, &robot.ask_cells(LITTLE, &[901]), 2),
            [901, 1101]
        );
    }),
    (35, "the wrong byte order", |served, port| {
        let mut robot = served.client_of(port);
        let reply = robot.ask_cells(Encoding::HexBigEndian, &[101, 1]);
        assert_eq!(cells(LITTLE, &reply, 2), [101i32.swap_bytes(), 3001]);
        assert!(served.has_told("byte order?"));
    }),
    (36, "numbers at the edge", |served, port| {
        let mut robot = served.client_of(port);
        for job in [i32::MAX, i32::MIN, -1, 0] {
            for code in [101, 102, 103, 501] {
                let reply = robot.ask_cells(LITTLE, &[code, job, 1]);
                assert_eq!(cells(LITTLE, &reply, 2), [code, 1011], "{job}");
            }
            let reply = robot.ask_cells(LITTLE, &[203, job, 1]);
            assert_eq!(cells(LITTLE, &reply, 2), [203, 2024], "{job}");
        }
        for count in [i32::MIN, -1] {
            let reply = robot.ask_cells(LITTLE, &[101, 1, count]);
            assert_eq!(cells(LITTLE, &reply, 2), [101, 1018], "{count}");
        }
        for kind in [i32::MAX, i32::MIN, -1] {
            let reply = robot.ask_cells(LITTLE, &[101, 1, 0, kind]);
            assert_eq!(cells(LITTLE, &reply, 2), [101, 1005], "{kind}");
            let reply = robot.ask_cells(LITTLE, &[206, kind]);
            assert_eq!(cells(LITTLE, &reply, 2), [206, 3002], "{kind}");
        }
        // The largest count is as good as all.
        let reply = robot.ask_cells(LITTLE, &[101, 1, i32::MAX]);
        assert_eq!(cells(LITTLE, &reply, 2), [101, 1102]);
        let reply = robot.ask_cells(LITTLE, &[102, 1]);
        assert_eq!(cells(LITTLE, &reply, 4), [102, 1100, 0, 3]);
    }),
    (37, "padding that is not zero", |served, port| {
        let mut robot = served.client_of(port);
        let mut request = record(LITTLE, &[103, 1, 2], 64);
        request[12..].fill(0xee);
        robot.send(&request);
        assert_eq!(cells(LITTLE, &robot.frame(), 2), [103, 1107]);
    }),
    (38, "poses out of any reach", |served, port| {
        let mut robot = served.client_of(port);
        for (place, value) in [
            (0, 10_001.0),
            (1, -10_001.0),
            (3, 361.0),
            (5, -361.0),
            (2, f32::MAX),
            (2, f32::NAN),
            (2, f32::INFINITY),
        ] {
            let mut pose = [500.0, 0.0, 900.0, 180.0, 0.0, 0.0f32];
            pose[place] = value;
            let bits = pose.map(|value| value.to_bits() as i32);
            let reply = robot.ask_cells(LITTLE, &[&[101, 1, 0, 2], &bits[..]].concat());
            assert_eq!(cells(LITTLE, &reply, 2), [101, 1006], "{value}");
        }
    }),
    (39, "more points than a reply holds", |served, port| {
        let mut robot = served.client_of(port);
        let reply = robot.ask_cells(LITTLE, &[101, 1]);
        assert_eq!(cells(LITTLE, &reply, 2), [101, 1102]);
        for (is_last, count) in [(0, 3), (0, 3), (1, 2)] {
            let reply = robot.ask_cells(LITTLE, &[102, 1]);
            assert_eq!(cells(LITTLE, &reply, 4), [102, 1100, is_last, count]);
            let after = 4 * (5 + 8 * count as usize);
            assert!(reply[after..].iter().all(|byte| *byte == 0));
            assert!(reply[after - 32..after - 8].iter().any(|byte| *byte != 0));
        }
        let reply = robot.ask_cells(LITTLE, &[102, 1]);
        assert_eq!(cells(LITTLE, &reply, 2), [102, 1002]);
        assert!(robot.is_quiet(Duration::from_millis(100)), "660 bytes each");
    }),
    (40, "text on a HEX port", |served, port| {
        let mut robot = served.client_of(port);
        robot.send(b"901\r");
        assert!(robot.is_quiet(Duration::from_millis(150)));
        let line = [&b"101,1,0,2"[..], &b",1".repeat(40)].concat();
        robot.send(&line[..64]);
        assert_eq!(cells(LITTLE, &robot.frame(), 2)[1], 3001);
        assert!(served.has_told("make no request"));
    }),
];

#[test]
fn awkward_records_are_answered_and_hurt_nobody() {
    let kinds = vec![LITTLE; ROWS.len()];
    let served = serve(&Setup {
        kinds: &kinds,
        set: &[("interface.pose_cap", "3")],
        ..Setup::default()
    });
    in_parallel(&served, ROWS, LITTLE);
}

/// Its first 56 bytes are a record, too: of older versions.
#[test]
fn the_end_of_a_record_may_come_after_the_reply() {
    for kind in [LITTLE, Encoding::HexBigEndian] {
        let served = serve(&Setup {
            kinds: &[kind],
            ..Setup::default()
        });
        let mut robot = served.client();
        let mut late = Vec::new();
        for (command, reply) in [
            ([901, 0, 0], 1101),
            ([103, 1, 2], 1107),
            ([103, 1, 9], 1012),
            ([203, 1, 9], 2018),
            ([901, 0, 0], 1101),
        ] {
            let request = record(kind, &command, 64);
            robot.send(&[&late, &request[..56]].concat());
            assert_eq!(cells(kind, &robot.frame(), 2), [command[0], reply]);
            late = request[56..].to_vec();
        }
        // A flange pose that has lost two of its angles is refused, not completed with zeros.
        let pose = [500.0, 10.0, 900.0, 180.0, -1.0, 175.0f32].map(|value| value.to_bits() as i32);
        let request = record(
            kind,
            &[&[101, 1, 0, 1, 0, 0, 0, 0, 0, 0], &pose[..]].concat(),
            64,
        );
        robot.send(&[&late, &request[..56]].concat());
        assert_eq!(cells(kind, &robot.frame(), 2), [101, 3002]);
        robot.send(&record(kind, &[901], 64));
        assert_eq!(cells(kind, &robot.frame(), 2), [901, 1101]);
    }
}

#[test]
fn records_on_a_text_port_are_refused() {
    let served = crate::served::ascii();
    for kind in [LITTLE, Encoding::HexBigEndian] {
        let mut robot = served.client();
        robot.send(&record(kind, &[101, 1], 64));
        let reply = robot.reply();
        assert!(reply.ends_with(",3001"), "{reply}");
        served.check_alive(0, Encoding::Ascii);
    }
}

#[test]
fn big_endian_records_are_as_good() {
    const BIG: Encoding = Encoding::HexBigEndian;
    let served = serve(&Setup {
        kinds: &[BIG],
        ..Setup::default()
    });
    let mut robot = served.client();
    robot.send(&record(BIG, &[901], 63));
    assert_eq!(cells(BIG, &robot.frame(), 2), [901, 1101]);
    let reply = robot.ask_cells(Encoding::HexLittleEndian, &[101, 1]);
    assert_eq!(cells(BIG, &reply, 2), [101i32.swap_bytes(), 3001]);
    let reply = robot.ask_cells(BIG, &[101, 1]);
    assert_eq!(cells(BIG, &reply, 2), [101, 1102]);
    let reply = robot.ask_cells(BIG, &[102, 1]);
    assert_eq!(cells(BIG, &reply, 4), [102, 1100, 1, 8]);
    served.check_alive(0, BIG);
}
